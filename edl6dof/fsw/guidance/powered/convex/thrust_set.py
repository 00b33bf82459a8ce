"""The nearest thrust acceleration that the engine can give, and the price of thrust: the proximal operator of

    price max(|u|, low)  over  |u| <= high,  u_up >= cos(tilt) max(|u|, low),

which is what is left of fuel and of the bound s >= |u|, low <= s <= high once the least s is taken.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.jit import kernel
from edl6dof.spatial.vector import norm


@kernel
def nearest_thrust(start, price, low, high, cos_tilt):
    """Thrust acceleration (m/s2) that is least in its price plus half the squared distance from ``start``.

    Args:
        start: east, north, up, m/s2.
        price: of a unit of thrust acceleration, not negative.
        low, high: bounds of the thrust acceleration; equal where it is given.
        cos_tilt: of the largest angle of thrust from the vertical.
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
