"""The ground of a scenario for those who only look at it: heights at many places, and the map."""

from __future__ import annotations

import numpy as np

from edl6dof.environment.terrain import (
    TERRAIN,
    TERRAIN_GRID,
    TerrainParams,
    elevations,
    fill_terrain,
    fill_terrain_grid,
)


class Relief:
    """Elevation of the ground as the simulation has it."""

    def __init__(self, params: TerrainParams, planet_radius_m: float) -> None:
        self._terrain, self._grid = np.zeros(1, TERRAIN), np.zeros(1, TERRAIN_GRID)
        if params.model == "mola":
            fill_terrain_grid(self._grid[0])
        fill_terrain(self._terrain[0], params, self._grid[0], planet_radius_m)

    def elevation(self, latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
        """Elevation (m) at geodetic latitudes and east longitudes (rad), of any shape."""
        found = np.empty(latitude.size)
        elevations(self._terrain[0], self._grid[0], latitude.ravel(), longitude.ravel(), found)
        return found.reshape(latitude.shape)

    @property
    def map(self) -> np.ndarray:
        """The global map (m), shape (180, 360): from 89.5 north to 89.5 south, from 179.5 west; zeros where
        there is none.
        """
        return self._grid[0]["height"].astype(float)
