"""Height and slope of the ground: a global map and a plane around the site, and on them the landing area.

Elevations count from the areoid (:mod:`edl6dof.environment.areoid`), as the heights of the air do.

Metres north and east of the site count along its meridian and along its parallel, both at the height of the
site, where lengths are true: 1 km off the site, directions turn by less than 1e-3 and lengths change by less
than that share up to 70 deg of latitude.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi, radians, sqrt
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from edl6dof.config.base import REQUIRED, Params, group, param
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.areoid import areoid_at, areoid_height, map_height
from edl6dof.environment.height_map import (
    DATA,
    HEIGHT_MAP,
    MapFile,
    map_file,
    read_map,
    require_map_of,
)
from edl6dof.environment.landing_area.dtm import DTM, DtmFile, Square, read_dtm, with_dtm
from edl6dof.environment.landing_area.fractal import TILES, fractal_tiles
from edl6dof.environment.landing_area.relief import (
    GENERATED,
    LANDING_AREA,
    LandingAreaParams,
    fill_landing_area,
    relief,
)
from edl6dof.environment.planet import PlanetParams
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import cos, sin, tan
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


MOLA, PLANE, NONE = range(3)
#: The map of model mola: heights above the areoid.
MAP = DATA / "topography" / "mola_1deg_colat_lon.npy"


class TerrainParams(Params):
    """True ground: a global map or none, and a plane around the landing site."""

    model: Literal["mola", "plane", "none"] = param(
        "mola", "mola: 1-degree map fitted to the site; plane: site only; none: 0 m"
    )
    site_elevation_m: float = param(
        REQUIRED,
        "height of the site above the areoid",
        ge=-9e3,
        le=22e3,
        usual=(-9000, 23000, "Hellas to Olympus Mons"),
    )
    site_latitude_deg: float = param(REQUIRED, "geodetic latitude", ge=-89.0, le=89.0)
    site_longitude_deg: float = param(REQUIRED, "east longitude", ge=-360.0, le=360.0)
    slope_deg: float = param(
        0.0,
        "tilt of the plane through the site",
        ge=0.0,
        le=45.0,
        usual=(0, 35, "loose ground does not lie steeper"),
    )
    slope_azimuth_deg: float = param(0.0, "downhill direction, from north through east", ge=-360.0, le=360.0)
    slope_radius_m: float = param(2000.0, "radius of the tilted plane around the site", gt=0.0, le=20e3)
    ellipse_length_m: float = param(
        0.0, "planned landing ellipse, for drawings: long axis; 0 for none", record=False, ge=0.0, le=1e6
    )
    ellipse_width_m: float = param(0.0, "planned landing ellipse: short axis", record=False, ge=0.0, le=1e6)
    ellipse_azimuth_deg: float = param(
        0.0, "planned landing ellipse: direction of the long axis", record=False, ge=-360.0, le=360.0
    )
    landing_area: LandingAreaParams = group(LandingAreaParams, "relief around the site")


#: The parameters; ``radius`` m: turns angles into metres; ``offset`` m: added to the map so that it agrees
#: with the site; ``tilt_*``: rise per metre; ``metres_*``: per radian at the site.
TERRAIN = extended(
    TerrainParams,
    **dict.fromkeys(("radius", "offset", "tilt_north", "tilt_east", "metres_north", "metres_east"), "f8"),
    landing_area=LANDING_AREA,
)
#: The arrays that the ground is read from, zero where a scenario has none; kernels call it ``grid``.
GROUND = record(("map", HEIGHT_MAP), ("dtm", DTM), ("tiles", TILES))


@kernel
def ground(terrain, grid, lat, lon):
    """Elevation (m above the areoid), and its rise per metre towards north and east; angles in rad."""
    elevation, north, east = regional(terrain, grid, lat, lon)
    if terrain.landing_area.model == GENERATED:
        y, x = place_of(terrain, lat, lon)
        height, rise_north, rise_east = relief(terrain.landing_area, grid.tiles, y, x)
        elevation += height
        north += rise_north
        east += rise_east
    return elevation, north, east


@kernel
def regional(terrain, grid, lat, lon):
    """As :func:`ground`, without the generated relief."""
    if grid.dtm.reach > 0.0:
        y, x = place_of(terrain, lat, lon)
        return with_dtm(grid.dtm, terrain.site_elevation, y, x, _mapped(terrain, grid, lat, lon))
    return _mapped(terrain, grid, lat, lon)


@kernel
def _mapped(terrain, grid, lat, lon):
    """As :func:`ground`, of the map and the plane alone."""
    if terrain.model == NONE:
        return 0.0, 0.0, 0.0
    elevation, north, east = _site_plane(terrain, lat, lon)
    if terrain.model == MOLA:
        height, map_north, map_east = map_height(grid.map, lat, lon)
        elevation += height + terrain.offset
        north += map_north
        east += map_east
    else:
        elevation += terrain.site_elevation
    return elevation, north, east


@kernel
def ground_heights(terrain, grid, areoid, lat, lon, elevation, altitude):
    """Write elevation and altitude (m) of the ground at several places (rad)."""
    for i in range(len(elevation)):
        elevation[i] = ground(terrain, grid, lat[i], lon[i])[0]
        altitude[i] = elevation[i] + areoid_at(areoid, lat[i], lon[i])[0]


@kernel
def _site_plane(terrain, lat, lon):
    """Tilt around the site; beyond ``slope_radius`` the height of the rim in that direction."""
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


class GroundInputs(NamedTuple):
    """Inputs of the arrays of the ground: map, terrain model, Hurst exponent of the generated relief."""

    map: MapFile | None = None
    dtm: DtmFile | None = None
    hurst: float | None = None


def ground_inputs(params: TerrainParams, planet: PlanetParams) -> GroundInputs:
    """Gather the inputs of the arrays of the ground.

    Raises:
        OSError: a file cannot be read.
    """
    area, dtm = params.landing_area, None
    if area.dtm.file:
        square = Square(*_site(params, planet), area.dtm.reach_m)
        dtm = DtmFile(map_file(Path(area.dtm.file)), area.dtm.coordinates, square)
    return GroundInputs(
        map_file(MAP) if params.model == "mola" else None,
        dtm,
        area.hurst if area.model == "generated" else None,
    )


def _site(params: TerrainParams, planet: PlanetParams) -> tuple[float, float, float, float]:
    """Latitude and longitude of the site (rad), and metres per radian of either there."""
    lat, lon = radians(params.site_latitude_deg), radians(params.site_longitude_deg)
    altitude = params.site_elevation_m + areoid_height(planet, lat, lon)
    e2 = planet.flattening * (2.0 - planet.flattening)
    sine = sin(lat)
    w = sqrt(1.0 - e2 * sine * sine)
    north = planet.equatorial_radius_m * (1.0 - e2) / (w * w * w) + altitude
    return lat, lon, north, (planet.equatorial_radius_m / w + altitude) * cos(lat)


@lru_cache(maxsize=4)
def ground_arrays(inputs: GroundInputs) -> np.void:
    """The arrays of the ground, ``GROUND``, shared and read-only.

    Raises:
        OSError, ValueError, ModuleNotFoundError: as :func:`edl6dof.environment.height_map.read_map` and
            :func:`edl6dof.environment.landing_area.dtm.read_dtm`.
    """
    record = np.zeros(1, GROUND)
    if inputs.map is not None:
        record["map"] = read_map(inputs.map)
    if inputs.dtm is not None:
        record["dtm"] = read_dtm(inputs.dtm)
    if inputs.hurst is not None:
        record["tiles"] = fractal_tiles(inputs.hurst)
    record.flags.writeable = False
    return record[0]


def require_topography_of(planet_radius_m: float) -> None:
    """Refuse the map of model mola for a planet of another mean radius.

    Raises:
        ValueError: the map is of another planet.
    """
    require_map_of(map_file(MAP), planet_radius_m, "mola", "use 'plane' or 'none'")


def fill_terrain(
    record: np.void, params: TerrainParams, grid: np.void, planet: PlanetParams, seed: int = 0, case: int = 0
) -> None:
    """Copy the parameters, fit the map to the site, resolve the tilt, and generate the landing area of
    (``seed``, ``case``).

    Raises:
        ValueError: the map is of another planet.
    """
    fill(record, params)
    lat, lon, record["metres_north"], record["metres_east"] = _site(params, planet)
    record["radius"] = planet.mean_radius_m
    record["offset"] = 0.0
    if params.model == "mola":
        require_topography_of(planet.mean_radius_m)
        record["offset"] = params.site_elevation_m - map_height(grid["map"], lat, lon)[0]
    steepness = -tan(radians(params.slope_deg))
    record["tilt_north"] = steepness * cos(radians(params.slope_azimuth_deg))
    record["tilt_east"] = steepness * sin(radians(params.slope_azimuth_deg))
    fill_landing_area(record["landing_area"], params.landing_area, grid["tiles"], seed, case)
