"""The spot to land on, chosen on the map of the ground while the lander descends from 100 m."""

from __future__ import annotations

import numpy as np

from edl6dof.gym.task import Feature, StepResult, Task, nav
from edl6dof.interface.roles import HAZARD_AVOIDANCE

#: Cells of the observed map along each side; clearance of one that is safe beyond doubt, m.
_CELLS, _CLEAR_M = 32, 5.0


def clearances(memories: np.ndarray) -> np.ndarray:
    """Largest distance (m) from a hazard in each part of the map, shape (flights, 32 x 32), north by east."""
    fine = memories["hazard"]["safety_map"]["clearance"]
    part = fine.shape[1] // _CELLS
    parts = fine.reshape(len(memories), _CELLS, part, _CELLS, part)
    return parts.max(axis=(2, 4)).reshape(len(memories), -1)


def on_map(memories: np.ndarray, place_L: np.ndarray) -> np.ndarray:
    """Places (east, north) relative to the middle of the map, 1 at its edges, shape (flights, 2)."""
    corner, half = _map(memories)
    return (place_L - corner) / half - 1.0


def _map(memories: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corner and half of the width of the maps, m."""
    elevation_map = memories["hazard"]["elevation_map"]
    cells = memories["hazard"]["safety_map"]["clearance"].shape[1]
    return elevation_map["corner_L"], 0.5 * cells * elevation_map["cell"][:, None]


class HazardDivert(Task):
    """Action: spot east and north of the middle of the map, 1 at its edges.  Reward: at the end 1 for a
    landing within limits, of the ground too, and -1 for any other.
    """

    title = "spot to land on, among rocks and craters"
    size = 2
    scenario = "tianwen1_hazards"
    role = HAZARD_AVOIDANCE
    interval_s, longest_s = 1.0, 180.0
    features = (
        Feature("clearance", _CLEAR_M, clearances, _CELLS * _CELLS),
        Feature(
            "place on the map", 1.0, lambda memories: on_map(memories, memories["nav"]["site_L"][:, :2]), 2
        ),
        Feature("height", 100.0, nav("height")),
        Feature("v_N", 3.0, nav("v_N"), 3),
    )

    def command(self, actions: np.ndarray) -> None:
        """Command the spot."""
        corner, half = _map(self.fleet.memories)
        external = self.fleet.memories["external"]
        external["given"]["safe_spot"] = 1
        external["fine_L"] = corner + half * (actions.astype(float) + 1.0)

    def baseline(self) -> np.ndarray:
        """The spot that hazard detection has chosen."""
        memories = self.fleet.memories
        return np.clip(on_map(memories, memories["hazard"]["choice"]["spot_L"]), -1.0, 1.0).astype(np.float32)

    def result(self) -> StepResult:
        """Over when the flight ends."""
        over = self.ended()
        success = self.fleet.landed_well(self.loaded.scenario.limits)
        return StepResult(np.where(over, np.where(success, 1.0, -1.0), 0.0), over, success)
