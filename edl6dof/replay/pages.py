"""The pages of a replay: plots, lanes and time of each, and the views of the 3D scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.report import catalogue as p
from edl6dof.report.palette import BLACK, GREEN, GREY, ORANGE, PURPLE, SERIES, SKY, VERMILION, rgb

if TYPE_CHECKING:
    import rerun.blueprint as rrb

    from edl6dof.replay.scene.poses import Motion

#: Colours of phases, in their order, and of several flights in a recording.
PHASES = tuple(rgb(colour) for colour in (*SERIES, GREY))
FLIGHTS = tuple(rgb(colour) for colour in (BLACK, VERMILION, SKY, GREEN, ORANGE, PURPLE))
#: Titles of the thruster plots by group.
GROUPS = {"horizontal": "Horizontal", "axial": "Axial", "attitude": "Attitude", "fine": "Fine"}
#: The pages of powered descent, of the choice of a spot, of flights that navigate with instruments, of the
#: thrusters, and of the scripted camera.
POWERED, HAZARDS, NAVIGATION, THRUSTERS, TOUR = (
    "Powered descent", "Hazards", "Navigation", "Thrusters", "Tour",
)  # fmt: skip
#: All pages, in their order.
TITLES = ("Flight", "Entry", "Parachute", POWERED, HAZARDS, "Control", NAVIGATION, THRUSTERS, TOUR)
#: Plots by page.
PAGES: dict[str, tuple[p.Plot, ...]] = {
    "Flight": (p.ALTITUDE, p.SPEED, p.LOAD, p.PROPELLANT),
    "Entry": (p.BANK, p.ALPHA, p.DRAG, p.BETA, p.RANGE, p.CROSSRANGE, p.MACH, p.HEAT, p.PRESSURE),
    "Parachute": (p.ALTITUDE, p.MACH, p.TENSION, p.PRESSURE, p.TOTAL_ALPHA, p.RATES),
    POWERED: (p.HEIGHT, p.VELOCITY, p.THRUST, p.TILT, p.OFFSET, p.PROPELLANT, p.TO_GO, p.MASS),
    "Control": (p.ERROR, p.RATES, *p.TORQUES, p.FORCE, *p.DEMAND),
    NAVIGATION: (
        *(p.POSITION_ERROR, p.VELOCITY_ERROR, p.ATTITUDE_ERROR, p.INNOVATION, p.HEIGHT_ERROR),
        *p.VELOCITY_ERROR.apart("backshell"),
    ),
    THRUSTERS: (p.DIAGNOSIS, p.PROPELLANT),
}
#: Pages of a vehicle with thrusters.
OF_JETS = ("Control", THRUSTERS)
#: Pages that show fast things: their plots end so long (s) before and after the present.
AROUND_NOW, NEAR_S = ("Control", NAVIGATION, THRUSTERS), 60.0
#: Lanes of every page.
PHASE, VEHICLE, ENGINE = "Phase", "Vehicle", "Engine"
#: Titles of the lanes of instruments by kind.
INSTRUMENTS = {"gyro": "Gyros", "accelerometer": "Accelerometers", "beam": "Radar beams"}
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
_FRAMES = ("near", "vehicle/attitude_frame")
_NOT_CHASE = ("campaign", "path", "markers", "labels", "drop_line", "ground_track", *_FRAMES)
#: What belongs to one camera alone.
_OWN = ("camera/scale_bar",)
_NOT_SITE = (*_FRAMES, "path", "markers", "labels", *_OWN)
_NOT_AFAR = ("vehicle/failed", *_FRAMES, "sky", "labels", *_OWN)
#: Labels of the states of each lane, in their order, by page and lane.
Labels = dict[str, dict[str, list[str]]]


def lane_of(kind: str, name: str) -> str:
    """Return the entity of the lane of a thruster or an instrument."""
    return f"/{kind.capitalize()}-{name}"


def spans_of(flown_s: tuple[float, float], when: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Return first and last time (s) of the pages that show a part of the flight that it has."""
    first, last = flown_s
    mortar, shell = when.get("mortar", last), when.get("backshell", last)
    spans = {
        "Entry": (first, min(mortar + 3.0, last)),
        "Parachute": (min(mortar, last - 1.0) - 3.0, min(shell + 3.0, last)),
        POWERED: (min(shell - 5.0, last - 1.0), last),
    }
    begun = {"Entry": True, "Parachute": "mortar" in when, POWERED: "backshell" in when}
    return {page: span for page, span in spans.items() if begun[page]}


def window(rrb: ModuleType, seconds: float) -> rrb.VisibleTimeRanges:
    """Return the time range of the last seconds before the cursor."""
    edge = rrb.TimeRangeBoundary.cursor_relative
    return rrb.VisibleTimeRanges(rrb.VisibleTimeRange(TIMELINE, start=edge(seconds=-seconds), end=edge()))


class Views:
    """Builds the views of the scene of one recording, about the way of its first flight.

    Attributes:
        motion: of the first flight.
        labels: names of the flights in the recording; one, and empty, where there is one flight.
        scales: what 1 m of the arrows stands for.
        start, end, deploy: first and last place, and that of the parachute deployment if any, m in L.
        roots: entities below which each flight's own things lie.
    """

    def __init__(self, motion: Motion, labels: Sequence[str], scales: str) -> None:
        import rerun.blueprint as rrb

        self.rrb, self.motion, self.labels, self.scales = rrb, motion, labels, scales
        places = motion.centre if len(motion.t) else np.zeros((1, 3))
        self.start, self.end = places[0], places[-1]
        deploy = motion.released(motion.canopy)
        self.deploy = None if deploy is None else places[deploy]
        self.roots = [root_of(k) for k in range(len(labels))]

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
        """A view of the site without what is hidden, of every flight or of all others."""
        excluded = [f"- {root}/{part}/**" for root in self.roots for part in hidden]
        others = [root for root in self.roots if f"{root}/{origin.rpartition('/')[2]}" != origin]
        excluded += [f"- {root}/{part}/**" for root in others for part in not_of_others]
        excluded += [f"/site/labels/{name}" for name in labels]
        trails = {f"{root}/trail": window(self.rrb, TRAIL_S) for root in self.roots}
        return self._scene(name, origin, ["/site/**", *excluded], place, target, overrides=trails)

    def chase(self) -> rrb.Spatial3DView | rrb.Grid:
        """Return the vehicle with everything that it hangs from; side by side if there are several."""
        return self._each("camera", "Chase", _NOT_CHASE, EYE)

    def tour(self) -> rrb.Spatial3DView | rrb.Grid:
        """Return the director's picture; side by side if there are several flights."""
        return self._each("tour", "Tour", (*_NOT_CHASE, "trail", *_OWN), TOUR_EYE)

    def away(self) -> rrb.Spatial3DView:
        """Return the part released last."""
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
            for root, label in zip(self.roots, self.labels, strict=True)
        ]
        return views[0] if len(views) == 1 else self.rrb.Grid(*views, name=name)

    def body(self) -> rrb.Spatial3DView:
        """Return the vehicle with its frames and forces."""
        name = f"Body and forces: {self.scales}" if self.scales else "Body and frames"
        place = body_eye(self.start, self.end, self.motion.shape.size)
        return self._scene(name, "/site/near", ["/site/vehicle/**", "/site/near/**"], place, np.zeros(3))

    def whole(self) -> rrb.Spatial3DView:
        """Return the whole flight from the side, a little from above."""
        return self._aside("Whole flight", self.start, 0.62, 0.20, 0.02)

    def afar(self, name: str) -> rrb.Spatial3DView:
        """Return the flight from the parachute, if there is one, to the ground, from the side."""
        start = self.start if self.deploy is None else self.deploy
        return self._aside(name, start, 1.25, 0.12, 0.03)

    def _aside(
        self, name: str, start: np.ndarray, off: float, above: float, below: float
    ) -> rrb.Spatial3DView:
        """The path from ``start`` to the end from its side: distances of the eye from and above its middle,
        and of its target below it, in lengths of the path.
        """
        along, length, side = _course(start, self.end)
        middle, up = start + 0.5 * along, np.array([0.0, 0.0, length])
        place, target = middle - off * length * side + above * up, middle - below * up
        return self._view(name, "/site", _NOT_AFAR, place, target, ["target"])

    def landing(self) -> rrb.Spatial3DView:
        """Return the last kilometre, from the side."""
        place, target = self.end + [700.0, 500.0, 420.0], self.end + [0.0, 0.0, 330.0]
        return self._view("Landing", "/site", _NOT_AFAR, place, target, ["**"])

    def site(self) -> rrb.Spatial3DView:
        """Return the vehicle where it comes to rest."""
        end = self.end
        return self._view("Site", "/site", _NOT_SITE, end + [16.0, -26.0, 9.0], end)

    def above(self, scanned: np.ndarray) -> rrb.Spatial3DView:
        """Return the ground below the hover, north up."""
        place, target = scanned - [0.0, 20.0, 20.0], scanned - [0.0, 0.0, 100.0]
        hidden = (*_NOT_SITE, "drop_line", "trail", "sky")
        return self._view("Hazards from above", "/site", hidden, place, target)

    def globe(self) -> rrb.Spatial3DView:
        """Return the planet, from above the middle of the path; km in F."""
        middle = self.motion.site.in_F(0.5 * (self.start + self.end)) / 1e3
        return self._scene("Globe", "/globe", ["$origin/**"], 2.3 * middle, 0.0 * middle)


def root_of(number: int) -> str:
    """Return the entity above everything that belongs to one flight of a recording only."""
    return f"/site/flight_{number}" if number else "/site"


def body_eye(start: np.ndarray, end: np.ndarray, size: float) -> np.ndarray:
    """Return the place of the eye (m in L) that looks at frames and forces of a vehicle of this size (m)."""
    along, length, side = _course(start, end)
    return size * (0.84 * along / length - 2.4 * side + [0.0, 0.0, 0.78])


def _course(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """From start to end, its length, and a level unit vector to its right."""
    along = end - start
    length = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    return along, length, side / (np.linalg.norm(side) or 1.0)
