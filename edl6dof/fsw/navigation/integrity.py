"""Guards: plausibility checks of height, speed and vertical of the solution.

Four checks, each with a switch, detect: a height below the ground while no footpad touches it; a jump of the
height, compared with the integrated vertical velocity, beyond its uncertainty; a speed that contradicts the
radar beams; echoes of beams that point above the horizon according to the estimated attitude. A height that
jumps is withheld for some time: the output is the last plausible height, propagated with the vertical
velocity. If another check fails, the attitude counts as lost until the vertical is determined again
(:mod:`.recovery`). Meanwhile the output is the height computed from the ranges as if x of B pointed straight
down or, before the first echo, at least the largest height at which the radar measures.

Source: T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017): a
saturated gyro turned the estimated attitude over, the estimated height became negative, and the parachute was
released at a height of 3.7 km.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.radar_beams import height_from_beams, velocity_from_beams
from edl6dof.fsw.navigation.recovery import declare_lost
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record, whole
from edl6dof.spatial.elementary import sin
from edl6dof.spatial.frames import geodetic, ned_to_fixed
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, norm, take3, take4

#: The checks, a bit for each.
BELOW_GROUND, JUMP, SPEED, ABOVE_HORIZON = 1, 2, 4, 8
#: Message of each failed check, in the order of the bits.
CHECKS = ("height below ground", "height jumps", "speed against the beams", "echo from above the horizon")
#: Direction of the vertical down for a vehicle that hangs upright, B.
_HANGING = (1.0, 0.0, 0.0)


class GuardParams(Params):
    """Integrity checks of height, velocity and vertical."""

    below_ground: bool = param(True, "whether a height below the ground starts the recovery of the vertical")
    jump: bool = param(True, "whether a height that contradicts the integrated velocity is withheld")
    speed: bool = param(True, "whether a speed that contradicts the beams starts the recovery")
    vertical: bool = param(True, "whether echoes from above the horizon start the recovery")
    margin_m: float = param(
        10.0, "margin of the height: below the ground, and against the expected height", gt=0.0, le=1e4
    )
    speed_margin_m_s: float = param(20.0, "margin of the speed against that of the beams", gt=0.0, le=1e4)
    sigmas: float = param(5.0, "further margin of height and speed, in standard deviations", gt=0.0, le=100.0)
    patience_s: float = param(3.0, "time for which a height that jumps is withheld", ge=0.0, le=100.0)
    looks: int = param(5, "looks of the radar in a row that must contradict the speed", ge=1, le=1000)
    horizon_deg: float = param(10.0, "least angle of a beam below the horizon", ge=0.0, le=90.0)


INTEGRITY = record(
    ("failed", whole(0, 2 ** len(CHECKS) - 1)),  # checks failed in this cycle
    ("first_t", "f8", (len(CHECKS),)),  # s, flight time: when each failed first; 0: never
    ("begun", FLAG),  # there was an output
    ("height", "f8"),  # m: last output height
    ("sigma", "f8"),  # m: standard deviation of the last height
    ("withheld", "f8"),  # s: time for which the height has been withheld
    ("held", "f8"),  # m: output height while the attitude is lost
    ("looks", COUNT),  # looks of the radar in a row that contradicted the speed
)


@kernel
def height_and_climb(planet, site, r, v, terrain):
    """Height above ground ``terrain`` over the site (m), its rate (m/s), and the unit vector up (I)."""
    s_lat, c_lat, s_lon, c_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r)
    up = ned_to_fixed(s_lat, c_lat, s_lon, c_lon, (0.0, 0.0, -1.0))
    spin = planet.rotation_rate
    return altitude - site.altitude - terrain, dot((v[0] + spin * r[1], v[1] - spin * r[0], v[2]), up), up


@kernel
def plausible_height(params, height, climb, sigma, contact, dt, memory):
    """Return the height (m) to output; ``height`` (m), ``climb`` (m/s) and ``sigma`` (m): of the solution;
    ``contact``: whether a footpad touches the ground; ``dt``: of the cycle (s).
    """
    memory.failed = 0
    expected = memory.height + climb * dt if memory.begun != 0 else height
    off = params.margin + params.sigmas * max(sigma, memory.sigma)
    if height < -params.margin and contact == 0:
        memory.failed |= BELOW_GROUND
    if abs(height - expected) > off:
        memory.failed |= JUMP
    if params.jump != 0 and memory.failed & JUMP and memory.withheld < params.patience:
        memory.withheld += dt
        height = expected
    else:
        memory.withheld = 0.0
        memory.sigma = sigma
    memory.begun, memory.height = 1, height
    return height


@kernel
def beams_contradict_speed(params, instruments, health, radar, speed, sigma, memory):
    """Return whether the beams have contradicted ``speed`` (m/s; ``sigma``: its standard deviation) in
    several looks in a row.
    """
    velocity, seen = velocity_from_beams(instruments, health, radar)
    if seen:
        off = abs(norm(velocity) - speed) > params.speed_margin + params.sigmas * sigma
        memory.looks = memory.looks + 1 if off else 0
    return memory.looks >= params.looks


@kernel
def beams_contradict_vertical(params, instruments, radar, q, up):
    """Return whether at least two beams have an echo although, by the attitude ``q``, they point less than
    ``params.horizon`` below the horizon; ``up``: unit vector, I. A single such beam may have failed.
    """
    if radar.fresh == 0:
        return False
    least, seen = sin(params.horizon), 0
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and -dot(from_frame(q, take3(instruments.beam_axis[i], 0)), up) < least:
            seen += 1
    return seen > 1


@kernel
def check_solution(params, instruments, health, sensed, speed, sigma, q, up, memory, recovery):
    """Check speed and vertical, store the time of the first failure of each check, and declare the attitude
    lost where a check fails.

    Args:
        params, instruments, health, sensed: ``GuardParams``, ``INSTRUMENTS``, ``INSTRUMENT_HEALTH`` and
            ``SENSED`` records.
        speed, sigma: planet-relative speed and its standard deviation, m/s.
        q, up: attitude ``q_I2B``; unit vector, I.
        memory, recovery: ``INTEGRITY`` and ``RECOVERY`` records, updated.
    """
    if beams_contradict_speed(params, instruments, health, sensed.radar, speed, sigma=sigma, memory=memory):
        memory.failed |= SPEED
    if beams_contradict_vertical(params, instruments, sensed.radar, q, up):
        memory.failed |= ABOVE_HORIZON
    if recovery.lost != 0:
        return
    for k in range(len(CHECKS)):
        if memory.failed >> k & 1 and memory.first_t[k] == 0.0:
            memory.first_t[k] = sensed.t
    switched_on = BELOW_GROUND * params.below_ground + SPEED * params.speed + ABOVE_HORIZON * params.vertical
    if memory.failed & switched_on and instruments.n_beams > 2:
        declare_lost(recovery)
        memory.held = max(memory.height, instruments.radar_ceiling)


@kernel
def height_while_lost(instruments, health, radar, memory):
    """Return the height (m) to output while the attitude is lost: that of the last radar ranges, as if x of B
    pointed straight down.
    """
    if radar.fresh != 0:
        seen = height_from_beams(instruments, health, radar, _HANGING)
        if seen > 0.0:
            memory.held = seen
    memory.height = memory.held
    return memory.held


@kernel
def check_integrity(onboard, sensed, memory, estimate):
    """Set the height of ``estimate`` to a plausible one; start the recovery where a check fails."""
    params, solution, instruments = onboard.navigation.guards, memory.solution, onboard.instruments
    r, v = take3(estimate.r_I, 0), take3(estimate.v_I, 0)
    height, climb, up = height_and_climb(onboard.planet, onboard.site, r, v, solution.terrain)
    height = plausible_height(
        params,
        height,
        climb,
        sigma=solution.sigma_height,
        contact=sensed.footpad_contact,
        dt=memory.motion.dt,
        memory=memory.integrity,
    )
    spin = onboard.planet.rotation_rate
    speed = norm((v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    q = take4(estimate.q_I2B)
    check_solution(
        params, instruments, memory.health, sensed, speed, sigma=norm(take3(solution.sigma_v, 0)), q=q, up=up,
        memory=memory.integrity, recovery=memory.recovery,
    )  # fmt: skip
    if memory.recovery.lost != 0:
        height = height_while_lost(instruments, memory.health, sensed.radar, memory.integrity)
    estimate.height_above_ground = height
