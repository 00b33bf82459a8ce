"""The vehicle of the replay: lander and aeroshell, heat glow, trim wing, legs, thrusters that have failed,
attitude.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene import vehicle_shapes as shapes
from edl6dof.spatial import rotations as turns
from edl6dof.telemetry.spans import spans

RED, PALE_RED = (255, 40, 40), (255, 120, 120)
SHIELD_COLD, SHIELD_HOT = np.array([104.0, 84.0, 70.0]), np.array([255.0, 150.0, 70.0])


class Vehicle(Recorder):
    """Writes ``vehicle``, whose axes are B."""

    def statics(self) -> None:
        """Lander and nozzles."""
        self.static(f"{self.root}/vehicle/lander", self.mesh(shapes.lander(self.vehicle)))

    def motions(self) -> None:
        """Everything that moves, leaves or breaks."""
        motion, vehicle = self.motion, self.vehicle
        pose = self.rr.Transform3D.columns(translation=motion.nose, quaternion=turns.xyzw(motion.rotation))
        self.columns(f"{self.root}/vehicle", self.t, pose)
        for part, shape, place in (
            ("heat_shield", shapes.heat_shield(vehicle), motion.heat_shield),
            ("backshell", shapes.backshell(vehicle), motion.backshell),
        ):
            self.at(self.t[0], f"{self.root}/vehicle/{part}", self.mesh(shape))
            released = motion.released(place)
            if released is not None:
                self.gone(self.t[released], f"{self.root}/vehicle/{part}")
        legs = shapes.legs(vehicle)
        if legs is not None and "landing_legs" in self.when:
            self.at(self.when["landing_legs"], f"{self.root}/vehicle/legs", self.mesh(legs))
        self._glow()
        if vehicle.surfaces:
            self._trim_wing()
        for jet in vehicle.rcs.thrusters:
            self._failure(jet)

    def _glow(self) -> None:
        """The heat shield glows with its heat flux."""
        rows = thin(self.t, 2.0)
        until = self.motion.released(self.motion.heat_shield)
        rows = rows[rows < (len(self.t) if until is None else until)]
        heat = np.maximum(np.nan_to_num(self.flight["truth.heat_flux_w_cm2"]), 0.0)
        glow = (heat[rows] / max(heat.max(), 1e-9))[:, None] ** 0.6
        tint = np.column_stack(
            [SHIELD_COLD + (SHIELD_HOT - SHIELD_COLD) * glow, np.full(len(rows), 255.0)]
        ).astype(np.uint8)
        self.columns(
            f"{self.root}/vehicle/heat_shield", self.t[rows], self.rr.Mesh3D.columns(albedo_factor=tint)
        )

    def _trim_wing(self) -> None:
        """It swings out about its hinge, and leaves with the backshell."""
        entity, shape = f"{self.root}/vehicle/trim_wing", self.mesh(shapes.trim_wing(self.vehicle))
        hinge = shapes.wing_hinge(self.vehicle)[0]
        opening = np.nan_to_num(self.flight["truth.trim_wing"])
        released = self.motion.released(self.motion.backshell)
        rows = np.append(0, np.flatnonzero(np.diff(opening)) + 1)
        rows = rows[rows < (len(self.t) if released is None else released)]
        turned = turns.xyzw(turns.from_axes(shapes.wing_axes(self.vehicle, opening[rows])))
        self.at(self.t[0], entity, shape)
        pose = self.rr.Transform3D.columns(translation=np.tile(hinge, (len(rows), 1)), quaternion=turned)
        self.columns(entity, self.t[rows], pose)
        if released is not None:
            self.gone(self.t[released], entity)
            last = self.rr.Transform3D(translation=hinge, quaternion=turned[-1])
            self.at(self.t[released], f"{self.root}/backshell/trim_wing", shape, last)

    def _failure(self, jet: Any) -> None:
        """A thruster that has failed is red while it is failed; once the flight software knows, it is
        named.
        """
        entity = f"{self.root}/vehicle/failed/{jet.name}"
        place = np.array(jet.position_m) + 0.35 * np.array([0.0, *jet.position_m[1:]])
        failed = self.flight.failures.get(jet.name, np.zeros(0))
        for begin, end in spans(failed > 0):
            self.at(self.t[begin], entity, self.mesh(shapes.nozzle(jet, RED, 2.0)))
            self._mark(self.t[begin], entity, place, "failed")
            if end < len(self.t):
                self.at(self.t[end], entity, self.rr.Clear(recursive=True))
        known = self.flight.diagnosed.get(jet.name)
        if known is not None:
            self._mark(known.t_s, entity, place, known.text)

    def _mark(self, t: float, entity: str, place: np.ndarray, text: str) -> None:
        """A red point with a text, which is seen through the hull."""
        size = self.rr.Radius.ui_points(4.0)
        self.at(
            t,
            f"{entity}/mark",
            self.rr.Points3D([place], labels=[text], colors=PALE_RED, radii=size, show_labels=True),
        )
