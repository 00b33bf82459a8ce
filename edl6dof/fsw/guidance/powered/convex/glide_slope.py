"""The glide slope: where each control ends, the lander is inside a cone that stands on the landing point.

It is asked of the motion whose end is put right, which is the motion itself once the end is right: then its
multipliers are orthogonal to those of the end, and the largest gain from thrust to position is that of a beam
clamped at both ends, time^2 / 4.730^2.

Near its ends a beam gives way to nothing: at the share x of the time a row has a length that goes with (x (1
- x))^1.5, a hundredth of that in the middle where the last controls end.  Each row is made as long as that in
the middle, so that multipliers near the landing point move as fast as the others: the largest gain of all
of them together grows by no more than 1.4, as rows far from each other have little to do with each other.
Source: diagonal preconditioning, Pock and Chambolle 2011, "Diagonal preconditioning for first order
primal-dual algorithms in convex optimization", ICCV.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.powered.convex.landing_plan import CONTROLS
from edl6dof.kernels import kernel

#: Square of the first root of cos x cosh x = 1.
CLAMPED = 4.730041**2
#: A multiplier that has died away: where the slope does not bind, it shrinks to seven tenths in each
#: iteration, and is handed on from plan to plan.  It would end among the subnormal numbers, in which a
#: processor calculates many times more slowly.
NOTHING = 1e-100
#: By how much the largest gain grows with rows of one length; largest over grids with a start of their own.
GROWN = 1.4


@kernel
def lay_rows(plan):
    """Write the factors that make the rows of the glide slope of one length, and their gain at most 1."""
    common = CLAMPED / (GROWN * plan.time * plan.time) * sqrt(plan.time / CONTROLS)
    at = 0.0
    for k in range(CONTROLS - 1):
        at += plan.step[k]
        share = at / plan.time
        sag = 4.0 * share * (1.0 - share)
        plan.row[k] = common / (sag * sqrt(sag))


@kernel
def add_push(landing, flat, plan):
    """Add the pull of the multipliers of the glide slope to the primer at each control."""
    if landing.slope < 0.0:
        return
    push, glide, row = plan.push, plan.glide, plan.row
    for axis in range(3):
        total = moment = first = second = 0.0
        end = 0.0
        for k in range(CONTROLS - 1, -1, -1):
            if k < CONTROLS - 1:
                total += row[k] * glide[k, axis]
                moment += row[k] * glide[k, axis] * end
            # a control moves what ends after it by step * (its own time to go less that of the place)
            push[k, axis] = total * plan.to_go[k] - moment
            first += plan.step[k] * flat * push[k, axis]
            second += plan.step[k] * plan.slant[k] * push[k, axis]
            end += plan.step[k]
        for k in range(CONTROLS):
            push[k, axis] -= flat * first + plan.slant[k] * second


@kernel
def follow_slope(landing, flat, first, second, sigma, extrapolation, plan):
    """Move the multipliers of the glide slope by where the extrapolated thrust 2 w - u flies; the square of
    how far, extrapolation left out.

    Args:
        landing: ``LANDING`` record.
        flat: first basis function of the end.
        first, second: what the end misses in the two basis functions.
        sigma: dual step.
        extrapolation: of the multipliers.
        plan: ``PLAN`` record.
    """
    changed = 0.0
    if landing.slope < 0.0:
        return changed
    slope = landing.slope
    u, w, glide, row = plan.u, plan.w, plan.glide, plan.row
    x, y, z = landing.position[0], landing.position[1], landing.position[2]
    vx, vy, vz = landing.velocity[0], landing.velocity[1], landing.velocity[2]
    for k in range(CONTROLS - 1):
        step, slant = plan.step[k], plan.slant[k]
        ax = 2.0 * w[k, 0] - u[k, 0] - flat * first[0] - slant * second[0]
        ay = 2.0 * w[k, 1] - u[k, 1] - flat * first[1] - slant * second[1]
        az = 2.0 * w[k, 2] - u[k, 2] - flat * first[2] - slant * second[2] - landing.gravity
        x, y, z = (
            x + step * (vx + 0.5 * step * ax),
            y + step * (vy + 0.5 * step * ay),
            z + step * (vz + 0.5 * step * az),
        )
        vx, vy, vz = vx + step * ax, vy + step * ay, vz + step * az
        point = (
            glide[k, 0] + sigma * row[k] * x,
            glide[k, 1] + sigma * row[k] * y,
            glide[k, 2] + sigma * row[k] * z,
        )
        px, py, pz = outside(point, slope)
        dx, dy, dz = px - glide[k, 0], py - glide[k, 1], pz - glide[k, 2]
        changed += dx * dx + dy * dy + dz * dz
        glide[k, 0] = alive(glide[k, 0] + extrapolation * dx)
        glide[k, 1] = alive(glide[k, 1] + extrapolation * dy)
        glide[k, 2] = alive(glide[k, 2] + extrapolation * dz)
    return changed


@kernel
def alive(multiplier):
    """A multiplier, and nothing in the place of one that has died away."""
    return multiplier if abs(multiplier) > NOTHING else 0.0


@kernel
def outside(point, slope):
    """From the nearest point of the cone z >= slope sqrt(x^2 + y^2) to ``point`` (x, y, z)."""
    x, y, z = point
    side = sqrt(x * x + y * y)
    if z >= slope * side:
        return 0.0, 0.0, 0.0
    along = max((side + slope * z) / (1.0 + slope * slope), 0.0)
    scale = along / side if side > 0.0 else 0.0
    return x - x * scale, y - y * scale, z - slope * along
