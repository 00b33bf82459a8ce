"""Tracks: the path of each vehicle over the site and on the globe."""

from __future__ import annotations

import numpy as np

from edl6dof.environment.planet import Tint
from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, Recorder
from edl6dof.replay.scene.ground import TARGET
from edl6dof.replay.scene.landscape import tints
from edl6dof.replay.scene.mesh import Mesh, bright, grid_triangles, pole_triangles

#: Length of the arrow to the sun, radii of the planet, and its colour.
SUN_ARROW, SUN = 0.45, (255, 210, 90)


class Track(Recorder):
    """Writes path, trail, ground track and markers."""

    def statics(self) -> None:
        """Write the whole path, and its track on the ground."""
        motion, rows = self.motion, thin(self.t, 5.0)
        starts = np.append(0, np.flatnonzero(np.diff(self.phase[rows])) + 1)
        strips = [rows[a : b + 1] for a, b in zip(starts, [*starts[1:], len(rows)], strict=True)]
        colours = [self._colour(int(self.phase[strip[0]])) for strip in strips]
        self.lines(f"{self.root}/path", [motion.centre[strip] for strip in strips], colours, 2.0)
        east, north = motion.centre[thin(self.t, 1.0), :2].T
        up = motion.site.ground(east, north)[1] + 0.002 * np.hypot(east, north)
        self.lines(f"{self.root}/ground_track", [np.column_stack([east, north, up])], [150, 104, 78], 1.0)

    def motions(self) -> None:
        """Write marker, drop line and trail."""
        rr, motion, rows = self.rr, self.motion, thin(self.t, SCALAR_HZ)
        look = {"labels": [self.label], "show_labels": True} if self.label else {}
        look |= {"colors": self.own if self.label else (255, 255, 255), "radii": -5.0}
        marker = f"{self.root}/markers/vehicle"
        self.series(marker, self.t[rows], rr.Points3D, look, {"positions": motion.centre[rows]})
        rows = rows[motion.height[rows] < 20e3]
        if len(rows):
            below = motion.centre[rows] - np.outer(motion.height[rows], [0.0, 0.0, 1.0])
            drop, look = f"{self.root}/drop_line", {"colors": [190, 170, 150], "radii": -0.7}
            strips = np.stack([motion.centre[rows], below], axis=1)
            self.series(drop, self.t[rows], rr.LineStrips3D, look, {"strips": strips})
        if len(self.t) > 1:  # segments as often as the pose, or the trail would end behind the vehicle
            segments = np.stack([motion.centre[:-1], motion.centre[1:]], axis=1)
            colours = np.array([self._colour(k) for k in range(len(self.names))])[self.phase[1:]]
            colours = np.append(colours, np.full((len(colours), 1), 255, np.uint8), axis=1)
            data = {"strips": segments, "colors": colours}
            self.series(f"{self.root}/trail", self.t[1:], rr.LineStrips3D, {"radii": -1.5}, data)

    def _colour(self, phase: int) -> np.ndarray:
        """Colour of the phase; with several flights, that of the flight."""
        return np.array(self.own, np.uint8) if self.label else self.colours[phase]


class Globe(Recorder):
    """Writes ``/globe``: planet-fixed axes in km."""

    def statics(self) -> None:
        """Write planet, track and site."""
        site, place = self.motion.site, self._places()
        down = place * (site.radius / 1e3 / np.linalg.norm(place, axis=-1, keepdims=True))
        self.lines(f"{self._root}/track", [place], (255, 236, 120), 2.2)
        self.lines(f"{self._root}/ground_track", [down * 1.001], (60, 30, 20), 1.2)
        if self.number:
            return
        self.static("globe", self.rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        mesh = planet(site.radius / 1e3, site.relief.map, site.appearance.relief)
        self.static("globe/planet", self.mesh(mesh))
        self.static("globe/site", self.point(site.origin * 1.001 / 1e3, "landing site", TARGET))
        self._sun()

    def _sun(self) -> None:
        """Log an arrow from the landing site to the sun, if the scenario has a date."""
        site, origin = self.motion.site, self.motion.site.origin * 1.001 / 1e3
        if site.sun is not None:
            along = SUN_ARROW * (site.in_F(site.radius * site.sun) - site.in_F(np.zeros(3))) / 1e3
            arrow = self.rr.Arrows3D(vectors=[along], origins=[origin], colors=SUN, radii=-1.6)
            self.static("globe/sun", arrow)
            self.static("globe/sun/name", self.point(origin + along, "to the sun", SUN, 0.0))

    def motions(self) -> None:
        """Write the vehicle as a point."""
        look, data = {"colors": (255, 255, 255), "radii": -5.0}, {"positions": self._places()}
        self.series(f"{self._root}/vehicle", self.t[thin(self.t, 2.0)], self.rr.Points3D, look, data)

    @property
    def _root(self) -> str:
        return f"globe/flight_{self.number}" if self.number else "globe"

    def _places(self) -> np.ndarray:
        """Places of the vehicle, km in F."""
        return self.motion.site.in_F(self.motion.centre[thin(self.t, 2.0)]) / 1e3


def planet(radius_km: float, heights: np.ndarray, relief: list[Tint]) -> Mesh:
    """Return a sphere with the map as colours by the heights (km) of ``relief``, lit from the west."""
    height = heights.reshape(90, 2, 180, 2).mean(axis=(1, 3))  # 2 degrees, m
    lat = np.radians(np.linspace(89.0, -89.0, 90))[:, None]
    lon = np.radians(np.linspace(-179.0, 179.0, 180))
    east = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) / np.maximum(np.cos(lat), 0.15)
    north = np.gradient(height, axis=0)
    light = np.clip(1.0 + (0.9 * east - 0.9 * north) / 9e3, 0.55, 1.35)
    tone = tints(relief, height / 1e3)
    ice = np.clip((np.abs(np.degrees(lat)) - 78.0) / 6.0, 0.0, 1.0)[..., None] * float(heights.any())
    colours = tone * light[..., None]
    colours += (np.array([244.0, 240.0, 238.0]) - colours) * ice
    colours = np.concatenate([colours.reshape(-1, 3), colours[:1].mean(axis=1), colours[-1:].mean(axis=1)])
    level = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat) + 0.0 * lon], axis=-1)
    place = radius_km * np.append(level.reshape(-1, 3), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], axis=0)
    return bright(place, np.concatenate([grid_triangles(90, 180), *pole_triangles(90, 180)]), colours)
