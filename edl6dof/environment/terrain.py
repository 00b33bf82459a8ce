"""Height and slope of the ground.

Heights count from the areoid, which this product takes equal to the reference ellipsoid: altitude, atmosphere
and ground share one zero.  (The true areoid departs from the ellipsoid by up to about 2 km; with one zero the
height of air and ground above each other is right, and that is what a descent feels.)
Left out: relief below one degree; around the site a plane stands for it.
"""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan
from typing import Literal

import numpy as np

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.dtype import fill
from edl6dof.environment.layout import extended
from edl6dof.environment.terrain_map import read_map, require_map_of
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import cell, held_cell, wrapped

MOLA, PLANE, NONE = range(3)


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

#: Shared map: metres above the areoid, rows of planetocentric latitude 89.5 to -89.5, columns of longitude
#: -179.5 to 179.5 deg; ``radius`` m: mean radius of its planet; ``centric``: geocentric = geodetic - this *
#: sin(2 geodetic), to 2e-5 rad.
TERRAIN_GRID = np.dtype([("height", "f4", (180, 360)), ("radius", "f8"), ("centric", "f8")], align=True)


@kernel
def ground(terrain, grid, lat, lon):
    """Elevation (m) and rise per metre towards north and east at geodetic ``lat`` and east ``lon``, rad."""
    if terrain.model == NONE:
        return 0.0, 0.0, 0.0
    elevation, north, east = _site_plane(terrain, lat, lon)
    if terrain.model == MOLA:
        height, map_north, map_east = mola(grid, lat, lon)
        elevation += height + terrain.offset
        north += map_north
        east += map_east
    else:
        elevation += terrain.site_elevation
    return elevation, north, east


@kernel
def elevations(terrain, grid, lat, lon, found):
    """Elevation (m) at each of some places (rad), into ``found``."""
    for i in range(len(found)):
        found[i] = ground(terrain, grid, lat[i], lon[i])[0]


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


@kernel
def mola(grid, lat, lon):
    """Map height (m) and rise per metre towards north and east: bilinear, so heights are continuous and
    slopes are not.
    """
    centric = lat - grid.centric * sin(2.0 * lat)
    row, u = held_cell(89.5 - centric * (180.0 / pi), 179)
    column, t = cell(wrapped(lon * (180.0 / pi) + 179.5, 360.0), 360)
    right = (column + 1) % 360
    nw = float(grid.height[row, column])
    ne = float(grid.height[row, right])
    sw = float(grid.height[row + 1, column])
    se = float(grid.height[row + 1, right])
    top = nw + t * (ne - nw)
    bottom = sw + t * (se - sw)
    per_degree = 180.0 / (pi * grid.radius)
    east = ((ne - nw) * (1.0 - u) + (se - sw) * u) * per_degree / max(cos(lat), 0.01)
    return top + u * (bottom - top), (top - bottom) * per_degree, east


def fill_terrain_grid(record: np.void) -> None:
    """Load the MOLA map that all cases share (dtype ``TERRAIN_GRID``)."""
    record["height"], record["radius"], flattening = read_map()
    record["centric"] = flattening + 0.5 * flattening**2


def fill_terrain(record: np.void, params: TerrainParams, grid: np.void, planet_radius_m: float) -> None:
    """Copy the parameters, fit the map to the site and resolve the tilt, on a planet of this mean radius.

    Raises:
        ValueError: the map is of another planet.
    """
    fill(record, params)
    record["radius"] = planet_radius_m
    record["offset"] = 0.0
    if params.model == "mola":
        require_map_of(planet_radius_m)
        at_site = mola(grid, radians(params.site_latitude_deg), radians(params.site_longitude_deg))[0]
        record["offset"] = params.site_elevation_m - at_site
    steepness = -tan(radians(params.slope_deg))
    record["tilt_north"] = steepness * cos(radians(params.slope_azimuth_deg))
    record["tilt_east"] = steepness * sin(radians(params.slope_azimuth_deg))
