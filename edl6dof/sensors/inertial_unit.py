"""Inertial unit: gyros and accelerometers along any axes, at one place of the body.

Their counts over a cycle follow from the true motion: the integral of the rate from the turn of the body, as
its rotation vector less the coning term h^2/12 w0 x w1 (rate linear in time); the integral of the specific
force at the unit from that of the centre of mass, the recoil of separations, and the lever arm l between the
two: (w1 - w0) x l + h w x (w x l).
Vibration with the engines shakes the unit about and along the axes of B (``vibration.py``).

Sources: Titterton and Weston, Strapdown Inertial Navigation Technology (2004), chapters 4, 5 and 11; coning
term: Savage, J. Guidance, Control, and Dynamics 21(1), 1998.
"""

from __future__ import annotations

from math import pi
from typing import Annotated

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import Capacity, Hardware, Params, Vec3, group, param, unique_names
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import MAX_ACCELEROMETERS, MAX_GYROS
from edl6dof.interface.sensed import INERTIAL
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.counters import SenseAxis, cone, copy_layout, count, counter_layout, draw_copies, rates
from edl6dof.sensors.vibration import MOUNT, VIBRATION, VibrationParams, draw_mount, shake
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.quaternion import conjugate, multiply, rotation_vector
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.vector import add, cross, put3, scale, sub, take3
from edl6dof.vehicle.plant import RATE, take_attitude

#: Readings that can be under way.
DEPTH = 8


class GyroParams(Params):
    """Gyros of the unit; errors as standard deviations, drawn for each case."""

    bandwidth_hz: float = param(
        100.0, "first-order bandwidth of the rate reading; 0: no lag", status="estimate", ge=0.0
    )
    axes: Annotated[list[SenseAxis], Capacity(MAX_GYROS)] = param(
        None, "the gyros and their axes", factory=lambda: cone("g"), min_length=1, max_length=MAX_GYROS
    )
    bias_deg_h: float = param(0.03, "bias at the start", status="estimate", ge=0.0)
    bias_walk_deg_h_sqrt_h: float = param(0.01, "random walk of the bias", status="estimate", ge=0.0)
    noise_deg_sqrt_h: float = param(0.01, "angle random walk", status="estimate", ge=0.0)
    scale_ppm: float = param(20.0, "error of the scale factor", status="estimate", ge=0.0, le=1e5)
    misalignment_arcsec: float = param(10.0, "error of the axis", status="estimate", ge=0.0, le=36000.0)
    quantum_arcsec: float = param(0.1, "angle of one count; 0: none", status="estimate", ge=0.0)
    range_deg_s: float = param(
        330.0, "largest rate", status="estimate", source="above 300 deg/s: Hu et al. 2022", gt=0.0
    )
    persistence_s: float = param(
        0.0, "time for which the saturation flag stays set", status="estimate", ge=0.0, le=60.0
    )

    _names_differ = field_validator("axes")(unique_names)


class AccelerometerParams(Params):
    """Accelerometers of the unit; errors as standard deviations, drawn for each case."""

    axes: Annotated[list[SenseAxis], Capacity(MAX_ACCELEROMETERS)] = param(
        None,
        "the accelerometers and their axes",
        factory=lambda: cone("a"),
        min_length=1,
        max_length=MAX_ACCELEROMETERS,
    )
    bias_ug: float = param(30.0, "bias at the start", status="estimate", ge=0.0)
    bias_walk_ug_sqrt_h: float = param(10.0, "random walk of the bias", status="estimate", ge=0.0)
    noise_ug_sqrt_hz: float = param(20.0, "velocity random walk", status="estimate", ge=0.0)
    scale_ppm: float = param(50.0, "error of the scale factor", status="estimate", ge=0.0, le=1e5)
    misalignment_arcsec: float = param(10.0, "error of the axis", status="estimate", ge=0.0, le=36000.0)
    quantum_m_s: float = param(2e-5, "velocity of one count; 0: none", status="estimate", ge=0.0)
    range_g0: float = param(40.0, "largest specific force", status="estimate", gt=0.0)
    persistence_s: float = param(
        0.0, "time for which the saturation flag stays set", status="estimate", ge=0.0, le=60.0
    )

    _names_differ = field_validator("axes")(unique_names)


class InertialUnitParams(Hardware):
    """Inertial unit of real gyros and accelerometers."""

    position_m: Vec3 = param((-0.9, 0.3, 0.0), "position of the unit in B", status="estimate")
    delay_cycles: int = param(
        1,
        "base cycles between a reading and its arrival in the flight computer",
        status="estimate",
        ge=0,
        le=DEPTH - 1,
    )
    gyros: GyroParams = group(GyroParams, "gyros")
    accelerometers: AccelerometerParams = group(AccelerometerParams, "accelerometers")
    vibration: VibrationParams = group(VibrationParams, "vibration with the engines")


#: Errors of the unit in this case.
UNIT = record(
    ("gyro", copy_layout(MAX_GYROS)),
    ("accelerometer", copy_layout(MAX_ACCELEROMETERS)),
    ("mount", MOUNT),
)

#: Memory of the unit: the motion at the last reading, the counts, and readings under way.
MEMORY = record(
    ("taken", COUNT),
    ("t", "f8"),  # s
    ("q_I2B", "f8", (4,)),
    ("w_B", "f8", (3,)),  # rad/s
    ("gain_B", "f8", (3,)),  # m/s, B: integral of the specific force of the centre of mass
    ("vibration", VIBRATION),
    ("lagging_B", "f8", (3,)),  # rad/s, B: rate behind the bandwidth of the gyros
    ("gyro", counter_layout(MAX_GYROS)),
    ("accelerometer", counter_layout(MAX_ACCELEROMETERS)),
    ("under_way", INERTIAL, (DEPTH,)),
)


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Measure the motion since the last reading and deliver the reading of ``delay_cycles`` ago."""
    turned, gained, w, dt = motion_since(params, plant, outputs, memory)
    cycle = memory.taken
    shaken_rate, shaken_turn, shaken_gain = shake(
        params.vibration, unit.mount, case, plant, outputs, dt=dt, cycle=cycle, memory=memory.vibration
    )
    turned, gained = add(turned, shaken_turn), add(gained, shaken_gain)
    w = lag(params.gyros, add(w, shaken_rate), dt, memory)
    now, faults = memory.under_way[cycle % DEPTH], plant.instruments
    count(
        params.gyros, copy=unit.gyro, faults=faults.gyro, moved=turned, t=plant.t, dt=dt, cycle=cycle,
        memory=memory.gyro, readings=now.angle, flags=now.gyro_saturated,
    )  # fmt: skip
    rates(
        params.gyros, copy=unit.gyro, faults=faults.gyro, rate=w, dt=dt, memory=memory.gyro, readings=now.rate
    )
    count(
        params.accelerometers,
        copy=unit.accelerometer,
        faults=faults.accelerometer,
        moved=gained,
        t=plant.t,
        dt=dt,
        cycle=cycle,
        memory=memory.accelerometer,
        readings=now.gain,
        flags=now.accelerometer_saturated,
    )
    hand_out(memory.under_way[max(cycle - params.delay_cycles, 0) % DEPTH], sensed.inertial)
    memory.taken += 1


@kernel
def motion_since(params, plant, outputs, memory):
    """Integrals (B) of the rate, and of the specific force at the unit, since the last reading; the present
    rate, and the time (s) since then.  Stores the present motion in ``memory``.
    """
    y = plant.y
    q = take_attitude(y)
    w, gain = take3(y, RATE), add(take3(plant.velocity_gain, 0), take3(plant.separation_gain, 0))
    turned = gained = (0.0, 0.0, 0.0)
    dt = 0.0
    if memory.taken > 0:
        dt = plant.t - memory.t
        before = memory.q_I2B
        w0 = take3(memory.w_B, 0)
        turn = rotation_vector(multiply(conjugate((before[0], before[1], before[2], before[3])), q))
        turned = sub(turn, scale(dt * dt / 12.0, cross(w0, w)))
        arm = sub(take3(params.position, 0), take3(outputs.centre, 0))
        mean = scale(0.5, add(w0, w))
        swung = add(cross(sub(w, w0), arm), scale(dt, cross(mean, cross(mean, arm))))
        gained = add(sub(gain, take3(memory.gain_B, 0)), swung)
    memory.t = plant.t
    for i in range(4):
        memory.q_I2B[i] = q[i]
    put3(memory.w_B, 0, w)
    put3(memory.gain_B, 0, gain)
    return turned, gained, w, dt


@kernel
def lag(gyros, w, dt, memory):
    """Rate ``w`` (rad/s, B) behind the first-order lag of the gyros."""
    share = 1.0
    if memory.taken > 0 and gyros.bandwidth > 0.0:
        share = 1.0 - exp(-2.0 * pi * gyros.bandwidth * dt)
    behind = take3(memory.lagging_B, 0)
    lagging = add(behind, scale(share, sub(w, behind)))
    put3(memory.lagging_B, 0, lagging)
    return lagging


@kernel
def hand_out(reading, inertial):
    """Copy a reading."""
    for i in range(MAX_GYROS):
        inertial.angle[i] = reading.angle[i]
        inertial.rate[i] = reading.rate[i]
        inertial.gyro_saturated[i] = reading.gyro_saturated[i]
    for i in range(MAX_ACCELEROMETERS):
        inertial.gain[i] = reading.gain[i]
        inertial.accelerometer_saturated[i] = reading.accelerometer_saturated[i]


def plan(params: InertialUnitParams, rng: Stream, unit: np.void) -> None:
    """Draw the errors of the instrument in this case."""
    draw_copies(in_si(params.gyros), rng, unit["gyro"])
    draw_copies(in_si(params.accelerometers), rng, unit["accelerometer"])
    draw_mount(rng, unit["mount"])


MEMBER = Member(
    "inertial_unit",
    InertialUnitParams,
    {"measure": measure},
    "Titterton and Weston, Strapdown Inertial Navigation Technology (2004), chapters 4, 5 and 11",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("inertial",),
)
