"""The way of a vehicle: path by phase, trail, ground track, marker, shadow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from edl6dof.environment.appearance import Tint
from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, Recorder
from edl6dof.replay.scene.ground import TARGET
from edl6dof.replay.scene.landscape import tints
from edl6dof.replay.scene.mesh import Mesh, bright

if TYPE_CHECKING:
    import rerun as rr


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


SUCCESS = (110, 205, 130)
#: Colours of the causes of failure, the commonest first; those beyond share the last.
CAUSES = ((240, 80, 80), (250, 170, 60), (200, 120, 245), (90, 170, 250), (240, 225, 90), (150, 150, 155))
COLOURS = ("green", "red", "orange", "violet", "blue", "yellow", "grey")


class Trajectory(NamedTuple):
    """Where one case flew: places (n, 3) in L, m; and why it failed, empty when it did not."""

    places: np.ndarray
    cause: str


class Ensemble(NamedTuple):
    """The trajectories of a campaign's cases; and which flight among them the camera follows, and why."""

    trajectories: Sequence[Trajectory]
    followed: str


def write_ensemble(recording: rr.RecordingStream, ensemble: Ensemble) -> None:
    """Write ``/site/campaign``: one entity for the successes and one for each cause, and as text the counts
    and whom the camera follows.
    """
    import rerun as rr

    trajectories = ensemble.trajectories
    found = [one.cause for one in trajectories]
    causes = sorted(set(found) - {""}, key=lambda cause: (-found.count(cause), cause))
    lines = [
        f"## {found.count('')} of {len(found)} succeed\n",
        f"Followed here, in white: {ensemble.followed}\n",
        "| cases | colour | outcome |",
        "|--:|:--|:--|",
    ]
    for k, cause in enumerate(["", *causes]):
        colour = SUCCESS if not cause else CAUSES[min(k - 1, len(CAUSES) - 1)]
        strips = [
            one.places[np.isfinite(one.places).all(axis=-1)] for one in trajectories if one.cause == cause
        ]
        entity = f"site/campaign/{'success' if not cause else f'failure_{k}'}"
        recording.log(
            entity, rr.LineStrips3D(strips, colors=colour, radii=rr.Radius.ui_points(0.8)), static=True
        )
        lines.append(f"| {len(strips)} | {COLOURS[min(k, len(CAUSES))]} | {cause or 'success'} |")
    recording.log("campaign", rr.TextDocument("\n".join(lines), media_type="text/markdown"), static=True)
