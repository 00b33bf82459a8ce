"""Where labels stand beside a vehicle that is seen from a fixed side: off the vehicle and off each other.

A label keeps its size on the screen, so its box in metres follows from the least height of a view.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.replay.views.spatial import FIELD_DEG

#: Least height of a view for which the boxes are laid out, px.
VIEW_PX = 300.0
#: A label's height, the width of a letter, what is added on both sides of a text, and how far below its place
#: the middle of its box stands, px.
HEIGHT_PX, LETTER_PX, MARGIN_PX, BELOW_PX = 22.0, 6.6, 10.0, 12.0
#: By how much (share of the craft's radius) a label is moved outwards at a time, and how often at most.
STEP, MOST_STEPS = 0.12, 24


class Screen(NamedTuple):
    """The plane through the vehicle, square to the line of sight, and how it is seen.

    Attributes:
        eye: place of the eye from the vehicle, m.
        right, up: unit vectors of the plane.
        metres_per_px: in a view of the least height.
    """

    eye: np.ndarray
    right: np.ndarray
    up: np.ndarray
    metres_per_px: float

    def seen(self, places: np.ndarray) -> np.ndarray:
        """Where places (m from the vehicle), shape (..., 3), appear on the plane, m, shape (..., 2)."""
        distance = np.linalg.norm(self.eye)
        depth = np.maximum(distance - places @ self.eye / distance, 0.1 * distance)
        flat = np.stack([places @ self.right, places @ self.up], axis=-1)
        return flat * (distance / depth)[..., None]

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Places on the plane, m from the vehicle, shape (..., 3)."""
        return points[..., :1] * self.right + points[..., 1:] * self.up

    def box(self, letters: int) -> np.ndarray:
        """Half width and half height (m) of a label's box."""
        width = LETTER_PX * letters + 2.0 * MARGIN_PX
        return 0.5 * self.metres_per_px * np.array([width, HEIGHT_PX])

    @property
    def below(self) -> np.ndarray:
        """From a label's place to the middle of its box, m."""
        return np.array([0.0, -BELOW_PX * self.metres_per_px])


class Label(NamedTuple):
    """A label at each row: where its arrow ends (m on the plane), shape (rows, 2); where it is wanted, shape
    (rows,); its greatest number of letters; and whether it may move outwards, or is left out instead.
    """

    end: np.ndarray
    wanted: np.ndarray
    letters: int
    moves: bool


def screen(eye: np.ndarray) -> Screen:
    """The plane as seen from ``eye`` (m from the vehicle), z up."""
    distance = float(np.linalg.norm(eye))
    right = np.cross(-eye, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, -eye) / distance
    return Screen(eye, right, up, 2.0 * distance * np.tan(np.radians(0.5 * FIELD_DEG)) / VIEW_PX)


def laid_out(plane: Screen, craft: float, labels: list[Label]) -> tuple[np.ndarray, np.ndarray]:
    """Places of labels, earlier ones first, none on the craft (a disc of radius ``craft``, m) or on another.

    Returns:
        places (m on the plane), shape (labels, rows, 2), and which are shown, shape (labels, rows).
    """
    rows = len(labels[0].end)
    places, shown = np.zeros((len(labels), rows, 2)), np.zeros((len(labels), rows), bool)
    boxes = [plane.box(label.letters) for label in labels]
    for k, label in enumerate(labels):
        size = np.linalg.norm(label.end, axis=-1, keepdims=True)
        way = np.where(size > 1e-3 * craft, label.end / np.maximum(size, 1e-9), [0.0, 1.0])
        # the middle of the box as far beyond the end as the box reaches that way
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
    """Whether a box stays off the disc."""
    nearest = np.maximum(np.abs(middle) - box, 0.0)
    return np.linalg.norm(nearest, axis=-1) >= craft
