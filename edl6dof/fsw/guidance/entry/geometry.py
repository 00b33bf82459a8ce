"""Range to the aim point, how much of it lies along the course, and crossrange; shared by the entry laws."""

from __future__ import annotations

from edl6dof.jit import kernel
from edl6dof.spatial.elementary import asin, atan2, sincos
from edl6dof.spatial.frames import great_circle
from edl6dof.spatial.vector import clamp


@kernel
def to_target(onboard, nav):
    """Great-circle range to the aim point, signed crossrange and downrange to go (m on the reference sphere).

    Crossrange is positive when the velocity points to the right of the aim point.  Downrange to go is what is
    left along the course until the aim point lies abeam; negative beyond it.
    """
    site, planet = onboard.site, onboard.planet
    arc, bearing = great_circle((nav.latitude, nav.longitude), (site.aim_latitude, site.aim_longitude))
    (sin_arc, cos_arc), (sin_off, cos_off) = sincos(arc), sincos(nav.azimuth - bearing)
    crossrange = asin(clamp(sin_arc * sin_off, -1.0, 1.0))
    ahead = atan2(sin_arc * cos_off, cos_arc)
    radius = planet.equatorial_radius
    return arc * radius, crossrange * radius, ahead * radius


@kernel
def first_side(out):
    """Side to bank to at first (+1 right, -1 left): the one that the commanded bank angle is on already, else
    towards the aim point.
    """
    away = out.crossrange if out.bank == 0.0 else -out.bank
    return -1.0 if away > 0.0 else 1.0
