"""The last hundred metres: hover and imaging, lateral hazard avoidance, slow vertical descent.

Height is controlled by thrust, lateral motion in hover by a small tilt, then by the horizontal thrusters with
the vehicle upright. The lateral bias force (a misaligned engine, wind) is fed forward: tilt or thrusters
cancel it before it moves the vehicle. Source of the sequence: Hu et al. 2022, sections 6.3 and 6.4; the laws
are proportional-derivative, an estimate.
"""

from __future__ import annotations

from math import sqrt
from typing import Literal

from edl6dof.config.base import Params, param
from edl6dof.interface.effectors import ENGINE_FULL, ENGINE_THROTTLE
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import exp, tan
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import clamp, dot, put3, take3, take4

LATERAL_BIAS = record(("known", FLAG), ("force_N", "f8", (2,)))


@kernel
def lateral_bias(time_constant, nav, disturbance, dt, memory):
    """Return the lateral bias force, north and east (N): the steady force across the thrust axis that neither
    engine nor thrusters explain.

    It is the estimated disturbance force (Hu et al. 2022, eqs. 10-12) without its axial part, turned into
    north and east and smoothed over ``time_constant`` (s), since each estimate contains the vibration of the
    engine; ``memory``: ``LATERAL_BIAS`` record, which starts with the first estimate.
    """
    q = take4(nav.q_I2B)
    force = from_frame(q, (0.0, disturbance.force[1], disturbance.force[2]))
    step = 1.0 - exp(-dt / time_constant) if memory.known != 0 else 1.0
    memory.known = 1
    memory.force_N[0] += step * (dot(force, take3(nav.north_I, 0)) - memory.force_N[0])
    memory.force_N[1] += step * (dot(force, take3(nav.east_I, 0)) - memory.force_N[1])
    return memory.force_N[0], memory.force_N[1]


class TerminalParams(Params):
    """Hover, hazard avoidance and slow descent."""

    hover_height_m: float = param(
        100.0, "height of hover and imaging", status="published", source="S1", gt=0.0
    )
    avoidance_rate_m_s: float = param(3.3, "descent rate during hazard avoidance", status="estimate", gt=0.0)
    avoidance_height_m: float = param(
        20.0, "height at which hazard avoidance ends", status="published", source="S1", gt=0.0
    )
    touchdown_rate_m_s: float = param(
        1.7, "descent rate of the slow descent", status="estimate", gt=0.0, le=5.0
    )
    safe_spot_north_m: float = param(
        15.0, "safe spot found by imaging, north of the hover point", status="estimate", ge=-100.0, le=100.0
    )
    safe_spot_east_m: float = param(
        -10.0, "safe spot found by imaging, east of the hover point", status="estimate", ge=-100.0, le=100.0
    )
    height_gain: float = param(0.25, "descent rate per height error, 1/s", gt=0.0)
    rate_gain: float = param(1.0, "acceleration per descent-rate error, 1/s", gt=0.0)
    position_gain: float = param(0.18, "lateral velocity per position error, 1/s", ge=0.0)
    velocity_gain: float = param(0.8, "lateral acceleration per velocity error, 1/s", ge=0.0)
    lateral_speed_m_s: float = param(2.0, "largest lateral speed", gt=0.0)
    lateral_force_n: float = param(
        450.0, "largest lateral force demanded of a pair of horizontal thrusters", status="estimate", gt=0.0
    )
    hover_tilt_limit_deg: float = param(
        4.0, "largest tilt used in hover to stop lateral motion", ge=0.0, le=20.0
    )
    settle_gain: float = param(0.4, "lateral acceleration per velocity in hover, by tilt, 1/s", ge=0.0)
    touchdown_velocity_gain: float = param(
        0.2, "lateral acceleration per velocity in slow descent, 1/s", ge=0.0
    )
    rest_height_m: float = param(
        3.0, "height below which horizontal thrusters are off, to touch down without rotation", ge=0.0
    )
    descent_sideways: Literal["thrusters", "tilt"] = param(
        "thrusters",
        "actuator against lateral motion in slow descent: horizontal thrusters, or the small tilt of hover",
    )
    standing_force_s: float = param(
        1.0, "smoothing time of the lateral bias force that is fed forward", gt=0.0
    )


#: Least upward component of the wanted acceleration (m/s2), so that thrust never points down.
LEAST_UPWARD = 0.5

#: Index of ``tilt`` among the choices of ``descent_sideways``.
BY_TILT = 1

TERMINAL = record(("bias", LATERAL_BIAS), ("target_set", FLAG), ("target_L", "f8", (2,)))


@kernel
def command_thrust(mass, acceleration, tilt_limit, out):
    """Convert a thrust acceleration (north, east, up, m/s2, including the part that balances gravity) to
    thrust direction and magnitude (N), and write them into ``out``.
    """
    north, east, up = acceleration
    up = max(up, LEAST_UPWARD)
    side = sqrt(north * north + east * east)
    limit = up * tan(tilt_limit)
    shrink = limit / side if side > limit and side > 0.0 else 1.0
    north, east = north * shrink, east * shrink
    size = sqrt(north * north + east * east + up * up)
    put3(out.thrust_direction_N, 0, (north / size, east / size, -up / size))
    out.thrust = mass * size


@kernel
def throttle(engine, out):
    """Set throttled mode, and limit the thrust to the throttle band."""
    out.engine_mode = ENGINE_THROTTLE
    out.thrust = clamp(out.thrust, engine.throttle_min, engine.throttle_max)


@kernel
def start_or_throttle(engine, weak, full_time, full_again, elapsed, out):
    """Command full level at the start, until the demand is inside the throttle band; full level again where
    the demand is far above the band, as after a fast release or with a weak engine, and whenever the law
    wants it.

    Args:
        engine: ``ENGINE_ABILITY`` record of the burning engines.
        weak: whether the engines are believed to give less than commanded.
        full_time: shortest time at full level, s.
        full_again: demand, over the upper end of the band, above which full level is used again; a weak
            engine uses it where it is nearer to the demand.
        elapsed: time since ignition, s.
        out: ``GUIDE`` record: thrust and engine mode are written.
    """
    beyond = 1.0
    if out.engine_mode == ENGINE_THROTTLE:
        beyond = 0.5 * (1.0 + engine.full_thrust / engine.throttle_max) if weak else full_again
    if out.full_wanted != 0 or out.thrust > beyond * engine.throttle_max or elapsed < full_time:
        out.engine_mode = ENGINE_FULL
        out.thrust = engine.full_thrust
    else:
        throttle(engine, out)


@kernel
def vertical(p, nav, rate):
    """Return the upward thrust acceleration (m/s2, including the part that balances gravity) that controls
    the descent rate to ``rate`` (m/s).
    """
    return nav.gravity + p.rate_gain * (nav.v_N[2] - rate)


@kernel
def hover(p, engine, nav, mass, bias, out):
    """Hold the hover height; stop lateral velocity and compensate the ``bias`` (north, east, N) by a small
    tilt.
    """
    rate = clamp(p.height_gain * (nav.height - p.hover_height), -2.0, 4.0)
    settle_by_tilt(p, engine, nav, mass, rate, bias=bias, out=out)


@kernel
def settle_by_tilt(p, engine, nav, mass, rate, bias, out):
    """Descend at ``rate`` m/s; stop lateral velocity and compensate the lateral ``bias`` (N) by a
    small tilt.
    """
    out.translating = 0
    north = -p.settle_gain * nav.v_N[0] - bias[0] / mass
    east = -p.settle_gain * nav.v_N[1] - bias[1] / mass
    command_thrust(mass, (north, east, vertical(p, nav, rate)), p.hover_tilt_limit, out)
    throttle(engine, out)


@kernel
def stay_upright(p, engine, nav, mass, rate, out):
    """Descend at ``rate`` m/s with vertical thrust."""
    command_thrust(mass, (0.0, 0.0, vertical(p, nav, rate)), 0.0, out)
    throttle(engine, out)


@kernel
def push_sideways(p, mass, acceleration, bias, out):
    """Command lateral force for ``acceleration`` (north, east, m/s2) against the lateral ``bias`` (N)."""
    limit = p.lateral_force
    out.translating = 1
    out.force_N[0] = clamp(mass * acceleration[0] - bias[0], -limit, limit)
    out.force_N[1] = clamp(mass * acceleration[1] - bias[1], -limit, limit)


@kernel
def acceleration_towards(p, nav, north, east):
    """Lateral acceleration (north, east, m/s2) towards a point ``north`` and ``east`` of the lander (m), with
    limited speed.
    """
    v_n, v_e = p.position_gain * north, p.position_gain * east
    slower = min(p.lateral_speed / max(sqrt(v_n * v_n + v_e * v_e), 1e-9), 1.0)
    return p.velocity_gain * (slower * v_n - nav.v_N[0]), p.velocity_gain * (slower * v_e - nav.v_N[1])


@kernel
def avoid(p, engine, nav, mass, bias, point, memory, out):
    """Fly sideways to the spot of hazard detection, or else to the given safe spot, while descending."""
    if point.fine_known != 0:
        memory.target_set = 1
        memory.target_L[0], memory.target_L[1] = point.fine_L[0], point.fine_L[1]
    elif memory.target_set == 0:
        memory.target_set = 1
        memory.target_L[0] = nav.site_L[0] + p.safe_spot_east
        memory.target_L[1] = nav.site_L[1] + p.safe_spot_north
    north, east = memory.target_L[1] - nav.site_L[1], memory.target_L[0] - nav.site_L[0]
    push_sideways(p, mass, acceleration_towards(p, nav, north, east), bias, out)
    # slow down towards the final descent rate at the end of the phase
    above = max(nav.height - p.avoidance_height, 0.0)
    rate = min(p.avoidance_rate, p.touchdown_rate + p.height_gain * above)
    stay_upright(p, engine, nav, mass, rate, out=out)


@kernel
def descend(p, engine, nav, mass, bias, point, out):
    """Descend at the touchdown rate. Until shortly before contact the horizontal thrusters hold the position
    over the chosen spot, or stop lateral velocity if none was chosen; a vehicle without them tilts as in
    hover.
    """
    if p.descent_sideways == BY_TILT:
        settle_by_tilt(p, engine, nav, mass, rate=p.touchdown_rate, bias=bias, out=out)
        return
    gain = p.touchdown_velocity_gain
    wanted = -gain * nav.v_N[0], -gain * nav.v_N[1]
    if point.fine_known != 0:
        north, east = point.fine_L[1] - nav.site_L[1], point.fine_L[0] - nav.site_L[0]
        wanted = acceleration_towards(p, nav, north, east)
    push_sideways(p, mass, wanted, bias, out)
    if nav.height < p.rest_height:
        out.translating = 0
    stay_upright(p, engine, nav, mass, rate=p.touchdown_rate, out=out)
