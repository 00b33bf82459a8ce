"""The planet as a globe, in km: relief by colour, entry track, ground track, and where the vehicle is."""

from __future__ import annotations

import numpy as np

from edl6dof.environment.appearance import Tint
from edl6dof.replay.history import thin
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.ground import TARGET
from edl6dof.replay.scene.landscape import tints
from edl6dof.replay.scene.mesh import Mesh, bright

#: Length of the arrow to the sun, radii of the planet, and its colour.
SUN_ARROW, SUN = 0.45, (255, 210, 90)


class Globe(Recorder):
    """Writes ``/globe``: planet-fixed axes in km."""

    def statics(self) -> None:
        """Planet, track and site."""
        rr, site = self.rr, self.motion.site
        rows = thin(self.t, 2.0)
        place = site.in_F(self.motion.centre[rows]) / 1e3
        down = place * (site.radius / 1e3 / np.linalg.norm(place, axis=-1, keepdims=True))
        root = f"globe/flight_{self.number}" if self.number else "globe"
        width = rr.Radius.ui_points
        self.static(f"{root}/track", rr.LineStrips3D([place], colors=(255, 236, 120), radii=width(2.2)))
        self.static(
            f"{root}/ground_track", rr.LineStrips3D([down * 1.001], colors=(60, 30, 20), radii=width(1.2))
        )
        if self.number == 0:
            self.static("globe", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
            self.static(
                "globe/planet", self.mesh(planet(site.radius / 1e3, site.relief.map, site.appearance.relief))
            )
            mark = rr.Points3D(
                [site.origin * 1.001 / 1e3],
                labels=["landing site"],
                colors=TARGET,
                radii=width(4.0),
                show_labels=True,
            )
            self.static("globe/site", mark)
            self._sun()

    def _sun(self) -> None:
        """An arrow from the landing site towards the sun, where the scenario tells the moment."""
        site = self.motion.site
        if site.sun is None:
            return
        along = site.in_F(site.radius * site.sun) - site.in_F(np.zeros(3))
        arrow = self.rr.Arrows3D(
            vectors=[SUN_ARROW * along / 1e3],
            origins=[site.origin * 1.001 / 1e3],
            colors=SUN,
            radii=self.rr.Radius.ui_points(1.6),
        )
        self.static("globe/sun", arrow)
        tip = site.origin * 1.001 / 1e3 + SUN_ARROW * along / 1e3
        name = self.rr.Points3D([tip], labels=["to the sun"], colors=SUN, radii=0.0, show_labels=True)
        self.static("globe/sun/name", name)

    def motions(self) -> None:
        """The vehicle as a point."""
        rows = thin(self.t, 2.0)
        root = f"globe/flight_{self.number}" if self.number else "globe"
        self.static(f"{root}/vehicle", self.rr.Points3D.from_fields(colors=(255, 255, 255), radii=-5.0))
        place = self.motion.site.in_F(self.motion.centre[rows]) / 1e3
        self.columns(f"{root}/vehicle", self.t[rows], self.rr.Points3D.columns(positions=place))


def planet(radius_km: float, heights: np.ndarray, relief: list[Tint]) -> Mesh:
    """A sphere with the map as colours by the heights (km) of ``relief``, lit from the west; the relief is in
    the colours only.
    """
    height = heights.reshape(90, 2, 180, 2).mean(axis=(1, 3))  # 2 degrees, m
    lat = np.radians(np.linspace(89.0, -89.0, 90))[:, None]
    lon = np.radians(np.linspace(-179.0, 179.0, 180))
    east = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) / np.maximum(np.cos(lat), 0.15)
    north = np.gradient(height, axis=0)
    light = np.clip(1.0 + (0.9 * east - 0.9 * north) / 9e3, 0.55, 1.35)
    tone = tints(relief, height / 1e3)
    ice = np.clip((np.abs(np.degrees(lat)) - 78.0) / 6.0, 0.0, 1.0)[..., None] * float(heights.any())
    colours = tone * light[..., None] + (np.array([244.0, 240.0, 238.0]) - tone * light[..., None]) * ice
    place = radius_km * np.stack(
        [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat) + 0.0 * lon], axis=-1
    )
    poles = np.array([[0.0, 0.0, radius_km], [0.0, 0.0, -radius_km]])
    i, j = np.meshgrid(np.arange(89), np.arange(180), indexing="ij")
    a, b = i * 180 + j, i * 180 + (j + 1) % 180
    sides = np.stack([a, a + 180, b + 180, a, b + 180, b], axis=-1).reshape(-1, 3)
    around = np.arange(180)
    caps = [
        np.stack([np.full(180, 16200 + k), first + around, first + (around + 1) % 180], axis=-1)
        for k, first in ((0, 0), (1, 89 * 180))
    ]
    colours = np.concatenate([colours.reshape(-1, 3), colours[:1].mean(axis=1), colours[-1:].mean(axis=1)])
    return bright(np.append(place.reshape(-1, 3), poles, axis=0), np.concatenate([sides, *caps]), colours)
