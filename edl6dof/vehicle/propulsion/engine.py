"""Landing engines: place, direction and levels of thrust; a model gives the response of the thrust to its
command (:mod:`edl6dof.vehicle.propulsion.engine_models`).
"""

from __future__ import annotations

from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param, unit_vector
from edl6dof.config.dtype import dtype_of
from edl6dof.config.units import G0
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.vector import cross
from edl6dof.vehicle.propulsion.engine_models import (
    EngineChoice,
    goal_of_model,
    rate_of_model,
    specific_impulse_of_model,
)


class EngineParams(EngineChoice, Hardware):
    """A landing engine."""

    name: Key = param(REQUIRED, "name in events", record=False)
    group: Key | None = param(
        None, "name of a group of engines that events light and cut off together", record=False
    )
    full_thrust_n: float = param(
        REQUIRED, "thrust at the full level used at the start", gt=0.0, usual=(10, 200000, "landing engines")
    )
    throttle_min_n: float = param(
        0.0, "lower end of the throttle band", ge=0.0, usual=(1, 200000, "landing engines")
    )
    throttle_max_n: float = param(
        0.0, "upper end of the throttle band", ge=0.0, usual=(10, 200000, "landing engines")
    )
    full_specific_impulse_s: float = param(
        REQUIRED,
        "specific impulse at full thrust",
        gt=0.0,
        usual=(50, 500, "cold gas to hydrogen and oxygen"),
    )
    nozzle_m: Vec3 = param(REQUIRED, "point of thrust application in B")
    direction: Vec3 = param((-1.0, 0.0, 0.0), "unit vector of the thrust in B; -x is up when landed")
    misalignment_y_deg: float = param(
        0.0, "thrust direction turned about y of B", ge=-5.0, le=5.0, usual=(-2, 2, "mounted engines")
    )
    misalignment_z_deg: float = param(
        0.0, "thrust direction turned about z of B", ge=-5.0, le=5.0, usual=(-2, 2, "mounted engines")
    )
    draws_from: list[Key] = param(None, "tanks that feed it; empty: all", record=False, factory=list)
    thrust_factor: float = param(1.0, "delivered thrust divided by commanded thrust", gt=0.0, le=1.5)
    specific_impulse_factor: float = param(
        1.0, "true specific impulse divided by its nominal value", gt=0.0, le=1.5
    )

    @field_validator("direction")
    @classmethod
    def _unit_length(cls, value: Vec3) -> Vec3:
        found = unit_vector(value)
        if not abs(found[0]) > 0.1:
            raise ValueError(f"must push along x of B, at most 84 deg aside (got {list(value)})")
        return found


ENGINE = dtype_of(EngineParams)


@kernel
def thrust_goal(engine, t, step, command):
    """Return the goal that a ``command`` (N) sets for the thrust over a ``step`` (s) from ``t`` (s): mean (N)
    and slope (N/s).
    """
    return goal_of_model(engine.model, engine, engine, t, step, command=command)


@kernel
def thrust_rate(engine, goal, thrust, starting):
    """Return the time derivative (N/s) of the ``thrust`` (N) of an ``ENGINE`` that approaches ``goal`` (N);
    ``starting``: True during start and cut-off, where the thrust may change faster.
    """
    return rate_of_model(engine.model, engine, engine, goal, thrust, starting=starting)


@kernel
def thrust_wrench(engine, thrust, turn_y, turn_z):
    """Return the force (N, B) of an engine at ``thrust`` (N), and its moment about the origin of B (N m);
    ``turn_y``, ``turn_z``: rotations (rad) of the thrust direction in addition to the misalignment.
    """
    if thrust == 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    delivered = thrust * engine.thrust_factor
    ty, tz = engine.misalignment_y + turn_y, engine.misalignment_z + turn_z
    d = engine.direction
    x, y, z = d[0] * delivered, d[1] * delivered, d[2] * delivered
    # turned about y by ty, then about z by tz
    (sin_y, cos_y), (sin_z, cos_z) = sincos(ty), sincos(tz)
    x, z = x * cos_y + z * sin_y, z * cos_y - x * sin_y
    force = (x * cos_z - y * sin_z, x * sin_z + y * cos_z, z)
    n = engine.nozzle
    return force, cross((n[0], n[1], n[2]), force)


@kernel
def propellant_flow(engine, thrust):
    """Return the propellant mass flow (kg/s) at ``thrust`` (N).

    It may be negative: a pulse late in a step is replaced by a line over the whole step, with the same flow
    in total, and this line may begin below zero.
    """
    if thrust == 0.0:
        return 0.0
    isp = specific_impulse_of_model(engine.model, engine, engine, thrust)
    return thrust * engine.thrust_factor / (isp * engine.specific_impulse_factor * G0)
