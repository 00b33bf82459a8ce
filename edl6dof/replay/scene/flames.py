"""Flames: one for each firing thruster, as long as its duty; one for each engine, as long as its throttle."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.replay.recorder import Recorder, and_next
from edl6dof.replay.scene.mesh import plume
from edl6dof.spatial import rotations as turns

SPARK = (255, 196, 96)
#: Size (points of the screen) of the spark that shows a firing thruster from however far.
_SPARK_SIZE = 2.5
#: Share of the thrust, and duty of a thruster, from which on a flame is seen.
_LEAST_LEVEL, _LEAST_DUTY = 0.01, 0.02
#: Length (m) of a flame that is out.
_GONE = 1e-4


class Flames(Recorder):
    """Writes ``vehicle/thruster_plumes``, ``vehicle/thruster_sparks`` and ``vehicle/engine_plume``."""

    def motions(self) -> None:
        """Write their shapes from the first time that one burns, and their lengths."""
        self._thrusters()
        self._engines()

    def _thrusters(self) -> None:
        jets = self.vehicle.rcs.thrusters
        if not jets or self.flight.duty.shape[1] != len(jets):
            return
        duty = self.flight.duty
        back = turns.xyzw(turns.from_x_to(-np.array([jet.direction for jet in jets])))
        places = np.array([jet.position_m for jet in jets])
        size = np.array([1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4 for jet in jets])
        firing = duty > _LEAST_DUTY
        length, shown, rows = _burning(size * (0.35 + 0.65 * duty), firing)
        if not len(rows):
            return
        which, length = np.nonzero(shown)[1], length[shown]
        scales = np.column_stack([length, 0.37 * length, 0.37 * length])
        poses = self.rr.InstancePoses3D.columns(
            translations=places[which], quaternions=back[which], scales=scales
        )
        self._flames("thruster_plumes", rows, poses.partition(shown.sum(axis=1)))
        # points of one size on the screen: a flame is too small to be seen from afar
        sparks = {"positions": places[np.nonzero(firing[rows])[1]]}
        entity, look = f"{self.root}/vehicle/thruster_sparks", {"colors": SPARK, "radii": -_SPARK_SIZE}
        self.series(entity, self.t[rows], self.rr.Points3D, look, sparks, firing[rows].sum(axis=1))

    def _engines(self) -> None:
        engines = self.vehicle.own_engines
        thrust = np.nan_to_num(self.flight["truth.engine_thrust_n"])
        full = sum(engine.full_thrust_n for engine in engines)
        if full <= 0.0:
            return
        level = thrust / full  # telemetry holds the thrust of all engines together
        flicker = 1.0 + 0.06 * np.sin(2.0 * np.pi * 7.3 * self.t)
        burns = (level > _LEAST_LEVEL)[:, None]
        length, shown, rows = _burning(((0.8 + 3.2 * level) * flicker)[:, None], burns)
        if not len(rows):
            return
        girth = np.minimum(0.55 + 0.35 * level[rows], length[:, 0])
        scales = np.column_stack([length[:, 0], girth, girth])
        back = turns.xyzw(turns.from_x_to(-np.array([engine.direction for engine in engines])))
        poses = self.rr.InstancePoses3D.columns(
            translations=np.tile([engine.nozzle_m for engine in engines], (len(scales), 1)),
            quaternions=np.tile(back, (len(scales), 1)),
            scales=np.repeat(scales, len(engines), axis=0),
        )
        self._flames("engine_plume", rows, poses.partition(len(engines) * shown.sum(axis=1)))

    def _flames(self, name: str, rows: np.ndarray, poses: Any) -> None:
        """Write a white core in an orange mantle, from the first of ``rows`` on."""
        for layer, opacity in (("core", 255), ("mantle", 120)):
            entity = f"{self.root}/vehicle/{name}/{layer}"
            shape = self.mesh(plume(layer == "core"), albedo_factor=[255, 255, 255, opacity])
            self.at(self.t[rows[0]], entity, shape)
            self.columns(entity, self.t[rows], poses)


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
    keep = np.flatnonzero(and_next(active))
    length, shown = length[keep].copy(), firing[keep].copy()
    silent = ~active[keep]
    length[silent], shown[silent, 0] = _GONE, True
    return length, shown, keep
