"""Range and crossrange to the aim point, shared by the entry laws."""

from __future__ import annotations

from math import asin, cos, sin

from edl6dof.jit import kernel
from edl6dof.spatial.frames import great_circle
from edl6dof.spatial.vector import clamp


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
