"""Where the lander is along a plan."""

from __future__ import annotations

from edl6dof.fsw.guidance.powered.convex.problem import CONTROLS
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import take3


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
