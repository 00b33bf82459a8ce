"""Pressure ports in the heat shield, as of an atmospheric data system, while the shield is attached.

Modified Newtonian: p = p_inf + q Cp_max cos^2 of the angle between the outward normal of the port and the
flow; p_inf where the port lies in the lee.

Source: Karlgaard et al., Journal of Spacecraft and Rockets 51(4), 2014 (MEDLI); Anderson, Hypersonic and
High-Temperature Gas Dynamics (2006), section 3.2.
"""

from __future__ import annotations

from math import pi
from typing import Annotated

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import Capacity, Params, param, unique_names
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import MAX_PORTS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.counters import SenseAxis, axes_towards
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.vector import dot, take3
from edl6dof.spatial.vector import unit as direction
from edl6dof.vehicle.mass import CONFIG_CAPSULE


def cross_of_ports() -> list[SenseAxis]:
    """Seven ports, one at the nose and six on the cone of 70 deg, in the planes of pitch and yaw."""
    off = 20.0 * pi / 180.0
    on_cone = [(0.0, 0.0), (off, 0.0), (off, pi / 2.0), (off, pi), (off, 1.5 * pi)]
    return axes_towards("p", [*on_cone, (0.5 * off, 0.5 * pi), (0.5 * off, 1.5 * pi)])


class PressurePortsParams(Params):
    """Pressure ports; errors as standard deviations."""

    ports: Annotated[list[SenseAxis], Capacity(MAX_PORTS)] = param(
        None, "the ports; axis: outward normal of the heat shield at the port", factory=cross_of_ports,
        min_length=1, max_length=MAX_PORTS,
    )  # fmt: skip
    stagnation_coefficient: float = param(
        1.85, "Cp_max of the flow behind a strong shock", status="estimate", gt=0.0, le=2.0
    )
    bias_pa: float = param(10.0, "bias of each port, drawn for each case", status="estimate", ge=0.0, le=1e5)
    scale_pct: float = param(
        0.3, "error of scale of each port, drawn for each case", status="estimate", ge=0.0, le=100.0
    )
    noise_pa: float = param(5.0, "noise of a reading", status="estimate", ge=0.0, le=1e5)

    _names_differ = field_validator("ports")(unique_names)


#: Errors of the ports in this case: biases (Pa), relative errors of scale, key of the noise.
UNIT = record(("bias", "f8", (MAX_PORTS,)), ("scale", "f8", (MAX_PORTS,)), ("key", "i8"))
MEMORY = record(("cycle", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Read all ports; 0 without the heat shield."""
    cycle = memory.cycle
    memory.cycle += 1
    flow = direction(take3(outputs.v_air_B, 0))
    for i in range(params.n_ports):
        axis = params.ports[i].axis
        facing = max(dot(flow, (axis[0], axis[1], axis[2])), 0.0)
        over = params.stagnation_coefficient * outputs.dynamic_pressure * facing * facing
        noise, _ = normal_pair(unit.key, MAX_PORTS * cycle + i)
        read = (1.0 + unit.scale[i]) * (outputs.pressure + over) + unit.bias[i] + params.noise * noise
        sensed.pressure[i] = read if plant.shape == CONFIG_CAPSULE else 0.0


def plan(params: PressurePortsParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the instrument in this case."""
    given, n = in_si(params), len(params.ports)
    unit["bias"][:n] = given["bias"] * rng.standard_normal(n)
    unit["scale"][:n] = given["scale"] * rng.standard_normal(n)
    unit["key"] = rng.keys()


MEMBER = Member(
    "pressure_ports",
    PressurePortsParams,
    {"measure": measure},
    "Karlgaard et al., Journal of Spacecraft and Rockets 51(4), 2014",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("pressure",),
)
