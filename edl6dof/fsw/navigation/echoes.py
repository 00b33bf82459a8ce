"""What the beams of the radar say alone, whatever the attitude is taken to be: velocity in B, and the height
below a given vertical.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import add, cross, dot, inertia_solve, scale, take3

#: Least determinant of the beams' axes, and how far (m/s) a beam may be off the velocity of all.
_SPANS, _AGREE = 1e-3, 3.0


@kernel
def velocity_by_echoes(instruments, health, radar):
    """Velocity (m/s, B) of the antenna relative to the ground by least squares over the speeds of all beams
    with an echo, and whether they tell it: that takes four, which agree: of
    three nobody can tell that one is wrong.
    """
    xx = yy = zz = xy = xz = yz = 0.0
    seen, count = (0.0, 0.0, 0.0), 0
    if radar.fresh == 0:
        return seen, False
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_speed[i] != 0:
            x, y, z = take3(instruments.beam_axis[i], 0)
            xx, yy, zz = xx + x * x, yy + y * y, zz + z * z
            xy, xz, yz = xy + x * y, xz + x * z, yz + y * z
            seen, count = add(seen, scale(radar.speed[i], (x, y, z))), count + 1
    if count < 4 or dot((xx, xy, xz), cross((xy, yy, yz), (xz, yz, zz))) < _SPANS:
        return seen, False
    velocity = inertia_solve((xx, yy, zz, xy, xz, yz), seen)
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_speed[i] != 0:
            off = radar.speed[i] - dot(take3(instruments.beam_axis[i], 0), velocity)
            if abs(off) > _AGREE:
                return velocity, False
    return velocity, True


@kernel
def height_by_echoes(instruments, health, radar, down):
    """Mean height (m) of the antenna over where the beams meet the ground, ``down``: unit vector, B; 0 where
    none has an echo.
    """
    total, count = 0.0, 0
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and health.beam_range[i] != 0:
            total += radar.range[i] * dot(take3(instruments.beam_axis[i], 0), down)
            count += 1
    return total / count if count > 0 else 0.0
