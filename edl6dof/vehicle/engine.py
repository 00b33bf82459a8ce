"""Landing engines: start at full level, throttle band, first-order valve with a rate limit, specific
impulse by throttle.
"""

from __future__ import annotations

from math import cos, sin
from typing import ClassVar

from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param, unit_vector
from edl6dof.config.dtype import dtype_of
from edl6dof.jit import kernel
from edl6dof.spatial.vector import clamp, cross

G0 = 9.80665


class EngineParams(Hardware):
    """A throttled engine."""

    former: ClassVar = {"ignition_delay_s": "delay_s of the event that ignites the engine"}

    name: Key = param(REQUIRED, "name that events call it by", record=False)
    full_thrust_n: float = param(REQUIRED, "thrust at the full level used at the start", gt=0.0)
    throttle_min_n: float = param(0.0, "lower end of the throttle band", ge=0.0)
    throttle_max_n: float = param(0.0, "upper end of the throttle band", ge=0.0)
    full_specific_impulse_s: float = param(
        300.0, "specific impulse at full thrust", status="estimate", gt=0.0
    )
    low_specific_impulse_s: float = param(
        285.0, "specific impulse at the lower end of the band", status="estimate", gt=0.0
    )
    lag_s: float = param(0.15, "first-order time constant of the thrust", status="estimate", gt=0.0)
    rate_n_s: float = param(
        1500.0, "largest rate of change of thrust while throttling", status="estimate", gt=0.0
    )
    start_rate_n_s: float = param(
        25000.0, "rate of thrust build-up at ignition and of decay at cut-off", status="estimate", gt=0.0
    )
    nozzle_m: Vec3 = param((0.0, 0.0, 0.0), "point of thrust application in B")
    direction: Vec3 = param((-1.0, 0.0, 0.0), "unit vector of the thrust in B; -x is up when landed")
    misalignment_y_deg: float = param(0.0, "thrust direction turned about y of B", ge=-5.0, le=5.0)
    misalignment_z_deg: float = param(0.0, "thrust direction turned about z of B", ge=-5.0, le=5.0)
    thrust_factor: float = param(1.0, "thrust delivered over thrust commanded", gt=0.0, le=1.5)
    specific_impulse_factor: float = param(1.0, "specific impulse over its table value", gt=0.0, le=1.5)

    @field_validator("direction")
    @classmethod
    def _unit_length(cls, value: Vec3) -> Vec3:
        return unit_vector(value)


ENGINE = dtype_of(EngineParams)


@kernel
def thrust_rate(engine, thrust, command, starting):
    """Time derivative of thrust (N/s) towards the commanded level; ``starting`` selects the fast build-up and
    cut-off rate.
    """
    limit = engine.start_rate if starting else engine.rate
    return clamp((command - thrust) / engine.lag, -limit, limit)


@kernel
def thrust_wrench(engine, thrust):
    """Force and moment about the origin of B (two tuples, N and N m) of the engine at ``thrust`` N."""
    if thrust == 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    delivered = thrust * engine.thrust_factor
    ty, tz = engine.misalignment_y, engine.misalignment_z
    d = engine.direction
    x, y, z = d[0] * delivered, d[1] * delivered, d[2] * delivered
    # turned about y by ty, then about z by tz
    x, z = x * cos(ty) + z * sin(ty), z * cos(ty) - x * sin(ty)
    force = (x * cos(tz) - y * sin(tz), x * sin(tz) + y * cos(tz), z)
    n = engine.nozzle
    return force, cross((n[0], n[1], n[2]), force)


@kernel
def propellant_flow(engine, thrust):
    """Propellant mass flow (kg/s) at ``thrust`` N; the specific impulse runs linearly from the band's lower
    end to full thrust.
    """
    if thrust <= 0.0:
        return 0.0
    span = engine.full_thrust - engine.throttle_min
    share = clamp((thrust - engine.throttle_min) / span, 0.0, 1.0) if span > 0.0 else 1.0
    isp = engine.low_specific_impulse + share * (engine.full_specific_impulse - engine.low_specific_impulse)
    return thrust * engine.thrust_factor / (isp * engine.specific_impulse_factor * G0)
