"""Flames: one for each firing thruster, as long as its duty; one for the engine, as long as its throttle is
open.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.mesh import plume
from edl6dof.spatial import rotations as turns


class Flames(Recorder):
    """Writes ``vehicle/thruster_plumes`` and ``vehicle/engine_plume``."""

    def statics(self) -> None:
        """The shape of a flame: a white core in an orange mantle."""
        fires = {"thruster_plumes": self.vehicle.rcs.thrusters, "engine_plume": self.vehicle.engines}
        names = [name for name, those in fires.items() if those]
        for name in names:
            for layer in ("core", "mantle"):
                tint = [255, 255, 255, 255 if layer == "core" else 120]
                self.static(
                    f"{self.root}/vehicle/{name}/{layer}",
                    self.mesh(plume(layer == "core"), albedo_factor=tint),
                )

    def motions(self) -> None:
        """Their lengths."""
        self._thrusters()
        self._engine()

    def _thrusters(self) -> None:
        jets = self.vehicle.rcs.thrusters
        if not jets or self.flight.duty.shape[1] != len(jets):
            return
        duty = self.flight.duty
        back = turns.xyzw(turns.from_x_to(-np.array([jet.direction for jet in jets])))
        places = np.array([jet.position_m for jet in jets])
        size = np.array([1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4 for jet in jets])
        length, shown, rows = _burning(size * (0.35 + 0.65 * duty), duty > 0.02)
        which = np.nonzero(shown)[1]
        length = length[shown]
        scales = np.column_stack([length, 0.37 * length, 0.37 * length])
        poses = self.rr.InstancePoses3D.columns(
            translations=places[which], quaternions=back[which], scales=scales
        )
        self._poses("thruster_plumes", self.t[rows], poses.partition(shown.sum(axis=1)))

    def _engine(self) -> None:
        engines = self.vehicle.engines
        thrust = np.nan_to_num(self.flight["truth.engine_thrust_n"])
        full = sum(engine.full_thrust_n for engine in engines)
        if full <= 0.0 or thrust.max() <= 0.0:
            return
        level = thrust / full  # telemetry holds the thrust of all engines together
        flicker = 1.0 + 0.06 * np.sin(2.0 * np.pi * 7.3 * self.t)
        length, shown, rows = _burning(((0.8 + 3.2 * level) * flicker)[:, None], (level > 0.01)[:, None])
        girth = np.minimum(0.55 + 0.35 * level[rows], length[:, 0])
        scales = np.column_stack([length[:, 0], girth, girth])
        poses = self.rr.InstancePoses3D.columns(
            translations=np.tile([engine.nozzle_m for engine in engines], (len(scales), 1)),
            scales=np.repeat(scales, len(engines), axis=0),
        )
        self._poses("engine_plume", self.t[rows], poses.partition(len(engines) * shown.sum(axis=1)))

    def _poses(self, name: str, t: np.ndarray, poses: Any) -> None:
        for layer in ("core", "mantle"):
            self.columns(f"{self.root}/vehicle/{name}/{layer}", t, poses)


def _burning(length: np.ndarray, firing: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows in which something fires, or has just stopped.

    The latter show one flame too small to see: the viewer takes an empty row for one instance in the default
    pose.

    Args:
        length: of the flames, shape (rows, nozzles).
        firing: which of them burn.

    Returns:
        lengths and shown flames of the rows kept, and the kept rows.
    """
    active: np.ndarray = np.logical_or.reduce(firing, axis=1)
    keep = np.flatnonzero(active | np.append([True], active[:-1]))
    length, shown = length[keep].copy(), firing[keep].copy()
    silent = ~active[keep]
    length[silent], shown[silent, 0] = 1e-4, True
    return length, shown, keep
