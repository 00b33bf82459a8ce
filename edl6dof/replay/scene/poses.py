"""Poses: telemetry converted to places and attitudes in landing-site axes (east, north, up)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import stated
from edl6dof.replay.history import History, vector
from edl6dof.replay.scene.outline import outline
from edl6dof.replay.scene.site_frame import Site
from edl6dof.spatial import rotations as turns

#: Longest stroke (m) of a leg that is drawn.
_LONGEST_STROKE = 0.4


class OpenParachute(NamedTuple):
    """Number of a parachute in the vehicle file, its first row, and the row after its last."""

    number: int
    first: int
    end: int


class Motion:
    """Poses of one flight, at the rows of its history."""

    def __init__(self, flight: History) -> None:
        self.site = Site(flight.scenario)
        self.vehicle = flight.scenario.vehicle
        self.shape = outline(self.vehicle)  #: what the vehicle looks like
        self.t = flight.t
        self.centre = vector(flight.columns, "truth.site", "east north up", "_m")  #: centre of mass, m
        # : B to L
        self.rotation = self.site.attitude(self.t, vector(flight.columns, "truth.q_I2B", "w x y z"))
        # : origin of B
        self.nose = self.centre - turns.rotate(
            self.rotation, vector(flight.columns, "truth.centre", "x y z", "_m")
        )
        self.height = flight["truth.height_m"]
        events = flight.scenario.mission.events
        self._deployed = [
            (float(one["t_s"]), events[one["key"]].thing)
            for one in flight.events
            if one["key"] in events and events[one["key"]].action == "deploy"
        ]
        self.canopy = vector(flight.columns, "truth.canopy", "east north up", "_m")
        self.heat_shield = vector(flight.columns, "truth.heat_shield", "east north up", "_m")
        self.backshell = vector(flight.columns, "truth.backshell", "east north up", "_m")

    @property
    def last(self) -> np.ndarray:
        """Last position of the centre of mass, m in L."""
        return self.centre[-1]

    def released(self, place: np.ndarray) -> int | None:
        """Return the row at which a discarded part is first on its own."""
        rows = np.flatnonzero(np.isfinite(place[:, 0]))
        return int(rows[0]) if len(rows) else None

    def strokes(self, pads: np.ndarray) -> np.ndarray:
        """Return how far (m) the ground under each of ``pads`` (m in B) pushes it up at the last row, none
        negative.
        """
        turn = self.rotation[-1]
        place = self.nose[-1] + turns.rotate(turn, pads)
        below = self.site.ground(place[:, 0], place[:, 1])[1] - place[:, 2]
        upright = max(-turns.rotate(turn, np.array([1.0, 0.0, 0.0]))[2], 0.5)
        return np.clip(below / upright, 0.0, _LONGEST_STROKE)

    def parachutes(self) -> list[OpenParachute]:
        """Return the parachutes in order: each from its deployment on, the last to the end."""
        out = self.released(self.canopy)
        if out is None or not self.vehicle.parachutes:
            return []
        chutes = {chute.name: number for number, chute in enumerate(self.vehicle.parachutes)}
        found = [
            (max(int(np.searchsorted(self.t, t)), out), chutes[name])
            for t, name in sorted(self._deployed)
            if name in chutes
        ]
        found = found or [(out, len(chutes) - 1)]
        ends = [first for first, _ in found[1:]] + [len(self.t)]
        return [
            OpenParachute(number, first, end)
            for (first, number), end in zip(found, ends, strict=True)
            if first < end
        ]

    def parachute(self, flown: OpenParachute) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return rows, confluence points, quaternions and scales of a canopy: x from the confluence to the
        canopy.

        After release the backshell hangs under the last canopy, whose own position is no longer computed: it
        is drawn above.
        """
        chute = self.vehicle.parachutes[flown.number]
        length, middle = chute.line_length_m, np.array(chute.confluence_m)
        alone = self.released(self.backshell) if flown.end == len(self.t) else None
        own = np.arange(flown.first, flown.end)
        held = own[np.isfinite(self.canopy[own, 0])]
        after = np.arange(alone, len(self.t)) if alone is not None and len(held) else np.empty(0, int)
        rows = np.union1d(held, after)
        confluence = self.nose[rows] + turns.rotate(self.rotation[rows], middle)
        line = self.canopy[rows] - confluence
        free = ~np.isfinite(line[:, 0])
        if free.any():
            place, turn = self.discarded(self.backshell, stated(self.vehicle.showing("backshell")).centre_m)
            confluence[free] = place[rows[free]] + turns.rotate(turn, middle)
            hang = np.array([0.0, 0.0, length])
            last = line[~free][-1] if (~free).any() else hang
            fade = np.exp(-(self.t[rows[free]] - self.t[rows[free][0]]) / 4.0)[:, None]
            line[free] = last * fade + hang * (1.0 - fade)
        reach = np.linalg.norm(line, axis=-1)
        line /= np.where(reach > 1e-6, reach, 1.0)[:, None]
        spread = self._spread(flown.number, rows, reach)
        ground = self.site.ground(confluence[free, 0], confluence[free, 1])[1]
        fallen = np.flatnonzero(free)[confluence[free, 2] - ground < 3.0]
        if len(fallen):
            spread[fallen] *= np.exp(-(self.t[rows[fallen]] - self.t[rows[fallen]].min()) / 3.0) * 0.8 + 0.2
        scale = np.stack([reach / length, spread, spread], axis=-1)
        return rows, confluence, turns.from_x_to(line), scale

    def _spread(self, number: int, rows: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Relative width of a canopy, from its drag area after line stretch."""
        chute = self.vehicle.parachutes[number]
        taut = np.flatnonzero(reach >= 0.97 * chute.line_length_m)
        start = self.t[rows[taut[0]]] if len(taut) else np.inf
        grown = np.clip(chute.inflated(self.t[rows] - start), 0.0, 1.0)
        return 0.08 + 0.92 * np.sqrt(grown)

    def discarded(self, place: np.ndarray, own_centre: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the origin of a discarded part's B axes at each row, and its attitude, drawn as at
        release.
        """
        turn = self.rotation[self.released(place) or 0]
        return place - turns.rotate(turn, np.asarray(own_centre)), turn
