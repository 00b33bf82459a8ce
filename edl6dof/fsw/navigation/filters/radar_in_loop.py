"""Inertial solution whose height and velocity the radar corrects, while the attitude is that of the inertial
unit alone.

The radar is first compared with the inertial solution. It corrects the solution as soon as both have agreed
for a time, or after a longer time of contradiction, because no landing is possible without the radar. The
height is the mean over the beams of the slant range times the cosine of the angle between the beam and the
estimated vertical. The height is not checked: if the estimated attitude is upside down, the cosine, and so
the height, is negative.

Source: the landing of Schiaparelli, T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA
DG-I/2017/546/TTN (2017): consistency check of radar and inertial unit, time-out, projection of the ranges.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.radar_beams import (
    count_usable_beams,
    height_from_beams,
    locked_beams,
    place_antenna,
    velocity_from_beams,
)
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, norm, put3, scale, sub, take3


class RadarInLoopParams(Params):
    """Parameters of an inertial solution that the radar corrects once both agree, or after a time limit."""

    settle_s: float = param(
        10.0, "time from the first echo until radar and solution are compared", status="estimate", ge=0.0
    )
    agree_s: float = param(
        1.0, "time of agreement after which the radar corrects the solution", status="estimate", ge=0.0
    )
    patience_s: float = param(
        5.0,
        "time of contradiction after which the radar corrects the solution in any case",
        status="recalled",
        source="ESA DG-I/2017/546/TTN",
        ge=0.0,
    )
    height_margin_m: float = param(
        500.0, "difference of height up to which both agree", status="estimate", gt=0.0
    )
    speed_margin_m_s: float = param(
        20.0, "difference of velocity up to which both agree", status="estimate", gt=0.0
    )
    lag_s: float = param(0.5, "time constant with which the solution follows the radar", gt=0.0)


RADAR_IN_LOOP = record(
    ("started_t", "f8"),  # s, flight time
    ("age", "f8"),  # s: since the last use of the radar
    ("begun", FLAG),  # there was an echo
    ("seen", "f8"),  # s: duration of echoes
    ("agreed", "f8"),  # s: duration of the present agreement of radar and inertial solution
    ("against", "f8"),  # s: duration of their present contradiction
    ("in_loop", FLAG),  # the radar corrects the solution
    ("forced", FLAG),  # in the loop in spite of a contradiction
)


@kernel
def start(params, onboard, sensed, solution, memory):
    """Start without an echo."""
    memory.started_t = solution.t
    memory.age = memory.seen = memory.agreed = memory.against = 0.0
    memory.begun = memory.in_loop = memory.forced = 0
    _report_covariance(onboard, solution, memory)


@kernel
def correct(params, onboard, health, sensed, motion, solution, memory):
    """Compare the radar with the solution, or correct the solution by the radar, where there are echoes."""
    memory.age += motion.dt
    n_beams = onboard.instruments.n_beams
    if sensed.radar.fresh == 0 or count_usable_beams(health, sensed.radar, n_beams) == 0:
        return
    dt = memory.age if memory.begun != 0 else 0.0
    memory.begun, memory.age, memory.seen = 1, 0.0, memory.seen + dt
    q, lever, velocity, swing, up, height = place_antenna(onboard, motion, solution, sensed.t)
    at_antenna, moving = velocity_from_beams(onboard.instruments, health, sensed.radar)
    below = height_from_beams(onboard.instruments, health, sensed.radar, to_frame(q, scale(-1.0, up)))
    higher = below - height
    faster = sub(sub(from_frame(q, at_antenna), swing), velocity) if moving else (0.0, 0.0, 0.0)
    share = 1.0 - exp(-dt / params.lag)
    if memory.in_loop == 0 and memory.seen > params.settle:
        _compare(params, abs(higher), norm(faster), dt, memory)
        share = 1.0  # adopted at once when the radar enters the loop
    if memory.in_loop != 0:
        put3(solution.r_I, 0, add(take3(solution.r_I, 0), scale(share * higher, up)))
        put3(solution.v_I, 0, add(take3(solution.v_I, 0), scale(share, faster)))
        solution.beams_used, solution.looked = locked_beams(sensed.radar, n_beams), 1
    _report_covariance(onboard, solution, memory)


@kernel
def _compare(params, height_off, speed_off, dt, memory):
    """Put the radar into the loop after a time of agreement, or of contradiction; ``height_off`` (m) and
    ``speed_off`` (m/s): differences from the solution.
    """
    if height_off < params.height_margin and speed_off < params.speed_margin:
        memory.agreed, memory.against = memory.agreed + dt, 0.0
    else:
        memory.agreed, memory.against = 0.0, memory.against + dt
    if memory.agreed > params.agree or memory.against > params.patience:
        memory.in_loop = 1
        memory.forced = 1 if memory.against > params.patience else 0


@kernel
def _report_covariance(onboard, solution, memory):
    """Write the standard deviations: of dead reckoning from the start; in the loop, those of the radar."""
    known, t = onboard.instruments, solution.t - memory.started_t
    turned = known.star_sigma**2 + known.star_bias**2 + known.gyro_noise**2 * t + (known.gyro_bias * t) ** 2
    for i in range(3):
        tracked = known.tracking_velocity[i, i]
        solution.sigma_r[i] = sqrt(known.tracking_position[i, i] + tracked * t**2)
        solution.sigma_v[i] = known.speed_sigma if memory.in_loop != 0 else sqrt(tracked)
        solution.sigma_attitude[i] = sqrt(turned)
    own = sqrt(known.range_sigma**2 + known.range_bias**2)
    solution.sigma_height = own if memory.in_loop != 0 else solution.sigma_r[2]


MEMBER = Member(
    "radar_in_loop",
    RadarInLoopParams,
    {"start": start, "correct": correct},
    "Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017)",
    memory=RADAR_IN_LOOP,
    reads=("inertial", "stars", "radar", "tracking"),
)
