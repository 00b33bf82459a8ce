"""Where the controls of a plan lie in time, and the two basis functions of what they do to the end.

Velocity and position at the end are sums of u over time with the weights 1 and (time to go).  Made
orthonormal they are ``flat`` = 1 / sqrt(time) and ``slant``: so the six conditions at the end have a matrix
whose rows are orthonormal, the best preconditioning that there is.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.powered.convex.problem import CONTROLS
from edl6dof.kernels import kernel
from edl6dof.spatial.table_index import cell
from edl6dof.spatial.vector import put3, take3


@kernel
def full_controls(plan):
    """How many controls fill the start at full thrust."""
    if plan.full_time <= 0.0:
        return 0
    nearest, _ = cell(CONTROLS * plan.full_time / plan.time + 0.5, CONTROLS - 1)
    return max(nearest, 1)


@kernel
def lay_grid(plan):
    """Lay the controls over the time of flight.

    Returns:
        Mean time to go (s), and the norm of (time to go less its mean), s^1.5.
    """
    count = full_controls(plan)
    short = plan.full_time / count if count > 0 else 0.0
    long = (plan.time - short * count) / (CONTROLS - count)
    to_go = plan.time
    for k in range(CONTROLS):
        plan.step[k] = short if k < count else long
        plan.to_go[k] = to_go - 0.5 * plan.step[k]
        to_go -= plan.step[k]
    mean = 0.5 * plan.time
    norm = 0.0
    for k in range(CONTROLS):
        norm += plan.step[k] * (plan.to_go[k] - mean) ** 2
    norm = sqrt(norm)
    for k in range(CONTROLS):
        plan.slant[k] = (plan.to_go[k] - mean) / norm
    return mean, norm


@kernel
def control_at(plan, elapsed):
    """Number of the control that acts ``elapsed`` s after the start of the plan."""
    end = 0.0
    for k in range(CONTROLS - 1):
        end += plan.step[k]
        if elapsed < end:
            return k
    return CONTROLS - 1


@kernel
def shift_controls(plan, elapsed, time, full_time):
    """Move the start of the plan forward by ``elapsed`` s and lay it over a new ``time``, each control taken
    from what the plan says of its middle.

    The multipliers stay: primer at the end and pull are constants of the motion.
    """
    share = (plan.time - elapsed) / time
    old_full, old_time, old_count = plan.full_time, plan.time, full_controls(plan)
    push = plan.push
    for k in range(CONTROLS):
        for axis in range(3):
            plan.w[k, axis], push[k, axis] = plan.u[k, axis], plan.glide[k, axis]
    plan.time, plan.full_time = time, full_time
    lay_grid(plan)
    for k in range(CONTROLS):
        at = old_time - plan.to_go[k] * share
        if at < old_full and old_count > 0:
            j, _ = cell(at / old_full * old_count, old_count)
        else:
            rest = CONTROLS - old_count
            j, _ = cell((at - old_full) / (old_time - old_full) * rest, rest)
            j += old_count
        for axis in range(3):
            plan.u[k, axis] = plan.w[j, axis]
            plan.glide[k, axis] = push[j, axis]


@kernel
def copy_plan(source, target):
    """Copy what a search goes on from and what guidance follows."""
    target.time, target.full_time = source.time, source.full_time
    target.fuel, target.cost, target.miss = source.fuel, source.cost, source.miss
    target.height_error, target.change = source.height_error, source.change
    target.iterations, target.converged = source.iterations, source.converged
    put3(target.primer_end, 0, take3(source.primer_end, 0))
    put3(target.pull, 0, take3(source.pull, 0))
    put3(target.end_velocity, 0, take3(source.end_velocity, 0))
    for k in range(CONTROLS):
        for axis in range(3):
            target.u[k, axis], target.w[k, axis] = source.u[k, axis], source.w[k, axis]
            target.glide[k, axis] = source.glide[k, axis]
        target.step[k], target.to_go[k], target.mass[k] = source.step[k], source.to_go[k], source.mass[k]
