"""The areoid: the surface of one potential of gravity and rotation, from which heights of air and ground
count.

Its height N above the reference ellipsoid is a map, made from the gravity field by ``tools/areoid.py``.
Positions count from the ellipsoid: height above areoid = altitude - N.  A planet without a map has its
ellipsoid for an areoid.
Left out: the field beyond the degree of the map; beyond degree 12 it moves the areoid of Mars by tens of
metres (35 m rms by Kaula's rule with 1.3e-4 / n^2 [E]).
"""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np

from edl6dof.environment.height_map import (
    DATA,
    HEIGHT_MAP,
    MapFile,
    map_file,
    mapped_planet,
    read_map,
    require_map_of,
)
from edl6dof.environment.planet import PlanetParams
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import cos, sin
from edl6dof.spatial.frames import ned_to_fixed
from edl6dof.spatial.table_index import cell, held_cell, wrapped
from edl6dof.spatial.vector import dot, norm, put3

#: Largest difference (m) between a semi-axis of the ellipsoid of a map and that of the planet.
_SAME_ELLIPSOID = 10.0
_NONE = np.zeros(1, HEIGHT_MAP)[0]


def areoid_path(name: str) -> Path:
    """Path of a map by its name: a file of edl6dof/data/areoid, or an absolute path."""
    return DATA / "areoid" / f"{name.removesuffix('.npy')}.npy"


def areoid_file(planet: PlanetParams) -> MapFile | None:
    """Map file of the planet's areoid as it is on disk; ``None``: the areoid is the ellipsoid.

    Raises:
        OSError: there is no such map.
    """
    return map_file(areoid_path(planet.areoid)) if planet.areoid else None


def areoid_map(file: MapFile | None) -> np.void:
    """Height (m) of the areoid above the ellipsoid, ``HEIGHT_MAP``; zero everywhere without a file.

    Raises:
        OSError, ValueError: as :func:`edl6dof.environment.height_map.read_map`.
    """
    return _NONE if file is None else read_map(file)


def areoid_height(planet: PlanetParams, latitude: float, longitude: float) -> float:
    """Height (m) of the areoid above the ellipsoid at geodetic latitude and east longitude, rad."""
    return float(areoid_at(areoid_map(areoid_file(planet)), latitude, longitude)[0])


def require_areoid_of(planet: PlanetParams) -> None:
    """Check that the areoid map of a planet can be read, and belongs to this planet and its ellipsoid.

    Raises:
        OSError, ValueError: it cannot be read, or does not belong to them.
    """
    file = areoid_file(planet)
    if file is None:
        return
    require_map_of(file, planet.mean_radius_m, planet.areoid, "leave planet.areoid out")
    read_map(file)
    about = mapped_planet(file)
    axes, own = (
        (radius, radius * (1.0 - flattening))
        for radius, flattening in (
            (about.equatorial_radius_m, about.flattening),
            (planet.equatorial_radius_m, planet.flattening),
        )
    )
    if any(abs(a - b) > _SAME_ELLIPSOID for a, b in zip(axes, own, strict=True)):
        raise ValueError(
            f"{planet.areoid!r} counts from an ellipsoid with semi-axes of {axes[0]:.0f} and "
            f"{axes[1]:.0f} m, not of {own[0]:.0f} and {own[1]:.0f} m: make a map for it with tools/areoid.py"
        )


@kernel
def map_height(grid, lat, lon):
    """Height (m) and rise per metre towards north and east on a map, bilinear; angles in rad."""
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


@kernel
def areoid_at(grid, lat, lon):
    """Height (m) of the areoid above the ellipsoid and its rise per metre north and east; angles in rad."""
    if grid.radius > 0.0:
        return map_height(grid, lat, lon)
    return 0.0, 0.0, 0.0


@kernel
def lay_areoid(grid, place, lat, lon, r_F, plane):
    """Write the plane of the areoid's height at a place: ``height = plane[:3] . r_F + plane[3]`` (m).

    The plane follows the map around the place: within a cycle of the flight software, a vehicle at 6 km/s
    meets errors of millimetres at most.

    Args:
        grid: ``HEIGHT_MAP``; of radius 0 where the areoid is the ellipsoid.
        place: sine and cosine of geodetic latitude and of longitude.
        lat, lon: geodetic latitude and longitude, rad.
        r_F: the place, m.
        plane: written, shape (4,).

    Returns:
        The height (m) at the place, and its rise per metre of ground towards north and east.
    """
    height, north, east = areoid_at(grid, lat, lon)
    lower = grid.radius / norm(r_F)  # a metre at ``r_F`` is less on the ground
    slope = ned_to_fixed(place[0], place[1], place[2], place[3], (lower * north, lower * east, 0.0))
    put3(plane, 0, slope)
    plane[3] = height - dot(slope, r_F)
    return height, north, east
