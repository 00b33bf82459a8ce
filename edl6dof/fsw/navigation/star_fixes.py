"""Star trackers: exclusion of failed ones, and the star fix, which is the mean of the others.

A star tracker is silent after a long time without a fix although the vehicle is above the atmosphere, turns
slowly, and the event that ends the view of the stars has not been requested; its next fix brings it back.

Two fixes of one cycle are compared.  If they differ by more than their errors explain, one of them is wrong.
If they have agreed before, the gyros, which have propagated the attitude since then, decide: the fix farther
from the solution is wrong, and after some such fixes in a row its tracker is excluded for good.  If they have
never agreed, nothing shows which one is wrong.  Until it is excluded, the fix is uncertain by the difference.

Source: this project.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.strapdown import attitude_at
from edl6dof.interface.capacities import MAX_TRACKERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.spatial.frames import geodetic
from edl6dof.spatial.quaternion import (
    angle_between,
    conjugate,
    multiply,
    normalise,
    rotation_vector,
)
from edl6dof.spatial.vector import dot, norm, put4, scale, take3, take4

#: Body rate, over the largest rate of the star trackers, up to which a fix is expected.
_SLOWLY = 0.8
#: Square of the angle between two fixes, over the variance about one axis, beyond which one of them is wrong:
#: chi-square of three degrees of freedom, exceeded with the probability 1e-6.
DISAGREE = 30.66


class StarWatchParams(Params):
    """Exclusion of star trackers."""

    enabled: bool = param(True, "whether star trackers are excluded")
    patience_s: float = param(
        2.0, "time without an expected fix after which a star tracker is excluded", gt=0.0, le=1e4
    )
    margin_m: float = param(
        500.0, "margin above the lowest altitude of star fixes from which one is expected", ge=0.0, le=1e6
    )
    apart_fixes: int = param(
        3, "consecutive fixes that disagree after which the wrong star tracker is excluded", ge=1, le=1000
    )


STAR_WATCH = record(
    ("without", "f8", (MAX_TRACKERS,)),  # s: duration without an expected fix
    ("refuted", FLAG, (MAX_TRACKERS,)),  # its fixes are wrong
    ("agreed", FLAG),  # two fixes have agreed
    ("apart", COUNT),  # fixes in a row that do not agree
)


@kernel
def read_stars(onboard, requested, sensed, solution, health, memory, motion):
    """Exclude star trackers, or use them again, and write the fix of the cycle into ``motion``.

    Args:
        onboard, sensed: ``ONBOARD`` and ``SENSED`` records.
        requested: flags of the events of the mission that have been requested.
        solution: ``SOLUTION`` record, of an earlier cycle.
        health, memory, motion: ``INSTRUMENT_HEALTH``, ``STAR_WATCH`` and ``MOTION`` records, updated.
    """
    params, instruments, stars = onboard.navigation.star_watch, onboard.instruments, sensed.stars
    until = instruments.star_until
    due = params.enabled != 0 and (until == 0 or requested[until - 1] == 0)
    due = due and fix_expected(params, onboard, motion, solution)
    for i in range(instruments.n_trackers):
        if stars.valid[i] != 0:
            memory.without[i] = 0.0
            health.star_tracker[i] = 1 - memory.refuted[i]
        elif due:
            memory.without[i] += motion.dt
            if memory.without[i] > params.patience:
                health.star_tracker[i] = 0
    motion.fixes, motion.fix_doubt = 0, 0.0
    if _usable(stars, health, 0) and _usable(stars, health, 1):
        first = take4(stars.q_I2B[0])
        turn = rotation_vector(multiply(take4(stars.q_I2B[1]), conjugate(first)))
        compare(params, instruments, turn, sensed, motion, solution=solution, health=health, memory=memory)
        if health.star_tracker[0] != 0 and health.star_tracker[1] != 0:
            half = scale(0.25, turn)
            put4(motion.fix_q_I2B, normalise(multiply((1.0, half[0], half[1], half[2]), first)))
            motion.fixes, motion.fix_doubt = 2, 0.25 * dot(turn, turn) if memory.apart > 0 else 0.0
            return
    for i in range(instruments.n_trackers):
        if _usable(stars, health, i):
            put4(motion.fix_q_I2B, take4(stars.q_I2B[i]))
            motion.fixes = 1


@kernel
def _usable(stars, health, i):
    return stars.valid[i] != 0 and health.star_tracker[i] != 0


@kernel
def fix_expected(params, onboard, motion, solution):
    """Return whether the vehicle turns slowly, high enough above the atmosphere."""
    planet, instruments = onboard.planet, onboard.instruments
    if solution.started == 0 or norm(take3(motion.rate, 0)) >= _SLOWLY * instruments.star_rate:
        return False
    _, _, _, _, altitude = geodetic(planet.equatorial_radius, planet.flattening, take3(solution.r_I, 0))
    return altitude > instruments.star_lowest + params.margin


@kernel
def compare(params, instruments, turn, sensed, motion, solution, health, memory):
    """Compare two fixes, which differ by the rotation vector ``turn`` (rad); exclude the tracker of the wrong
    one if it is known and has been wrong often enough.
    """
    if dot(turn, turn) <= DISAGREE * 2.0 * (instruments.star_sigma**2 + instruments.star_bias**2):
        memory.agreed, memory.apart = 1, 0
        return
    memory.apart += 1
    if params.enabled != 0 and memory.agreed != 0 and memory.apart >= params.apart_fixes:
        q = attitude_at(solution, motion, sensed.t)
        stars = sensed.stars.q_I2B
        wrong = 0 if angle_between(take4(stars[0]), q) > angle_between(take4(stars[1]), q) else 1
        memory.refuted[wrong] = 1
        health.star_tracker[wrong] = 0
