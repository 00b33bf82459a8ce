"""The way of a vehicle: path by phase, trail, ground track, marker, shadow."""

from __future__ import annotations

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, Recorder


class Track(Recorder):
    """Writes path, trail, ground track and markers."""

    def statics(self) -> None:
        """The whole path, and its track on the ground."""
        rr, motion = self.rr, self.motion
        rows = thin(self.t, 5.0)
        starts = np.append(0, np.flatnonzero(np.diff(self.phase[rows])) + 1)
        strips = [rows[a : b + 1] for a, b in zip(starts, [*starts[1:], len(rows)], strict=True)]
        colours = [self._colour(int(self.phase[strip[0]])) for strip in strips]
        path = rr.LineStrips3D(
            [motion.centre[strip] for strip in strips], colors=colours, radii=rr.Radius.ui_points(2.0)
        )
        self.static(f"{self.root}/path", path)
        rows = thin(self.t, 1.0)
        east, north = motion.centre[rows, 0], motion.centre[rows, 1]
        low = np.column_stack(
            [east, north, motion.site.ground(east, north)[1] + 0.002 * np.hypot(east, north)]
        )
        self.static(
            f"{self.root}/ground_track",
            rr.LineStrips3D([low], colors=[150, 104, 78], radii=rr.Radius.ui_points(1.0)),
        )

    def motions(self) -> None:
        """Marker, trail, drop line and shadow."""
        rr, motion = self.rr, self.motion
        rows = thin(self.t, SCALAR_HZ)
        labels = {"labels": [self.label], "show_labels": True} if self.label else {}
        white = self.own if self.label else (255, 255, 255)
        self.static(
            f"{self.root}/markers/vehicle", rr.Points3D.from_fields(colors=white, radii=-5.0, **labels)
        )
        self.columns(
            f"{self.root}/markers/vehicle", self.t[rows], rr.Points3D.columns(positions=motion.centre[rows])
        )
        self._drop_line(rows[motion.height[rows] < 20e3])
        self._trail(np.arange(len(self.t)))  # as often as the pose, or it would end behind the vehicle

    def _colour(self, phase: int) -> np.ndarray:
        """The phase's colour; beside other flights, the flight's own."""
        return np.array(self.own, np.uint8) if self.label else self.colours[phase]

    def _drop_line(self, rows: np.ndarray) -> None:
        """A line straight down to the ground."""
        if len(rows) == 0:
            return
        place = self.motion.centre[rows]
        below = place - np.outer(self.motion.height[rows], [0.0, 0.0, 1.0])
        self.static(
            f"{self.root}/drop_line", self.rr.LineStrips3D.from_fields(colors=[190, 170, 150], radii=-0.7)
        )
        self.columns(
            f"{self.root}/drop_line",
            self.t[rows],
            self.rr.LineStrips3D.columns(strips=np.stack([place, below], axis=1)),
        )

    def _trail(self, rows: np.ndarray) -> None:
        """Short segments; the views show those of the last minute."""
        if len(rows) < 2:
            return
        segments = np.stack([self.motion.centre[rows[:-1]], self.motion.centre[rows[1:]]], axis=1)
        colours = np.array([self._colour(k) for k in range(len(self.names))])[self.phase[rows[1:]]]
        colours = np.append(colours, np.full((len(colours), 1), 255, np.uint8), axis=1)
        self.static(f"{self.root}/trail", self.rr.LineStrips3D.from_fields(radii=-1.5))
        self.columns(
            f"{self.root}/trail",
            self.t[rows[1:]],
            self.rr.LineStrips3D.columns(strips=segments, colors=colours),
        )
