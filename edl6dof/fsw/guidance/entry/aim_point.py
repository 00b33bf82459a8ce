"""Geometry of the aim point of entry guidance: range, downrange to go, crossrange, and heading alignment.

Heading alignment: near the end range control stops, and the bank angle removes the heading error. Source:
Mendeck & Craig McGrew 2014, "Entry guidance design and postflight performance for 2011 Mars Science
Laboratory mission".
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import asin, atan2, sincos
from edl6dof.spatial.frames import great_circle
from edl6dof.spatial.vector import clamp


@kernel
def to_target(onboard, nav):
    """Great-circle range to the aim point, signed crossrange and downrange to go (m on the reference sphere).

    Crossrange is positive when the velocity points to the right of the aim point.  Downrange to go is
    measured along the course until the aim point lies abeam; negative beyond it.
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
    """Side of the first bank (+1 right, -1 left): that of the commanded bank; at zero bank, towards the aim
    point.
    """
    away = out.crossrange if out.bank == 0.0 else -out.bank
    return -1.0 if away > 0.0 else 1.0


class HeadingAlignmentParams(Params):
    """Heading alignment: below a speed, bank against the heading error instead of controlling range."""

    speed_m_s: float = param(
        0.0, "speed below which heading alignment replaces range control; 0: never", ge=0.0
    )
    gain: float = param(20.0, "bank angle per heading error", ge=0.0, le=1000.0)
    limit_deg: float = param(30.0, "largest bank angle of heading alignment", ge=0.0, le=90.0)


@kernel
def heading_bank(p, range_to_go, crossrange):
    """Return the bank angle (rad) that reduces the heading error towards the aim point; range and crossrange
    in m.
    """
    return clamp(-p.gain * atan2(crossrange, max(range_to_go, 1.0)), -p.limit, p.limit)
