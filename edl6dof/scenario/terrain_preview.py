"""Ground of a scenario for maps: heights at many places, the global map, and the planned landing ellipse."""

from __future__ import annotations

import numpy as np

from edl6dof.environment.areoid import areoid_file, areoid_map
from edl6dof.environment.landing_area.population import list_within
from edl6dof.environment.landing_area.relief import NO_RELIEF
from edl6dof.environment.planet import PlanetParams
from edl6dof.environment.terrain import (
    TERRAIN,
    TerrainParams,
    fill_terrain,
    geodetic_of,
    ground_arrays,
    ground_heights,
    ground_inputs,
    place_of,
)
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import cos, sin


class TerrainPreview:
    """The ground of a simulation."""

    def __init__(self, params: TerrainParams, planet: PlanetParams, seed: int, case: int) -> None:
        self._terrain = np.zeros(1, TERRAIN)
        self._grid = ground_arrays(ground_inputs(params, planet))
        self._areoid = areoid_map(areoid_file(planet))
        fill_terrain(self._terrain[0], params, self._grid, planet, seed, case)

    def heights(self, latitude: np.ndarray, longitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Elevation (m above the areoid) and altitude (m above the ellipsoid) of the ground at geodetic
        latitudes and east longitudes (rad), of any shape.
        """
        elevation, altitude = np.empty((2, latitude.size))
        ground_heights(
            self._terrain[0],
            grid=self._grid,
            areoid=self._areoid,
            lat=latitude.ravel(),
            lon=longitude.ravel(),
            elevation=elevation,
            altitude=altitude,
        )
        return elevation.reshape(latitude.shape), altitude.reshape(latitude.shape)

    @property
    def detailed(self) -> bool:
        """True if the ground has relief finer than the map."""
        return int(self._terrain["landing_area"]["model"][0]) != NO_RELIEF

    def rocks(self, latitude: float, longitude: float, side: float, smallest: float) -> np.ndarray:
        """Rocks of at least ``smallest`` (m) in a square of this ``side`` (m) about a place (rad): their
        latitudes and longitudes (rad) and diameters (m), shape (n, 3).
        """
        terrain = self._terrain[0]
        population = terrain["landing_area"]["rocks"]
        north, east = place_of(terrain, latitude, longitude)
        south, west = north - 0.5 * side, east - 0.5 * side
        found = np.empty((list_within(population, south, west, side, np.empty((0, 4))), 4))
        list_within(population, south, west, side, found)
        found = found[found[:, 2] >= smallest]
        places = [geodetic_of(terrain, *place) for place in found[:, :2]]
        return np.column_stack([np.array(places).reshape(-1, 2), found[:, 2]])

    @property
    def map(self) -> np.ndarray:
        """The global map (m), shape (180, 360), from 89.5 north and 179.5 west; zeros if there is no map."""
        return self._grid["map"]["height"].astype(float)


def planned_ellipse(length: float, width: float, azimuth: float) -> tuple[np.ndarray, np.ndarray]:
    """East and north (m), shape (361,), of an ellipse about the site, long axis along ``azimuth`` (rad)."""
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    along, across = 0.5 * length * arrays.cos(turn), 0.5 * width * arrays.sin(turn)
    return along * sin(azimuth) + across * cos(azimuth), along * cos(azimuth) - across * sin(azimuth)
