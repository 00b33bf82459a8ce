"""The convex landing problem of the flight computer, and the plan that solves it: time grid, controls and
motion.

Least fuel for a point mass that comes to rest at the origin; axes east, north, up. Lossless convexification:
the thrust acceleration u and its bound s, |u| <= s, low <= s <= high, where low and high are the thrust
limits over the mass along the plan. Thrust may begin at full level, above the throttle band; there low and
high are both full thrust over mass. Sources: Acikmese & Ploen 2007, J. Guidance 30(5); Acikmese, Carson,
Blackmore 2013, IEEE Trans. Control Systems Technology 21(6).

Velocity and position at the end are sums of u over time with the weights 1 and (time to go). Orthonormalised
these weights are ``flat`` = 1 / sqrt(time) and ``slant``: the matrix of the six conditions at the end then
has orthonormal rows, which is the best possible preconditioning.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.records import COUNT, FLAG, record
from edl6dof.spatial.table_index import cell
from edl6dof.spatial.vector import put3, take3

#: Controls of a plan: intervals of constant thrust acceleration.
CONTROLS = 30

LANDING = record(
    ("mass", "f8"),  # kg
    ("low", "f8"),  # N, least thrust
    ("high", "f8"),  # N, largest thrust
    ("low_now", "f8"),  # N, least thrust in the first seconds
    ("high_now", "f8"),  # N, largest thrust in the first seconds
    ("now", "f8"),  # s, duration of these two limits
    ("full", "f8"),  # N, full thrust, at the start
    ("exhaust_speed", "f8"),  # m/s
    ("gravity", "f8"),  # m/s2, downwards
    ("position", "f8", (3,)),  # m, from the landing point
    ("velocity", "f8", (3,)),  # m/s
    ("slope", "f8"),  # tangent of the least elevation of the lander seen from the target; negative: none
    ("cos_tilt", "f8"),  # cosine of the largest tilt of thrust
    ("cos_last_tilt", "f8"),  # cosine of the largest tilt in the last control
    ("miss_price", "f8"),  # 1/s: cost in velocity of a metre of horizontal miss
)

PLAN = record(
    ("time", "f8"),  # s, of flight
    ("full_time", "f8"),  # s, of it at full thrust, at the start
    ("u", "f8", (CONTROLS, 3)),  # m/s2
    # the primer vector is primer_end + pull * (time to go)
    ("primer_end", "f8", (3,)),
    ("pull", "f8", (3,)),  # 1/s
    ("glide", "f8", (CONTROLS, 3)),  # multipliers of the glide slope where each control ends
    ("fuel", "f8"),  # kg
    ("cost", "f8"),  # m/s: velocity spent, plus the cost of the errors at the end
    ("miss", "f8"),  # m, horizontal, at the end
    ("height_error", "f8"),  # m, at the end
    ("end_velocity", "f8", (3,)),  # m/s
    ("change", "f8"),  # of the primer, in the last iteration
    ("iterations", COUNT),  # of the last solution
    ("converged", FLAG),
    # the grid, and workspace of an iteration
    ("step", "f8", (CONTROLS,)),  # s
    ("to_go", "f8", (CONTROLS,)),  # s, from the middle of each control
    ("slant", "f8", (CONTROLS,)),  # second basis function of the end; the first is constant
    ("mass", "f8", (CONTROLS,)),  # kg, in the middle of each control
    ("w", "f8", (CONTROLS, 3)),  # m/s2, thrust acceleration within its bounds
    ("push", "f8", (CONTROLS, 3)),  # contribution of the glide slope to the primer
    ("row", "f8", (CONTROLS,)),  # scale of the glide-slope constraint where each control ends
)


@kernel
def full_controls(plan):
    """Number of controls that cover the start at full thrust."""
    if plan.full_time <= 0.0:
        return 0
    nearest, _ = cell(CONTROLS * plan.full_time / plan.time + 0.5, CONTROLS - 1)
    return max(nearest, 1)


@kernel
def lay_grid(plan):
    """Divide the time of flight into the controls; returns the mean time to go (s) and the norm of its
    deviation (s^1.5).
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
    """Move the start of the plan by ``elapsed`` s and divide its new ``time`` (s) and ``full_time`` into
    controls, each taken from the old plan at its middle. The multipliers are kept: primer at the end and pull
    are constants of the motion.
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
    """Copy a plan without its workspace."""
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


@kernel
def fly_plan(landing, plan, elapsed):
    """Position (m) and velocity (m/s), east, north, up, ``elapsed`` s after the start of a plan."""
    x, y, z = take3(landing.position, 0)
    vx, vy, vz = take3(landing.velocity, 0)
    for k in range(CONTROLS):
        step = min(plan.step[k], elapsed)
        ax, ay, az = plan.w[k, 0], plan.w[k, 1], plan.w[k, 2] - landing.gravity
        x += step * (vx + 0.5 * step * ax)
        y += step * (vy + 0.5 * step * ay)
        z += step * (vz + 0.5 * step * az)
        vx, vy, vz = vx + step * ax, vy + step * ay, vz + step * az
        elapsed -= step
        if elapsed <= 0.0:
            break
    return (x, y, z), (vx, vy, vz)
