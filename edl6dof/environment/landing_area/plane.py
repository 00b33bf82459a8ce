"""Metres north and east of the landing site, in which the landing area is laid out.

North is the arc of the meridian and east that of the site's parallel, both at the height of the site, so a
metre is one on the ground: 1 km off the site, directions turn by less than 1e-3 and lengths change by less
than that share up to 70 deg of latitude.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.environment.planet import PlanetParams
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import cos, sin
from edl6dof.spatial.table_index import wrapped


@kernel
def place_of(terrain, lat, lon):
    """Metres north and east of the site, of geodetic ``lat`` and east ``lon``, rad."""
    turn = wrapped(lon - terrain.site_longitude + pi, 2.0 * pi) - pi
    return terrain.metres_north * (lat - terrain.site_latitude), terrain.metres_east * turn


@kernel
def geodetic_of(terrain, north, east):
    """Geodetic latitude and east longitude (rad) of a place in metres north and east of the site."""
    return (
        terrain.site_latitude + north / terrain.metres_north,
        terrain.site_longitude + east / terrain.metres_east,
    )


def metres_per_radian(planet: PlanetParams, latitude: float, altitude_m: float) -> tuple[float, float]:
    """Metres per radian of latitude and longitude at a geodetic latitude (rad) and altitude above the
    ellipsoid.
    """
    e2 = planet.flattening * (2.0 - planet.flattening)
    sine = sin(latitude)
    w = sqrt(1.0 - e2 * sine * sine)
    north = planet.equatorial_radius_m * (1.0 - e2) / (w * w * w) + altitude_m
    return north, (planet.equatorial_radius_m / w + altitude_m) * cos(latitude)
