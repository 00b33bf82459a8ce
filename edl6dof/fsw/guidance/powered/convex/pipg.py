"""Proportional-integral projected gradient iteration for the landing of a given time.

Each iteration computes the nearest admissible thrust (a projection in closed form for each control) and the
end of the motion with it, and updates the multipliers: of the end, and of the glide slope (a projection onto
a cone where each control ends). Velocity and position are eliminated, as they are sums over the controls; the
six conditions that remain are preconditioned (:mod:`~edl6dof.fsw.guidance.powered.convex.landing_plan`). The
mass along the plan follows the iterates. Multipliers are bounded: a miss then has a price, above which it is
not avoided, and the result is the landing of least error (Blackmore, Acikmese, Scharf 2010) where the point
is out of reach.

Glide slope: where each control ends, the lander is inside a cone with its apex at the landing point. The
constraint is applied to the motion with a corrected end, which is the motion itself once the end is met: its
multipliers are then orthogonal to those of the end, and the largest gain from thrust to position is that of a
beam clamped at both ends, time^2 / 4.730^2. Near its ends such a beam hardly moves: at the share x of the
time the row of the constraint has a length proportional to (x (1 - x))^1.5, at the last controls a hundredth
of that in the middle. All rows are scaled to the length of the middle one, so that multipliers near the
landing point converge as fast as the others; the largest gain of all rows together grows by no more than 1.4,
as distant rows are nearly independent.

Sources: Yu, Elango, Acikmese 2021, "Proportional-integral projected gradient method for model predictive
control", IEEE Control Systems Letters 5(6); Yu, Elango, Topcu, Acikmese 2022, "Proportional-integral
projected gradient method for conic optimization", Automatica 142 (extrapolated); diagonal preconditioning:
Pock and Chambolle 2011, "Diagonal preconditioning for first order primal-dual algorithms in convex
optimization", ICCV.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.powered.convex.landing_plan import CONTROLS, fly_plan, full_controls, lay_grid
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import clamp, norm, put3, take3

#: Square of the first root of cos x cosh x = 1.
CLAMPED = 4.730041**2
#: Multipliers up to this size are set to zero: where the slope is inactive they shrink to seven tenths in
#: each iteration, from plan to plan, and would become subnormal numbers, with which a processor is many times
#: slower.
NOTHING = 1e-100
#: Growth of the largest gain by rows of equal length; the largest over grids with different starts at full
#: thrust.
GROWN = 1.4


@kernel
def lay_rows(plan):
    """Write the factors that scale the rows of the glide slope to equal length, so that none exceeds 1."""
    common = CLAMPED / (GROWN * plan.time * plan.time) * sqrt(plan.time / CONTROLS)
    at = 0.0
    for k in range(CONTROLS - 1):
        at += plan.step[k]
        share = at / plan.time
        sag = 4.0 * share * (1.0 - share)
        plan.row[k] = common / (sag * sqrt(sag))


@kernel
def add_push(landing, flat, plan):
    """Compute the contribution of the glide-slope multipliers to the primer at each control; ``flat``: first
    basis function of the end.
    """
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
    """Update the glide-slope multipliers by the motion under the extrapolated thrust 2 w - u; returns the
    square of their change before extrapolation.

    Args:
        landing, plan: ``LANDING`` and ``PLAN`` records.
        flat: first basis function of the end.
        first, second: miss of the end in the two basis functions.
        sigma: dual step.
        extrapolation: factor on the change of the multipliers.
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
    """Return a multiplier, or 0 for one of negligible size."""
    return multiplier if abs(multiplier) > NOTHING else 0.0


@kernel
def outside(point, slope):
    """Return the vector from the nearest point of the cone z >= slope sqrt(x^2 + y^2) to ``point``
    (x, y, z).
    """
    x, y, z = point
    side = sqrt(x * x + y * y)
    if z >= slope * side:
        return 0.0, 0.0, 0.0
    along = max((side + slope * z) / (1.0 + slope * slope), 0.0)
    scale = along / side if side > 0.0 else 0.0
    return x - x * scale, y - y * scale, z - slope * along


@kernel
def nearest_thrust(start, price, low, high, cos_tilt):
    """Return the thrust acceleration (m/s2) that is least in its price plus half the squared distance from
    ``start``: the proximal operator of

        price max(|u|, low)  over  |u| <= high,  u_up >= cos(tilt) max(|u|, low),

    which is the fuel under the bound s >= |u|, low <= s <= high once the least s is taken.

    Args:
        start: east, north, up, m/s2.
        price: cost of a unit of thrust acceleration, not negative.
        low, high: bounds of the thrust acceleration, m/s2; equal at full thrust.
        cos_tilt: cosine of the largest angle of thrust from the vertical.
    """
    x, y, z = start
    size = norm(start)
    if size > low:
        wanted = min(max(size - price, low), high)
    else:
        wanted = size
    scale = wanted / size if size > 0.0 else 0.0
    if z * scale >= cos_tilt * max(wanted, low):
        return x * scale, y * scale, z * scale
    # at the tilt limit: on the cone, or on its flat lower end
    sin_tilt = sqrt(1.0 - cos_tilt * cos_tilt)
    side = sqrt(x * x + y * y)
    along = side * sin_tilt + z * cos_tilt - price
    if along > low:
        wanted = min(along, high)
        shift = wanted * sin_tilt
    else:
        wanted = low
        shift = min(side, low * sin_tilt)
    scale = shift / side if side > 0.0 else 0.0
    return x * scale, y * scale, wanted * cos_tilt


#: Primal step over the largest thrust acceleration, and extrapolation of each iteration.
STEP, EXTRAPOLATION = 0.1, 1.7
#: Iterations from one update of the mass and test of convergence to the next.
BATCH = 10
#: Largest primer; that of a landing that can be flown is of the order of 1.
LARGEST_PRIMER = 20.0
#: Converged when the change of the multipliers corresponds to less than this thrust acceleration (m/s2), and
#: the primer changes by less than this.
THRUST_TOLERANCE, PRIMER_TOLERANCE = 1e-4, 5e-4


@kernel
def weigh(landing, plan):
    """Compute the mass in the middle of each control under the thrust ``w``; returns the velocity spent
    (m/s).
    """
    mass, spent, count = landing.mass, 0.0, full_controls(plan)
    for k in range(CONTROLS):
        size = sqrt(plan.w[k, 0] ** 2 + plan.w[k, 1] ** 2 + plan.w[k, 2] ** 2)
        if k < count:
            size = landing.full / plan.mass[k] if plan.mass[k] > 0.0 else landing.full / mass
        gain = max(size, landing.low / mass) * plan.step[k]
        plan.mass[k] = mass * exp(-0.5 * gain / landing.exhaust_speed)
        mass *= exp(-gain / landing.exhaust_speed)
        spent += gain
    plan.fuel = landing.mass - mass
    return spent


@kernel
def solve(landing, most, plan):
    """Find the least fuel for the times of flight and at full thrust in ``plan`` (``PLAN``), in at most
    ``most`` iterations; its ``u`` and multipliers are the first guess and then the solution.
    """
    mean, norm = lay_grid(plan)
    lay_rows(plan)
    time, u, w = plan.time, plan.u, plan.w
    flat = 1.0 / sqrt(time)
    tau = STEP * landing.high / landing.mass
    sigma = 1.0 / tau
    count = full_controls(plan)
    for k in range(CONTROLS):
        w[k, 0], w[k, 1], w[k, 2] = u[k, 0], u[k, 1], u[k, 2]
    plan.mass[:] = 0.0
    weigh(landing, plan)

    # required values of the sums, and their multipliers
    gx, gy, gz = take3(landing.velocity, 0)
    rx, ry, rz = take3(landing.position, 0)
    gz -= landing.gravity * time
    rz += 0.5 * landing.gravity * time * time  # position without thrust: r + (v - g t) t + g t^2 / 2
    ax, ay, az = -gx * flat, -gy * flat, -gz * flat
    bx = (-(rx + gx * time) + mean * gx) / norm
    by = (-(ry + gy * time) + mean * gy) / norm
    bz = (-(rz + gz * time) + mean * gz) / norm
    px, py, pz = take3(plan.primer_end, 0)
    qx, qy, qz = take3(plan.pull, 0)
    px, py, pz = (px + mean * qx) / flat, (py + mean * qy) / flat, (pz + mean * qz) / flat
    qx, qy, qz = qx * norm, qy * norm, qz * norm
    bound, sideways = LARGEST_PRIMER / flat, landing.miss_price * norm

    plan.converged = 0
    plan.iterations = 0
    while plan.iterations < most and plan.converged == 0:
        plan.iterations += 1
        add_push(landing, flat, plan)
        ex, ey, ez, fx, fy, fz = -ax, -ay, -az, -bx, -by, -bz
        moved = 0.0
        for k in range(CONTROLS):
            slant, step = plan.slant[k], plan.step[k]
            low, high = landing.low, landing.high
            if k < count:
                low = high = landing.full
            elif time - plan.to_go[k] < landing.now:
                low, high = landing.low_now, landing.high_now
            cos_tilt = landing.cos_last_tilt if k == CONTROLS - 1 else landing.cos_tilt
            start = (
                u[k, 0] - tau * (flat * px + slant * qx + plan.push[k, 0]),
                u[k, 1] - tau * (flat * py + slant * qy + plan.push[k, 1]),
                u[k, 2] - tau * (flat * pz + slant * qz + plan.push[k, 2]),
            )
            x, y, z = nearest_thrust(start, tau, low / plan.mass[k], high / plan.mass[k], cos_tilt)
            dx, dy, dz = x - u[k, 0], y - u[k, 1], z - u[k, 2]
            w[k, 0], w[k, 1], w[k, 2] = x, y, z
            moved += step * (dx * dx + dy * dy + dz * dz)
            x, y, z = x + dx, y + dy, z + dz
            ex, ey, ez = ex + step * flat * x, ey + step * flat * y, ez + step * flat * z
            fx, fy, fz = fx + step * slant * x, fy + step * slant * y, fz + step * slant * z
        changed = follow_slope(
            landing,
            flat,
            first=(ex, ey, ez),
            second=(fx, fy, fz),
            sigma=sigma,
            extrapolation=EXTRAPOLATION,
            plan=plan,
        )
        for k in range(CONTROLS):
            for axis in range(3):
                u[k, axis] += EXTRAPOLATION * (w[k, axis] - u[k, axis])
        # the end
        ex = clamp(px + sigma * ex, -bound, bound) - px
        ey = clamp(py + sigma * ey, -bound, bound) - py
        ez = clamp(pz + sigma * ez, -bound, bound) - pz
        fx, fy, fz = qx + sigma * fx, qy + sigma * fy, clamp(qz + sigma * fz, -bound, bound) - qz
        less = min(sideways / max(sqrt(fx * fx + fy * fy), 1e-12), 1.0)
        fx, fy = less * fx - qx, less * fy - qy
        px, py, pz = px + EXTRAPOLATION * ex, py + EXTRAPOLATION * ey, pz + EXTRAPOLATION * ez
        qx, qy, qz = qx + EXTRAPOLATION * fx, qy + EXTRAPOLATION * fy, qz + EXTRAPOLATION * fz
        if plan.iterations % BATCH == 0:
            weigh(landing, plan)
            plan.change = flat * sqrt(moved) * sigma
            off = flat * tau * sqrt(ex * ex + ey * ey + ez * ez + fx * fx + fy * fy + fz * fz + changed)
            if off < THRUST_TOLERANCE and plan.change < PRIMER_TOLERANCE:
                plan.converged = 1
    qx, qy, qz = qx / norm, qy / norm, qz / norm
    put3(plan.pull, 0, (qx, qy, qz))
    put3(plan.primer_end, 0, (flat * px - mean * qx, flat * py - mean * qy, flat * pz - mean * qz))
    evaluate(landing, plan)


@kernel
def evaluate(landing, plan):
    """Compute fuel, cost, and errors at the end of a plan with the thrust ``w``."""
    spent = weigh(landing, plan)
    (x, y, z), (vx, vy, vz) = fly_plan(landing, plan, plan.time)
    plan.miss = sqrt(x * x + y * y)
    plan.height_error = abs(z)
    put3(plan.end_velocity, 0, (vx, vy, vz))
    plan.cost = spent + landing.miss_price * plan.miss
    # as the bounds of the multipliers price it
    plan.cost += LARGEST_PRIMER * (abs(vx) + abs(vy) + abs(vz))
    plan.cost += LARGEST_PRIMER * sqrt(12.0) / plan.time * abs(z - 0.5 * plan.time * vz)
