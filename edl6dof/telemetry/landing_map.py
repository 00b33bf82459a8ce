"""The map of the ground that a lander made, and the choice on it: for reports and pictures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.fsw.hazard.elevation_map import CELL_CLASSES
from edl6dof.spatial import arrays


class LandingMap(NamedTuple):
    """The map of hazard detection and the choice made on it.

    Places are metres east and north of the landing site in navigated coordinates, which contain the
    navigation error at that time (channels ``nav.error_...``).  Rows run north, columns east; a cell that
    was not seen has ``nan``.
    """

    cell_m: np.ndarray  # side of a cell
    corner_m: np.ndarray  # south-west corner of the map, east and north, shape (2,)
    elevation_m: np.ndarray  # navigated mean elevation above the ground below the hover, shape (n, n)
    slope_deg: np.ndarray  # slope of the footprint around each cell; nan if not all of the footprint is known
    roughness_m: np.ndarray  # largest distance of a cell from the plane of the footprint, nan as the slope
    cell_class: np.ndarray  # index in CELL_CLASSES: safe, edge (not all known), slope, rock
    probability: np.ndarray  # that slope and roughness are within limits; an upper bound where they are not
    clearance_m: np.ndarray  # distance from the nearest cell that is not safe
    hover_m: np.ndarray  # where the scan began: east, north, and height above the map's level, shape (3,)
    spot_m: np.ndarray  # spot that was chosen, east and north, shape (2,)
    found: np.ndarray  # true if the chosen spot is safe, shape ()
    rejected_m: np.ndarray  # spots that the search passed over, shape (k, 2)
    rejected_class: np.ndarray  # class of the cell for which each was passed over, shape (k,)
    drift_m: np.ndarray  # predicted path of backshell and canopy: east, north, height (m), shape (p, 3)
    coarse_m: np.ndarray  # target of each part of the landing image, shape (parts, 2)
    coarse_obstacles: np.ndarray  # share of obstacles in each part, shape (parts,)
    coarse_part: np.ndarray  # index of the part that was taken, shape (); -1: none

    def reasons(self) -> list[str]:
        """Reason why each rejected spot was passed over: ``edge``, ``slope`` or ``rock``."""
        return [CELL_CLASSES[int(cell_class)] for cell_class in self.rejected_class]


def landing_map(fsw: np.void) -> LandingMap | None:
    """The map in the memory of a flight computer; ``None`` where no spot was chosen from a scan."""
    hazard, point = fsw["hazard"], fsw["landing_point"]
    if not np.isfinite(hazard["spot_t"]):
        return None
    elevation_map, footprint, safety_map = hazard["elevation_map"], hazard["footprint"], hazard["safety_map"]
    choice, coarse = hazard["choice"], hazard["coarse"]
    drift = coarse["drift"][-1]
    known = safety_map["cell_class"] != CELL_CLASSES.index("edge")
    rejected = choice["rejected"][: choice["n_rejected"]]
    return LandingMap(
        cell_m=np.array(elevation_map["cell"]),
        corner_m=elevation_map["corner_L"].copy(),
        elevation_m=np.where(elevation_map["weight"] > 0.0, elevation_map["mean"], np.float32(np.nan)),
        slope_deg=np.where(known, np.degrees(arrays.atan(footprint["slope"])), np.float32(np.nan)),
        roughness_m=np.where(known, footprint["roughness"], np.float32(np.nan)),
        cell_class=safety_map["cell_class"].astype(np.int8),
        probability=safety_map["probability"].copy(),
        clearance_m=safety_map["clearance"].copy(),
        hover_m=hazard["here_L"] - (0.0, 0.0, elevation_map["level"]),
        spot_m=point["fine_L"].copy(),
        found=np.array(int(choice["found"])),
        rejected_m=rejected["spot_L"].copy(),
        rejected_class=rejected["cell_class"].astype(np.int64),
        drift_m=drift["place_L"][: drift["count"]].copy(),
        coarse_m=coarse["target_L"][: coarse["parts"]].copy(),
        coarse_obstacles=coarse["obstacles"][: coarse["parts"]].copy(),
        coarse_part=np.array(int(coarse["part"]) if np.isfinite(hazard["image_t"]) else -1),
    )
