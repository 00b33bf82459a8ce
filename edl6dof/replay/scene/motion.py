"""Where everything is during the replay: telemetry turned into poses in landing-site axes (east, north,
up).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.config.base import stated
from edl6dof.replay.history import History, vector
from edl6dof.replay.scene.site import Site
from edl6dof.spatial import rotations as turns


class Motion:
    """Poses of one flight, at the rows of its history."""

    def __init__(self, flight: History) -> None:
        self.site = Site(flight.scenario)
        self.vehicle = flight.scenario.vehicle
        self.t = flight.t
        self.centre = vector(flight.columns, "truth.site", "east north up", "_m")  #: centre of mass, m
        # : B to L
        self.rotation = self.site.attitude(self.t, vector(flight.columns, "truth.q_I2B", "w x y z"))
        # : origin of B
        self.nose = self.centre - turns.rotate(
            self.rotation, vector(flight.columns, "truth.centre", "x y z", "_m")
        )
        self.height = flight["truth.height_m"]
        self.canopy = vector(flight.columns, "truth.canopy", "east north up", "_m")
        self.heat_shield = vector(flight.columns, "truth.heat_shield", "east north up", "_m")
        self.backshell = vector(flight.columns, "truth.backshell", "east north up", "_m")

    @property
    def last(self) -> np.ndarray:
        """Last position of the centre of mass, m in L."""
        return self.centre[-1]

    def released(self, place: np.ndarray) -> int | None:
        """Row at which a discarded part is first on its own."""
        rows = np.flatnonzero(np.isfinite(place[:, 0]))
        return int(rows[0]) if len(rows) else None

    def parachute(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Rows, confluence points, quaternions and scales of the canopy: x from the confluence to the canopy.

        After release the backshell hangs under the canopy, whose own position is no longer computed: it is
        drawn above.
        """
        model = self.vehicle.main_parachute
        length = model.line_length_m
        first = self.released(self.canopy)
        if first is None or model.diameter_m <= 0.0:
            return np.empty(0, int), np.empty((0, 3)), np.empty((0, 4)), np.empty((0, 3))
        alone = self.released(self.backshell)
        with_vehicle = np.flatnonzero(np.isfinite(self.canopy[:, 0]))
        after = np.arange(alone, len(self.t)) if alone is not None else np.empty(0, int)
        rows = np.union1d(with_vehicle, after)
        confluence = self.nose[rows] + turns.rotate(self.rotation[rows], np.array(model.confluence_m))
        line = self.canopy[rows] - confluence
        free = ~np.isfinite(line[:, 0])
        if free.any():
            place, turn = self.discarded(self.backshell, stated(self.vehicle.showing("backshell")).centre_m)
            confluence[free] = place[rows[free]] + turns.rotate(turn, np.array(model.confluence_m))
            hang = np.array([0.0, 0.0, length])
            held = line[~free][-1] if (~free).any() else hang
            fade = np.exp(-(self.t[rows[free]] - self.t[rows[free][0]]) / 4.0)[:, None]
            line[free] = held * fade + hang * (1.0 - fade)
        reach = np.linalg.norm(line, axis=-1)
        line /= np.where(reach > 1e-6, reach, 1.0)[:, None]
        spread = self._spread(rows, reach)
        ground = self.site.ground(confluence[free, 0], confluence[free, 1])[1]
        fallen = np.flatnonzero(free)[confluence[free, 2] - ground < 3.0]
        spread[fallen] *= (
            np.exp(-(self.t[rows[fallen]] - self.t[rows[fallen]].min()) / 3.0) * 0.8 + 0.2
            if len(fallen)
            else 1.0
        )
        scale = np.stack([reach / length, spread, spread], axis=-1)
        return rows, confluence, turns.from_x_to(line), scale

    def _spread(self, rows: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Width of the canopy over that of the open one, from the drag area it has after line stretch."""
        chute = self.vehicle.main_parachute
        taut = np.flatnonzero(reach >= 0.97 * chute.line_length_m)
        start = self.t[rows[taut[0]]] if len(taut) else np.inf
        grown = np.clip(chute.inflated(self.t[rows] - start), 0.0, 1.0)
        return 0.08 + 0.92 * np.sqrt(grown)

    def discarded(self, place: np.ndarray, own_centre: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Origin of a discarded part's B axes at each row, and its attitude, drawn as it was at release."""
        turn = self.rotation[self.released(place) or 0]
        return place - turns.rotate(turn, np.asarray(own_centre)), turn
