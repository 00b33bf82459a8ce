"""Arrows at the vehicle: velocity, lift, thrust, disturbance torque; and the attitude and velocity frames."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.replay.history import thin, vector
from edl6dof.replay.recorder import SCALAR_HZ, Recorder
from edl6dof.replay.scene.mesh import RGB
from edl6dof.spatial import rotations as turns

VELOCITY, LIFT, THRUST, TORQUE = (110, 230, 240), (130, 235, 120), (255, 190, 90), (240, 110, 220)


class Arrows(Recorder):
    """Writes ``arrows``, in landing-site axes, and ``vehicle/frame`` and ``velocity_frame``."""

    def motions(self) -> None:
        """Each arrow from its own start: the velocity ahead of the vehicle, forces at the centre of mass."""
        motion, columns = self.motion, self.flight.columns
        rows = thin(self.t, SCALAR_HZ)
        size = self.vehicle.aero.capsule.diameter_m
        if len(rows) < 3:
            return
        way = np.gradient(motion.centre[rows], self.t[rows], axis=0)
        speed = np.linalg.norm(way, axis=-1, keepdims=True)
        way = way / np.maximum(speed, 1e-9)
        flying = speed[:, 0] > 0.5
        self._arrow("velocity", VELOCITY, rows, 0.62 * size * way, flying, 0.42 * size * way)
        force = turns.rotate(motion.rotation[rows], vector(columns, "truth.aero_force", "x y z", "_n")[rows])
        lift = force - (force * way).sum(axis=-1, keepdims=True) * way
        before = self.t[rows] < self.when.get("mortar", np.inf)
        self._arrow("lift", LIFT, rows, _scaled(lift, before, size), before)
        thrust = self.flight["truth.engine_thrust_n"][rows]
        up = turns.rotate(motion.rotation[rows], np.array([-1.0, 0.0, 0.0]))
        full = sum(engine.full_thrust_n for engine in self.vehicle.engines)
        self._arrow(
            "thrust",
            THRUST,
            rows,
            0.9 * size * up * (thrust / max(full, 1.0))[:, None],
            thrust > 1.0,
        )
        torque = turns.rotate(
            motion.rotation[rows], vector(columns, "truth.disturbance", "x y z", "_nm")[rows]
        )
        free = ~np.isfinite(motion.canopy[rows, 0])
        self._arrow("disturbance torque", TORQUE, rows, _scaled(torque, free, size), free)
        self._frames(rows, way)

    def _arrow(
        self,
        name: str,
        colour: RGB,
        rows: np.ndarray,
        vectors: np.ndarray,
        shown: np.ndarray,
        start: Any = 0.0,
    ) -> None:
        """One arrow where ``shown``, from the centre of mass plus ``start``; with its name."""
        rr = self.rr
        shown = shown & np.isfinite(vectors).all(axis=-1) & (np.linalg.norm(vectors, axis=-1) > 0.02)
        keep = shown | np.append(False, shown[:-1])  # a row without an arrow ends it
        if not shown.any():
            return
        origins = (self.motion.centre[rows] + start)[shown]
        entity = f"{self.root}/arrows/{name.replace(' ', '_')}"
        self.static(
            entity,
            rr.Arrows3D.from_fields(
                colors=colour, radii=0.011 * self.vehicle.aero.capsule.diameter_m, labels=[name]
            ),
        )
        arrows = rr.Arrows3D.columns(origins=origins, vectors=vectors[shown])
        self.columns(entity, self.t[rows[keep]], arrows.partition(shown[keep].astype(int)))

    def _frames(self, rows: np.ndarray, way: np.ndarray) -> None:
        """Body axes B at the centre of mass, and the velocity frame: x along the velocity, z down in its
        vertical plane.
        """
        rr, motion = self.rr, self.motion
        size = self.vehicle.aero.capsule.diameter_m
        down = -(motion.centre[rows] + motion.site.axes @ motion.site.origin)
        right = np.cross(down, way)
        right /= np.maximum(np.linalg.norm(right, axis=-1, keepdims=True), 1e-9)
        axes = np.stack([way, right, np.cross(way, right)], axis=-1)
        steep = np.abs(np.linalg.det(axes)) < 0.5  # at rest, or falling straight down
        axes[steep] = np.eye(3)
        self.static(f"{self.root}/velocity_frame", rr.TransformAxes3D(axis_length=0.75 * size))
        pose = rr.Transform3D.columns(
            translation=motion.centre[rows], quaternion=turns.xyzw(turns.from_axes(axes))
        )
        self.columns(f"{self.root}/velocity_frame", self.t[rows], pose)
        middle = [self.flight[f"truth.centre_{axis}_m"][0] for axis in "xyz"]
        self.static(
            f"{self.root}/vehicle/attitude_frame",
            rr.Transform3D(translation=middle),
            rr.TransformAxes3D(axis_length=0.6 * size),
        )


def _scaled(vectors: np.ndarray, shown: np.ndarray, size: float) -> np.ndarray:
    """Arrows whose longest is about the vehicle's size; small ones stay visible."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    largest = max(float(np.nanmax(np.where(shown[:, None], length, 0.0), initial=0.0)), 1e-9)
    return 0.9 * size * vectors / np.maximum(length, 1e-9) * np.sqrt(length / largest)
