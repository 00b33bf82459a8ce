"""The views of the scene, and where each looks from."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import rerun.blueprint as rrb

TIMELINE = "time"
#: How long (s) a trail is.
TRAIL_S = 60.0
SPACE = (10, 9, 12)
#: The viewer's field of view from top to bottom, deg.
FIELD_DEG = 55.0
#: Half the angle (deg) that the sphere which a camera follows fills: less than half the field, so that the
#: sphere also fits into a view that is narrower than high.
KEPT_DEG = 20.0
#: Where the eye stands in a camera's frame, whose unit is the sphere's radius: beside, a little above.
EYE = np.array([2.6, 9.2, 2.6]) / np.linalg.norm([2.6, 9.2, 2.6]) / np.sin(np.radians(KEPT_DEG))
#: Where the director's eye stands in the frame of its camera, which looks along x.
TOUR_EYE = np.array([-1.0, 0.0, 0.0]) / np.sin(np.radians(KEPT_DEG))
#: What only other views show.
_NOT_CHASE = (
    "campaign",
    "path",
    "markers",
    "labels",
    "drop_line",
    "ground_track",
    "near",
    "vehicle/attitude_frame",
)
#: What belongs to one camera alone.
_OWN = ("camera/scale_bar",)
_NOT_SITE = ("near", "vehicle/attitude_frame", "path", "markers", "labels", *_OWN)
_NOT_AFAR = ("vehicle/failed", "near", "vehicle/attitude_frame", "sky", "labels", *_OWN)


#: Labels of the states of each lane, in their order, by page and lane.
Labels = dict[str, dict[str, list[str]]]


class Shown(NamedTuple):
    """What the arrangement depends on.

    Attributes:
        span: first and last time, s, of the whole flight.
        when: time, s, of the events.
        start, end: first and last place, m in L.
        deploy: place of the parachute deployment, m in L, if any.
        plots: entities of the plots that have data.
        groups: thruster groups.
        jets: names of the thrusters.
        scanned: place from which the ground was scanned, m in L, if any.
        instruments: names of the instruments that navigation has, by kind.
        lanes: labels that have room in the lanes of each page.
        labels: names of the flights in the recording; one, and empty, where there is one flight.
        size: of the vehicle, m.
        scales: what 1 m of the arrows stands for.
        ranges: first and last value on the axis of each plot, by page and entity.
        ensemble: whether a campaign's trajectories are in it.
        globe_eye, globe_target: whence and whither the globe is seen, km in F.
    """

    span: tuple[float, float]
    when: dict[str, float]
    start: np.ndarray
    end: np.ndarray
    deploy: np.ndarray | None
    plots: frozenset[str]
    groups: tuple[str, ...]
    jets: tuple[str, ...]
    instruments: dict[str, list[str]]
    lanes: Labels
    scanned: np.ndarray | None
    labels: tuple[str, ...]
    size: float
    scales: str
    ranges: dict[tuple[str, str], tuple[float, float]]
    ensemble: bool
    globe_eye: np.ndarray
    globe_target: np.ndarray


def window(rrb: ModuleType, seconds: float) -> rrb.VisibleTimeRanges:
    """Rows of the last seconds before the cursor."""
    edge = rrb.TimeRangeBoundary.cursor_relative
    return rrb.VisibleTimeRanges(rrb.VisibleTimeRange(TIMELINE, start=edge(seconds=-seconds), end=edge()))


class Views:
    """Builds the views of the scene of one recording."""

    def __init__(self, flown: Shown) -> None:
        import rerun.blueprint as rrb

        self.rrb, self.flown = rrb, flown

    def roots(self) -> list[str]:
        """Entities below which each flight's own things lie."""
        return [root_of(k) for k in range(len(self.flown.labels))]

    def _scene(
        self, name: str, origin: str, contents: Sequence[str], place: Any, target: Any, **more: Any
    ) -> rrb.Spatial3DView:
        """A view of some entities from one place to another."""
        rrb = self.rrb
        return rrb.Spatial3DView(
            origin=origin,
            contents=contents,
            name=name,
            background=rrb.Background(color=SPACE),
            line_grid=False,
            eye_controls=rrb.EyeControls3D(position=place, look_target=target, eye_up=(0.0, 0.0, 1.0)),
            **more,
        )

    def _view(
        self,
        name: str,
        origin: str,
        hidden: Sequence[str],
        place: np.ndarray,
        target: np.ndarray,
        labels: Sequence[str] = (),
        not_of_others: Sequence[str] = (),
    ) -> rrb.Spatial3DView:
        """The site without what is hidden, of every flight or of all others."""
        excluded = [f"- {root}/{part}/**" for root in self.roots() for part in hidden]
        others = [root for root in self.roots() if f"{root}/{origin.rpartition('/')[2]}" != origin]
        excluded += [f"- {root}/{part}/**" for root in others for part in not_of_others]
        excluded += [f"/site/labels/{name}" for name in labels]
        trails = {f"{root}/trail": window(self.rrb, TRAIL_S) for root in self.roots()}
        return self._scene(name, origin, ["/site/**", *excluded], place, target, overrides=trails)

    def chase(self) -> rrb.Spatial3DView | rrb.Grid:
        """The vehicle with all that it hangs from, wherever it goes; side by side where there are several."""
        return self._each("camera", "Chase", _NOT_CHASE, EYE)

    def tour(self) -> rrb.Spatial3DView | rrb.Grid:
        """What the director shows; side by side where there are several flights."""
        return self._each("tour", "Tour", (*_NOT_CHASE, "trail", *_OWN), TOUR_EYE)

    def away(self) -> rrb.Spatial3DView:
        """What fell away last."""
        return self._view("What falls away", "/site/camera_away", (*_NOT_CHASE, *_OWN), EYE, np.zeros(3))

    def _each(
        self, camera: str, name: str, hidden: Sequence[str], eye: np.ndarray
    ) -> rrb.Spatial3DView | rrb.Grid:
        """A view from the same camera of each flight."""
        views = [
            self._view(
                f"{name}: {label}" if label else name,
                f"{root}/{camera}",
                hidden,
                eye,
                np.zeros(3),
                not_of_others=(*_OWN, "camera/name"),
            )
            for root, label in zip(self.roots(), self.flown.labels, strict=True)
        ]
        return views[0] if len(views) == 1 else self.rrb.Grid(*views, name=name)

    def body(self) -> rrb.Spatial3DView:
        """The vehicle with its frames and forces."""
        name = f"Body and forces: {self.flown.scales}" if self.flown.scales else "Body and frames"
        place = body_eye(self.flown.start, self.flown.end, self.flown.size)
        return self._scene(name, "/site/near", ["/site/vehicle/**", "/site/near/**"], place, np.zeros(3))

    def whole(self) -> rrb.Spatial3DView:
        """The whole flight from the side, a little from above."""
        return self._aside("Whole flight", self.flown.start, 0.62, 0.20, 0.02)

    def afar(self, name: str) -> rrb.Spatial3DView | None:
        """From parachute to ground, from the side."""
        return None if self.flown.deploy is None else self._aside(name, self.flown.deploy, 1.25, 0.12, 0.03)

    def _aside(
        self, name: str, start: np.ndarray, off: float, above: float, below: float
    ) -> rrb.Spatial3DView:
        """The way from ``start`` to the end from its side: how far from its middle and above it the eye
        stands, and how far below it looks, in lengths of the way.
        """
        along, length, side = _beside(start, self.flown.end)
        middle, up = start + 0.5 * along, np.array([0.0, 0.0, length])
        place, target = middle - off * length * side + above * up, middle - below * up
        return self._view(name, "/site", _NOT_AFAR, place, target, ["target"])

    def landing(self) -> rrb.Spatial3DView:
        """The last kilometre, from the side."""
        place, target = self.flown.end + [700.0, 500.0, 420.0], self.flown.end + [0.0, 0.0, 330.0]
        return self._view("Landing", "/site", _NOT_AFAR, place, target, ["**"])

    def site(self) -> rrb.Spatial3DView:
        """The vehicle where it stands in the end."""
        end = self.flown.end
        return self._view("Site", "/site", _NOT_SITE, end + [16.0, -26.0, 9.0], end)

    def above(self, scanned: np.ndarray) -> rrb.Spatial3DView:
        """The ground below the hover, north up."""
        place, target = scanned - [0.0, 20.0, 20.0], scanned - [0.0, 0.0, 100.0]
        hidden = (*_NOT_SITE, "drop_line", "trail", "sky")
        return self._view("Hazards from above", "/site", hidden, place, target)

    def globe(self) -> rrb.Spatial3DView:
        """The planet."""
        return self._scene("Globe", "/globe", ["$origin/**"], self.flown.globe_eye, self.flown.globe_target)


def root_of(number: int) -> str:
    """Entity under which lies what belongs to one flight of a recording alone."""
    return f"/site/flight_{number}" if number else "/site"


def body_eye(start: np.ndarray, end: np.ndarray, size: float) -> np.ndarray:
    """Where the eye stands from a vehicle of this size (m) when it looks at its frames and forces, m in L."""
    along, length, side = _beside(start, end)
    return size * (0.84 * along / length - 2.4 * side + [0.0, 0.0, 0.78])


def _beside(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """From start to end, its length, and a level unit vector to its right."""
    along = end - start
    length = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    return along, length, side / (np.linalg.norm(side) or 1.0)
