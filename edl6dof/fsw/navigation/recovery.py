"""Recovery of the vertical after a loss of attitude, from gravity and the velocity measured by the radar.

The radar beams give the velocity in B for any attitude. The gyros transform it to axes that do not rotate,
whose orientation is unknown. In these axes the velocity changes by gravity and by the specific force, which
the accelerometers measure. The change of velocity over some seconds, minus the integral of the specific
force, is therefore due to gravity, whatever the wind and the swinging. The attitude is rotated until this
gravity points down, and velocity and height are set to those of the radar. The heading is not changed. If the
star tracker has a fix, its attitude is used instead.

Source: this project; gravity direction and velocity as references after a loss of attitude: Li et al., J.
Astronautics 43(1), 2022.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.radar_beams import height_from_beams, velocity_from_beams
from edl6dof.fsw.navigation.strapdown import adopt_attitude, attitude_at, gravity_I, level_axes, turn_by
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, cross, dot, norm, put3, put4, scale, sub, take3, take4, unit


class RecoveryParams(Params):
    """Recovery of the vertical after the attitude was lost."""

    gap_s: float = param(
        3.0, "gap of the gyros after which the attitude counts as lost", status="estimate", gt=0.0, le=1000.0
    )
    window_s: float = param(10.0, "time over which gravity is determined", gt=0.0, le=100.0)
    found_deg: float = param(
        2.0, "standard deviation of the vertical after recovery", status="estimate", gt=0.0, le=90.0
    )


RECOVERY = record(
    ("lost", FLAG),  # the attitude is not to be trusted
    ("gap", "f8"),  # s: duration of the gap of the gyros; 0: no gap
    ("begun", FLAG),  # the radar has measured the first velocity
    ("since", "f8"),  # s: time since the first velocity
    ("velocity", "f8", (3,)),  # m/s: first velocity, in the axes used for I
    ("gained", "f8", (3,)),  # m/s: integral of the specific force since then, in these axes
    ("found_t", "f8"),  # s, flight time: when the vertical was last found again; 0: never
)


@kernel
def declare_lost(memory):
    """Declare the attitude lost."""
    if memory.lost == 0:
        memory.lost, memory.begun = 1, 0


@kernel
def recover(params, onboard, health, sensed, motion, memory, solution):
    """While the attitude is lost, determine gravity from the cycles of ``motion``, and then correct
    ``solution``.

    Args:
        params: ``RecoveryParams`` record.
        onboard: ``ONBOARD`` record: planet, site and instruments.
        health, sensed, motion: ``INSTRUMENT_HEALTH``, ``SENSED`` and ``MOTION`` records.
        memory, solution: ``RECOVERY`` and ``SOLUTION`` records, updated.
    """
    if motion.rate_known == 0:
        memory.gap, memory.begun = memory.gap + motion.dt, 0
        if memory.gap > params.gap:
            declare_lost(memory)
        return
    memory.gap = 0.0
    if memory.lost == 0:
        return
    _look_for_gravity(params, onboard, health, sensed, motion, memory=memory, solution=solution)


@kernel
def _look_for_gravity(params, onboard, health, sensed, motion, memory, solution):
    """Run a cycle of :func:`recover` while the attitude is lost and the rate is known."""
    if motion.fixes > 0:
        adopt_attitude(sensed, motion, solution)
        memory.lost = 0
        return
    q = take4(solution.q_I2B)
    memory.since += motion.dt
    put3(memory.gained, 0, add(take3(memory.gained, 0), from_frame(q, take3(motion.gain, 0))))
    at_antenna, seen = velocity_from_beams(onboard.instruments, health, sensed.radar)
    if not seen:
        return
    arm = sub(take3(onboard.instruments.antenna_position, 0), take3(motion.centre, 0))
    own = sub(at_antenna, cross(take3(motion.rate, 0), arm))
    velocity = from_frame(attitude_at(solution, motion, sensed.t), own)
    if memory.begun == 0:
        memory.begun, memory.since = 1, 0.0
        put3(memory.velocity, 0, velocity)
        put3(memory.gained, 0, (0.0, 0.0, 0.0))
    elif memory.since >= params.window:
        gravity = sub(sub(velocity, take3(memory.velocity, 0)), take3(memory.gained, 0))
        turn = _set_upright(onboard.planet, gravity, solution)
        _take_over(onboard, health, sensed.radar, from_frame(turn, velocity), solution)
        solution.new_attitude_variance = params.found**2
        memory.lost, memory.found_t = 0, sensed.t


@kernel
def _set_upright(planet, gravity, solution):
    """Rotate the attitude until ``gravity`` (of any length) has the direction of that of the planet; returns
    the rotation quaternion.
    """
    true = gravity_I(planet, take3(solution.r_I, 0))
    axis = cross(gravity, true)
    angle = scale(atan2(norm(axis), dot(gravity, true)), unit(axis))
    q = take4(solution.q_I2B)
    turned = turn_by(q, to_frame(q, angle))
    put4(solution.q_I2B, turned)
    return turn_by((1.0, 0.0, 0.0, 0.0), angle)


@kernel
def _take_over(onboard, health, radar, velocity, solution):
    """Set the velocity to ``velocity`` (m/s, I, planet-relative), and the height to that by the echoes."""
    r, spin = take3(solution.r_I, 0), onboard.planet.rotation_rate
    put3(solution.v_I, 0, (velocity[0] - spin * r[1], velocity[1] + spin * r[0], velocity[2]))
    _, _, up, altitude = level_axes(onboard.planet, r, solution.t)
    q = take4(solution.q_I2B)
    seen = height_from_beams(onboard.instruments, health, radar, to_frame(q, scale(-1.0, up)))
    height = altitude - onboard.site.altitude - solution.terrain
    put3(solution.r_I, 0, add(r, scale(seen - height, up)))
