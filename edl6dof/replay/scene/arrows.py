"""Arrows at the vehicle: velocity, lift, thrust, disturbance torque; the attitude and velocity frames; and
their names, off the vehicle and off each other as seen from a fixed side.

A label keeps its size on the screen, so its box in metres follows from the least height of a view.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.replay.history import History, thin, vector
from edl6dof.replay.pages import FIELD_DEG, body_eye
from edl6dof.replay.recorder import SCALAR_HZ, SLOW_HZ, Recorder, and_next
from edl6dof.replay.scene.mesh import RGB
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

VELOCITY, LIFT, THRUST, TORQUE = (110, 230, 240), (130, 235, 120), (255, 190, 90), (240, 110, 220)
#: Colours of the axes x, y, z, as the viewer draws them.
AXES: tuple[RGB, ...] = ((255, 110, 110), (120, 230, 120), (130, 150, 255))
#: Lengths of the axes of the body and of the velocity frame, of the longest arrow, and where the arrow of the
#: velocity begins and how long it is, in the vehicle's diameters.
BODY_AXES, VELOCITY_AXES, LONGEST, AHEAD, WAY = 0.6, 0.85, 0.9, 0.42, 0.62
#: Radius of the disc that the vehicle covers, in its diameters.
COVERED = 0.55
#: Share of the time in which an arrow has at most the longest length: a shock may exceed it.
USUAL = 0.99
#: Shortest arrow that is drawn, in the vehicle's diameters.
LEAST = 0.006
#: Share of the aerodynamic force below which lift counts as zero, as that of a sphere.
_NO_LIFT = 1e-3
#: Least height of a view for which the boxes are laid out, px.
VIEW_PX = 300.0
#: A label's height, the width of a letter, what is added on both sides of a text, and how far below its place
#: the middle of its box stands, px.
HEIGHT_PX, LETTER_PX, MARGIN_PX, BELOW_PX = 22.0, 6.6, 10.0, 12.0
#: By how much (share of the craft's radius) a label is moved outwards at a time, and how often at most.
STEP, MOST_STEPS = 0.12, 24


class Arrow(NamedTuple):
    """An arrow: values in L, shape (rows, 3), rows in which it is shown, and value that 1 m stands for."""

    name: str
    colour: RGB
    values: np.ndarray
    shown: np.ndarray
    unit: str
    metre: float


class Arrows(Recorder):
    """Writes ``near/arrows`` and ``near/velocity_frame`` (in L), and ``vehicle/attitude_frame``."""

    def motions(self) -> None:
        """Write velocity ahead of the vehicle, forces from its centre of mass, and names beyond the ends."""
        motion, rows = self.motion, thin(self.t, SCALAR_HZ)
        if len(rows) < 3:
            return
        (way, speed), size = _way(motion, rows), motion.shape.size
        velocity = Arrow("velocity", VELOCITY, way * speed, speed[:, 0] > 0.5, "m/s", 0.0)
        drawn = [(velocity, AHEAD * size * way, WAY * size * way)]
        others = forces(self.flight, motion, rows)
        drawn += [(arrow, np.zeros_like(way), arrow.values / arrow.metre) for arrow in others]
        few = slice(None, None, round(SCALAR_HZ / SLOW_HZ))  # nobody reads faster
        plane, read = screen(body_eye(motion.centre[0], motion.last, size)), rows[few]
        names: list[tuple[Label, list[str], RGB]] = []
        for arrow, start, ahead in drawn:
            length = np.linalg.norm(ahead, axis=-1)
            shown = arrow.shown & np.isfinite(length) & (length > LEAST * size)
            self._arrow(arrow, rows, start, ahead, shown)
            values = np.nan_to_num(np.linalg.norm(arrow.values[few], axis=-1)).tolist()
            texts = [f"{arrow.name} {_amount(value, arrow.unit)}" for value in values]
            label = Label(plane.seen((start + ahead)[few]), shown[few], max(map(len, texts)), True)
            names.append((label, texts, arrow.colour))
        for (name, end), colour in zip(self._frames(rows, way).items(), AXES * 2, strict=True):
            label = Label(plane.seen(end[few]), np.ones(len(read), bool), len(name), False)
            names.append((label, [name] * len(read), colour))
        self._names(read, plane, names)

    def _arrow(
        self, arrow: Arrow, rows: np.ndarray, start: np.ndarray, vectors: np.ndarray, shown: np.ndarray
    ) -> None:
        """Log one arrow where ``shown``, from the centre of mass plus ``start``."""
        if shown.any():
            keep, entity = and_next(shown), f"{self.root}/near/arrows/{arrow.name.replace(' ', '_')}"
            look = {"colors": arrow.colour, "radii": 0.011 * self.motion.shape.size}
            data, each = {"origins": start[shown], "vectors": vectors[shown]}, shown[keep].astype(int)
            self.series(entity, self.t[rows[keep]], self.rr.Arrows3D, look, data, each)

    def _frames(self, rows: np.ndarray, way: np.ndarray) -> dict[str, np.ndarray]:
        """Log body axes B at the centre of mass, and the velocity frame: x along the velocity, z down in its
        vertical plane.

        Returns:
            ends of the axes from the centre of mass, m in L, shape (rows, 3), by their names.
        """
        rr, motion, size = self.rr, self.motion, self.motion.shape.size
        down = -(motion.centre[rows] + motion.site.axes @ motion.site.origin)
        right = np.cross(down, way)
        right /= np.maximum(np.linalg.norm(right, axis=-1, keepdims=True), 1e-9)
        axes = np.stack([way, right, np.cross(way, right)], axis=-1)
        steep = np.abs(np.linalg.det(axes)) < 0.5  # at rest, or falling straight down
        axes[steep] = np.eye(3)
        self.static(f"{self.root}/near/velocity_frame", rr.TransformAxes3D(axis_length=VELOCITY_AXES * size))
        self.poses(f"{self.root}/near/velocity_frame", self.t[rows], turn=turns.from_axes(axes))
        middle = rr.Transform3D(translation=[self.flight[f"truth.centre_{axis}_m"][0] for axis in "xyz"])
        entity = f"{self.root}/vehicle/attitude_frame"
        self.static(entity, middle, rr.TransformAxes3D(axis_length=BODY_AXES * size))
        body = BODY_AXES * size * np.eye(3)
        ends = {f"{name}B": turns.rotate(motion.rotation[rows], body[k]) for k, name in enumerate("xyz")}
        return ends | {f"{name}V": VELOCITY_AXES * size * axes[:, :, k] for k, name in enumerate("xyz")}

    def _names(self, rows: np.ndarray, plane: Screen, names: list[tuple[Label, list[str], RGB]]) -> None:
        """Log labels with their texts at each row, and their colours, where they have room."""
        labels, texts, colours = zip(*names, strict=True)
        places, there = laid_out(plane, COVERED * self.motion.shape.size, list(labels))
        when, which = np.nonzero(there.T)
        data = {
            "positions": plane.placed(places[which, when]),
            "labels": [texts[k][row] for row, k in zip(when.tolist(), which.tolist(), strict=True)],
            "colors": np.array(colours, np.uint8)[which],
        }
        entity, look = f"{self.root}/near/arrows/names", {"radii": -0.01, "show_labels": True}
        self.series(entity, self.t[rows], self.rr.Points3D, look, data, there.sum(axis=0))


def forces(flight: History, motion: Motion, rows: np.ndarray) -> list[Arrow]:
    """Return the arrows of lift, thrust (N) and disturbance torque (N m) at some rows, if ever not zero."""
    columns, turn = flight.columns, motion.rotation[rows]
    way = _way(motion, rows)[0]
    force = turns.rotate(turn, vector(columns, "truth.aero_force", "x y z", "_n")[rows])
    lift = force - (force * way).sum(axis=-1, keepdims=True) * way
    lifting = np.linalg.norm(lift, axis=-1) > _NO_LIFT * np.linalg.norm(force, axis=-1)
    thrust, ahead = flight["truth.engine_thrust_n"][rows], turns.rotate(turn, np.array([1.0, 0.0, 0.0]))
    torque = turns.rotate(turn, vector(columns, "truth.disturbance", "x y z", "_nm")[rows])
    found = (
        ("lift", LIFT, lift, lifting & (flight.t[rows] < flight.when.get("mortar", np.inf)), "N"),
        ("thrust", THRUST, -thrust[:, None] * ahead, thrust > 1.0, "N"),
        ("disturbance", TORQUE, torque, ~np.isfinite(motion.canopy[rows, 0]), "N m"),
    )
    size = motion.shape.size
    arrows = []
    for name, colour, values, shown, unit in found:
        length = np.linalg.norm(np.nan_to_num(values[shown]), axis=-1)
        if length.any():
            largest = float(np.quantile(length[length > 0.0], USUAL))
            arrows.append(Arrow(name, colour, values, shown, unit, _round_up(largest / (LONGEST * size))))
    return arrows


def scales(flight: History, motion: Motion) -> str:
    """Return the value that 1 m of each arrow stands for, as text."""
    rows = thin(flight.t, SCALAR_HZ)
    by_scale: dict[str, list[str]] = {}
    for arrow in forces(flight, motion, rows):
        by_scale.setdefault(_amount(arrow.metre, arrow.unit), []).append(arrow.name)
    texts = [f"{scale} ({', '.join(names)})" for scale, names in by_scale.items()]
    return f"1 m = {', '.join(texts)}" if texts else ""


def _way(motion: Motion, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Direction of the velocity over ground, shape (rows, 3), and speed (m/s), shape (rows, 1)."""
    way = np.gradient(motion.centre[rows], motion.t[rows], axis=0)
    speed = np.linalg.norm(way, axis=-1, keepdims=True)
    return way / np.maximum(speed, 1e-9), speed


def _round_up(value: float) -> float:
    """The next of 1, 2, 5, 10, ..."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * next(digit for digit in (1.0, 2.0, 5.0, 10.0) if digit * power >= 0.999999 * value))


def _amount(value: float, unit: str) -> str:
    """A value with its unit, in thousands from 1000 unless it is a speed."""
    if value < 1000.0:
        return f"{value:,.3g} {unit}"
    return f"{value:,.0f} {unit}" if unit == "m/s" else f"{value / 1000.0:,.3g} k{unit}"


class Screen(NamedTuple):
    """The plane through the vehicle, square to the line of sight, and how it is seen.

    Attributes:
        eye: place of the eye from the vehicle, m.
        right, up: unit vectors of the plane.
        metres_per_px: metres per pixel in a view of the least height.
    """

    eye: np.ndarray
    right: np.ndarray
    up: np.ndarray
    metres_per_px: float

    def seen(self, places: np.ndarray) -> np.ndarray:
        """Project places, shape (..., 3), as seen from the eye onto the plane, shape (..., 2), both m."""
        distance = np.linalg.norm(self.eye)
        depth = np.maximum(distance - places @ self.eye / distance, 0.1 * distance)
        flat = np.stack([places @ self.right, places @ self.up], axis=-1)
        return flat * (distance / depth)[..., None]

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Return points of the plane (m, shape (..., 2)) as places, m from the vehicle, shape (..., 3)."""
        return points[..., :1] * self.right + points[..., 1:] * self.up

    def box(self, letters: int) -> np.ndarray:
        """Return half width and half height (m) of a label's box."""
        width = LETTER_PX * letters + 2.0 * MARGIN_PX
        return 0.5 * self.metres_per_px * np.array([width, HEIGHT_PX])

    @property
    def below(self) -> np.ndarray:
        """Vector from a label's place to the middle of its box, m on the plane."""
        return np.array([0.0, -BELOW_PX * self.metres_per_px])


class Label(NamedTuple):
    """A label at each row: end of its arrow (m on the plane), shape (rows, 2); rows in which it is wanted;
    greatest number of letters; and whether it may move outwards, or is left out instead.
    """

    end: np.ndarray
    wanted: np.ndarray
    letters: int
    moves: bool


def screen(eye: np.ndarray) -> Screen:
    """Return the plane as seen from ``eye`` (m from the vehicle), z up."""
    distance = float(np.linalg.norm(eye))
    right = np.cross(-eye, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, -eye) / distance
    return Screen(eye, right, up, 2.0 * distance * np.tan(np.radians(0.5 * FIELD_DEG)) / VIEW_PX)


def laid_out(plane: Screen, craft: float, labels: list[Label]) -> tuple[np.ndarray, np.ndarray]:
    """Place labels, earlier ones first, none on the craft (a disc of radius ``craft``, m) or on another.

    Returns:
        places (m on the plane), shape (labels, rows, 2), and which are shown, shape (labels, rows).
    """
    rows = len(labels[0].end)
    places, shown = np.zeros((len(labels), rows, 2)), np.zeros((len(labels), rows), bool)
    boxes = [plane.box(label.letters) for label in labels]
    for k, label in enumerate(labels):
        size = np.linalg.norm(label.end, axis=-1, keepdims=True)
        way = np.where(size > 1e-3 * craft, label.end / np.maximum(size, 1e-9), [0.0, 1.0])
        # distance from the end to the box's middle: the box's extent in that direction
        beyond = np.min(boxes[k] / np.maximum(np.abs(way), 1e-3), axis=-1, keepdims=True)
        # boxes are wider than high: they pass each other above and below
        aside = np.where(way >= 0.0, 1.0, -1.0) * np.maximum(np.abs(way) * [0.4, 1.0], [0.0, 0.6])
        open_ = label.wanted.copy()
        for step in range(MOST_STEPS if label.moves else 1):
            here = label.end + beyond * way + step * STEP * craft * aside
            clear = open_ & _off_craft(here + plane.below, boxes[k], craft)
            for other in range(k):
                apart = np.abs(here - places[other]) >= boxes[k] + boxes[other]
                clear &= apart.any(axis=-1) | ~shown[other]
            places[k][clear], shown[k][clear] = here[clear], True
            open_ &= ~clear
    return places, shown


def _off_craft(middle: np.ndarray, box: np.ndarray, craft: float) -> np.ndarray:
    """True if a box does not touch the disc."""
    nearest = np.maximum(np.abs(middle) - box, 0.0)
    return np.linalg.norm(nearest, axis=-1) >= craft
