"""Range, crossrange and bank reversal, shared by the entry laws."""

from __future__ import annotations

from math import asin, cos, sin

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel
from edl6dof.spatial.frames import great_circle
from edl6dof.spatial.vector import clamp


class CorridorParams(Params):
    """Bank-reversal corridor: crossrange allowed as a quadratic in velocity, c0 + c1 V + c2 V^2."""

    c0_m: float = param(400.0, "half width at zero velocity", ge=0.0, le=1e6)
    c1_s: float = param(0.6, "growth with velocity", ge=0.0, le=1000.0)
    c2_s2_m: float = param(1.2e-4, "growth with the square of velocity", ge=0.0, le=1.0)


REVERSAL = np.dtype([("sign", "f8"), ("count", "i8")], align=True)


@kernel
def to_target(onboard, nav):
    """Great-circle range to the aim point (m on the reference sphere) and signed crossrange (m).

    Crossrange is positive when the velocity points to the right of the aim point.
    """
    site, planet = onboard.site, onboard.planet
    arc, bearing = great_circle(
        sin(nav.latitude),
        cos(nav.latitude),
        nav.longitude,
        sin(site.aim_latitude),
        cos(site.aim_latitude),
        site.aim_longitude,
    )
    crossrange = asin(clamp(sin(arc) * sin(nav.azimuth - bearing), -1.0, 1.0))
    return arc * planet.equatorial_radius, crossrange * planet.equatorial_radius


@kernel
def bank_sign(corridor, memory, crossrange, speed):
    """Sign of the bank angle (+1 turns right): reversed when the crossrange leaves the corridor on the side being turned to."""
    limit = corridor.c0 + corridor.c1 * speed + corridor.c2 * speed * speed
    if memory.sign == 0.0:
        memory.sign = -1.0 if crossrange > 0.0 else 1.0
    elif memory.sign * crossrange > limit:
        memory.sign = -memory.sign
        memory.count += 1
    return memory.sign
