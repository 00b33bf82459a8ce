"""Height and slope of the ground.

Elevations count from the areoid (:mod:`edl6dof.environment.areoid`), as the heights of the air do.
Left out: relief below one degree; around the site a plane stands for it.
"""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan
from typing import Literal

import numpy as np

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.dtype import fill
from edl6dof.environment.areoid import areoid_at
from edl6dof.environment.height_map import map_height
from edl6dof.environment.layout import extended
from edl6dof.environment.map_file import DATA, map_file, read_map, require_map_of
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import wrapped

MOLA, PLANE, NONE = range(3)
#: The map of model mola: heights above the areoid.
MAP = DATA / "topography" / "mola_1deg_colat_lon.npy"


class TerrainParams(Params):
    """Ground of the truth: a global map or nothing, and a plane around the landing site."""

    model: Literal["mola", "plane", "none"] = param(
        "mola", "mola: 1-degree map fitted to the site; plane: site only; none: 0 m"
    )
    site_elevation_m: float = param(REQUIRED, "height of the site above the areoid", ge=-9e3, le=22e3)
    site_latitude_deg: float = param(REQUIRED, "geodetic latitude", ge=-89.0, le=89.0)
    site_longitude_deg: float = param(REQUIRED, "east longitude", ge=-360.0, le=360.0)
    slope_deg: float = param(0.0, "tilt of the plane through the site", ge=0.0, le=45.0)
    slope_azimuth_deg: float = param(0.0, "downhill direction, from north through east", ge=-360.0, le=360.0)
    slope_radius_m: float = param(
        2000.0, "distance from the site up to which the ground keeps tilting", gt=0.0, le=20e3
    )
    ellipse_length_m: float = param(
        0.0, "planned landing ellipse, for drawings: long axis; 0 for none", record=False, ge=0.0, le=1e6
    )
    ellipse_width_m: float = param(0.0, "planned landing ellipse: short axis", record=False, ge=0.0, le=1e6)
    ellipse_azimuth_deg: float = param(
        0.0, "planned landing ellipse: direction of the long axis", record=False, ge=-360.0, le=360.0
    )


#: The parameters; ``radius`` m: turns angles into metres; ``offset`` m: added to the map so that it agrees
#: with the site; ``tilt_*``: rise per metre.
TERRAIN = extended(TerrainParams, radius="f8", offset="f8", tilt_north="f8", tilt_east="f8")


@kernel
def ground(terrain, grid, lat, lon):
    """Elevation (m above the areoid), and its rise per metre towards north and east, at geodetic ``lat`` and
    east ``lon``, rad.
    """
    if terrain.model == NONE:
        return 0.0, 0.0, 0.0
    elevation, north, east = _site_plane(terrain, lat, lon)
    if terrain.model == MOLA:
        height, map_north, map_east = map_height(grid, lat, lon)
        elevation += height + terrain.offset
        north += map_north
        east += map_east
    else:
        elevation += terrain.site_elevation
    return elevation, north, east


@kernel
def ground_heights(terrain, grid, areoid, lat, lon, elevation, altitude):
    """Elevation (m) of the ground at each of some places (rad), and its altitude with the map of the areoid's
    height, into the last two.
    """
    for i in range(len(elevation)):
        elevation[i] = ground(terrain, grid, lat[i], lon[i])[0]
        altitude[i] = elevation[i] + areoid_at(areoid, lat[i], lon[i])[0]


@kernel
def _site_plane(terrain, lat, lon):
    """The tilt around the site; beyond ``slope_radius`` the height stays what it is on the rim in that
    direction.
    """
    tilt_north = terrain.tilt_north
    tilt_east = terrain.tilt_east
    if tilt_north == 0.0 and tilt_east == 0.0:
        return 0.0, 0.0, 0.0
    turn = wrapped(lon - terrain.site_longitude + pi, 2.0 * pi) - pi
    north = terrain.radius * (lat - terrain.site_latitude)
    east = terrain.radius * cos(terrain.site_latitude) * turn
    rise = tilt_north * north + tilt_east * east
    distance = sqrt(north * north + east * east)
    if distance <= terrain.slope_radius:
        return rise, tilt_north, tilt_east
    k = terrain.slope_radius / distance
    bend = rise / (distance * distance)
    return k * rise, k * (tilt_north - bend * north), k * (tilt_east - bend * east)


def topography() -> np.void:
    """The map of model mola, ``HEIGHT_MAP``."""
    return read_map(map_file(MAP))


def require_topography_of(planet_radius_m: float) -> None:
    """Refuse the map of model mola for a planet of another mean radius.

    Raises:
        ValueError: it is of another planet.
    """
    require_map_of(map_file(MAP), planet_radius_m, "mola", "use 'plane' or 'none'")


def fill_terrain(record: np.void, params: TerrainParams, grid: np.void, planet_radius_m: float) -> None:
    """Copy the parameters, fit the map to the site and resolve the tilt, on a planet of this mean radius.

    Raises:
        ValueError: the map is of another planet.
    """
    fill(record, params)
    record["radius"] = planet_radius_m
    record["offset"] = 0.0
    if params.model == "mola":
        require_topography_of(planet_radius_m)
        at_site = map_height(grid, radians(params.site_latitude_deg), radians(params.site_longitude_deg))[0]
        record["offset"] = params.site_elevation_m - at_site
    steepness = -tan(radians(params.slope_deg))
    record["tilt_north"] = steepness * cos(radians(params.slope_azimuth_deg))
    record["tilt_east"] = steepness * sin(radians(params.slope_azimuth_deg))
