"""Ground, sky and target of the replay: what all flights of a recording share."""

from __future__ import annotations

import numpy as np

from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.landscape import Landscape, sky
from edl6dof.replay.scene.mesh import disc, rock
from edl6dof.scenario.terrain_preview import planned_ellipse
from edl6dof.spatial import rotations as turns

TARGET = (90, 220, 230)
SUNLIGHT = (255, 250, 235)
#: Radius of the sun's disc on the dome of unit radius: four times the true one, or it would be a point.
_SUN_SIZE = 0.025
KINDS_OF_ROCK = 4
#: Radius (m) of the target's largest circle where no limit sets it.
_TARGET_M = 10e3


class Ground(Recorder):
    """Writes ``/site/ground``, ``/site/sky`` and the target."""

    def statics(self) -> None:
        """Landscape, rocks, rings around touchdown and target, the planned ellipse."""
        if self.number:
            return
        rr, motion = self.rr, self.motion
        self.static("site", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        reach = float(np.clip(1.15 * np.linalg.norm(motion.centre - motion.last, axis=-1).max(), 5e3, 1.2e6))
        landscape = Landscape(motion.site, motion.last)
        self.static("site/ground", self.mesh(landscape.mesh()))
        if (near := landscape.near()) is not None:
            self.static("site/ground/near", self.mesh(near))
        self._rocks(landscape)
        radii = [r for r in (10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3) if r < reach]
        rings = rr.LineStrips3D(
            [self._ring(landscape, r, motion.last) for r in radii],
            colors=[120, 72, 48],
            radii=rr.Radius.ui_points(0.5),
        )
        self.static("site/ground/rings", rings)
        limit = self.flight.scenario.limits.landing_distance_m or _TARGET_M
        circles = [self._ring(landscape, r, np.zeros(3)) for r in (0.01 * limit, 0.1 * limit, limit)]
        self.static(
            "site/markers/target", rr.LineStrips3D(circles, colors=TARGET, radii=rr.Radius.ui_points(1.2))
        )
        self._ellipse(landscape)
        level = motion.site.ground(np.zeros(1), np.zeros(1))[1]
        self.marker("target", [0.0, 0.0, float(level[0])], TARGET)
        if self.flight["truth.footpads"][-1] > 0.0:
            self.marker(
                "touchdown", [*motion.last[:2], float(motion.last[2] - motion.height[-1])], (120, 235, 140)
            )

    def motions(self) -> None:
        """The sky goes with the vehicle and darkens with height."""
        if self.number:
            return
        look = self.motion.site.appearance
        rows = np.flatnonzero(self.motion.height < look.sky_top_m)[::12]
        if len(rows) == 0:
            return
        self.at(self.t[rows[0]], "site/sky/dome", self.mesh(sky(look.sky_horizon, look.sky_zenith)))
        if (sun := self.motion.site.sun) is not None and sun[2] > 0.0:
            self.at(self.t[rows[0]], "site/sky/sun", self.mesh(disc(0.97 * sun, sun, _SUN_SIZE, SUNLIGHT)))
        # beyond the farthest ground that is seen from where there is a sky
        reach = 1.5 * np.sqrt(look.sky_top_m * (2.0 * self.motion.site.radius + look.sky_top_m))
        scale = np.full((len(rows), 3), reach)
        place = self.rr.Transform3D.columns(translation=self.motion.centre[rows], scale=scale)
        self.columns("site/sky", self.t[rows], place)
        bright = np.exp(-np.maximum(self.motion.height[rows], 0.0) / look.sky_scale_m)
        tint = np.column_stack([np.outer(255.0 * bright, [1.0, 1.0, 1.0]), np.full(len(rows), 255.0)]).astype(
            np.uint8
        )
        self.columns("site/sky/dome", self.t[rows], self.rr.Mesh3D.columns(albedo_factor=tint))

    def _ellipse(self, landscape: Landscape) -> None:
        site = self.flight.scenario.terrain
        if site.ellipse_length_m > 0.0:
            east, north = planned_ellipse(
                site.ellipse_length_m, site.ellipse_width_m, np.radians(site.ellipse_azimuth_deg)
            )
            line = np.column_stack([east, north, landscape.height(east, north) + 100.0])
            drawn = self.rr.LineStrips3D([line], colors=TARGET, radii=self.rr.Radius.ui_points(0.8))
            self.static("site/markers/ellipse", drawn)

    def _ring(self, landscape: Landscape, radius: float, centre: np.ndarray) -> np.ndarray:
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        east, north = centre[0] + radius * np.cos(turn), centre[1] + radius * np.sin(turn)
        return np.column_stack([east, north, landscape.height(east, north) + 0.1 + 2e-3 * radius])

    def _rocks(self, landscape: Landscape) -> None:
        rocks, look = landscape.rocks(), self.motion.site.appearance
        upright = turns.xyzw(turns.about_z(rocks.headings))
        for kind in range(KINDS_OF_ROCK):
            some = slice(kind, None, KINDS_OF_ROCK)
            poses = self.rr.InstancePoses3D(
                translations=rocks.places[some], quaternions=upright[some], scales=rocks.sizes[some]
            )
            self.static(
                f"site/ground/rocks/{kind}", self.mesh(rock(kind, look.rock, self.motion.site.light)), poses
            )
