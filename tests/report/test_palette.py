"""The palette, Okabe and Ito's: its colours stay apart for the colour-blind, on paper and on a dark page."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.page import TEMPLATE, drawing
from edl6dof.report.palette import (
    DARK,
    GREEN,
    INK,
    ORANGE,
    PAPER,
    PURPLE,
    ROUGH,
    SAFE,
    SEQUENTIAL,
    SERIES,
    SKY,
    STEEP,
    UNKNOWN,
    UNSEEN,
)

#: What each kind of eye sees of linear red, green and blue, which it lacks wholly.  Source: Machado, Oliveira
#: and Fernandes 2009.
EYES = {
    "protanopia": (
        (0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.01182, 0.04294, 0.968881),
    ),
}  # fmt: skip
#: Distances in CIELAB: 2.3 is just noticed; thin lines need several times as much.
APART = 15.0
#: Distance of the colours of a hazard map, which sun and slope make lighter and darker.
APART_ON_A_MAP = 20.0
CELL_CLASSES, FATES = (SAFE, UNSEEN, STEEP, ROUGH), (UNKNOWN, GREEN, SKY, ORANGE, PURPLE)


def linear(colour: str) -> np.ndarray:
    share = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIELAB of linear sRGB under D65."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    share = to_xyz @ np.clip(rgb, 0.0, 1.0) / (0.95047, 1.0, 1.08883)
    f = np.where(share > 216 / 24389, np.cbrt(share), (24389 / 27 * share + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def contrast(one: str, two: str) -> float:
    """Ratio of luminances.  Source: WCAG 2.1."""
    low, high = sorted(linear(colour) @ (0.2126, 0.7152, 0.0722) for colour in (one, two))
    return (high + 0.05) / (low + 0.05)


def nearest(colours, eye: str) -> float:
    seen = [lab(np.array(EYES[eye]) @ linear(colour)) for colour in colours]
    return min(float(np.linalg.norm(a - b)) for a, b in combinations(seen, 2))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize(
    "colours", [SERIES, CELL_CLASSES, FATES], ids=["series", "classes", "fates of faults"]
)
def test_colours_stay_apart_for_the_colour_blind(colours, eye):
    assert nearest(colours, eye) > APART
    assert nearest([DARK[colour] for colour in colours], eye) > APART


@pytest.mark.parametrize("eye", EYES)
def test_classes_of_a_hazard_map_stay_apart_in_sun_and_shade(eye):
    assert nearest(CELL_CLASSES, eye) > APART_ON_A_MAP
    assert nearest([DARK[colour] for colour in CELL_CLASSES], eye) > APART_ON_A_MAP


def test_red_beside_green_is_found_too_near():
    assert nearest(["#c00000", "#3f7d00"], "deuteranopia") < APART


@pytest.mark.parametrize(
    "scale", [SEQUENTIAL, [DARK[colour] for colour in SEQUENTIAL]], ids=["paper", "dark"]
)
def test_scale_tells_its_order_by_lightness_alone(scale):
    lightness = [lab(linear(colour))[0] for colour in scale]
    steps = np.diff(lightness)
    assert np.all(np.abs(steps) > 7.0) and len(set(np.sign(steps))) == 1


def test_dark_lines_and_words_are_seen_on_their_ground():
    ground = DARK[PAPER]
    assert contrast(DARK[INK], ground) > 7.0
    assert min(contrast(DARK[colour], ground) for colour in SERIES) > 4.5


def test_every_colour_of_a_drawing_has_one_on_a_dark_page(run):
    def colours(value):
        if isinstance(value, dict):
            value = list(value.values())
        if isinstance(value, list):
            return {colour for item in value for colour in colours(item)}
        return {value[:7]} if isinstance(value, str) and value.startswith("#") else set()

    drawings = [drawing(figure) for figure in flight_report(run).figures()]
    found = colours([TEMPLATE, *drawings])
    assert len(found) > 15 and found <= DARK.keys()
