"""The pages of a replay: plots, lanes and time of each; names, colours and eyes that its writers share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.report import catalogue as p
from edl6dof.report.palette import BLACK, GREEN, GREY, ORANGE, PURPLE, SERIES, SKY, VERMILION, rgb

#: Colours of phases, in their order, and of several flights in a recording.
PHASES = tuple(rgb(colour) for colour in (*SERIES, GREY))
FLIGHTS = tuple(rgb(colour) for colour in (BLACK, VERMILION, SKY, GREEN, ORANGE, PURPLE))
#: The pages of a campaign, of powered descent, of the choice of a spot, of flights that navigate with
#: instruments, of the thrusters, and of the scripted camera.
CAMPAIGN, POWERED, HAZARDS, NAVIGATION, THRUSTERS, TOUR = (
    "Campaign", "Powered descent", "Hazards", "Navigation", "Thrusters", "Tour",
)  # fmt: skip
#: All pages, in their order.
TITLES = (CAMPAIGN, "Flight", "Entry", "Parachute", POWERED, HAZARDS, "Control", NAVIGATION, THRUSTERS, TOUR)
_PLOTS: dict[str, tuple[p.Plot, ...]] = {
    "Flight": (p.ALTITUDE, p.SPEED, p.LOAD, p.PROPELLANT),
    "Entry": (p.BANK, p.ALPHA, p.DRAG, p.BETA, p.RANGE, p.CROSSRANGE, p.MACH, p.HEAT, p.PRESSURE),
    "Parachute": (p.ALTITUDE, p.MACH, p.TENSION, p.PRESSURE, p.TOTAL_ALPHA, p.RATES),
    POWERED: (p.HEIGHT, p.VELOCITY, p.THRUST, p.TILT, p.OFFSET, p.PROPELLANT, p.TO_GO, p.MASS),
    "Control": (p.ERROR, p.RATES, *p.TORQUES, p.FORCE, *p.DEMAND),
    NAVIGATION: (
        *(p.POSITION_ERROR, p.VELOCITY_ERROR, p.ATTITUDE_ERROR, p.INNOVATION, p.HEIGHT_ERROR),
        *p.VELOCITY_ERROR.apart("backshell"),
    ),
    THRUSTERS: (p.DIAGNOSIS,),
}
#: Plots by page, in the units of readout and events.
PAGES = {page: tuple(plot._replace(kilo=False) for plot in plots) for page, plots in _PLOTS.items()}
#: Pages of a vehicle with thrusters.
OF_JETS = ("Control", THRUSTERS)
#: Pages of fast processes, and the time (s) before and after the present that their plots and lanes show: on
#: page Thrusters so short that every pulse is seen.
AROUND_NOW = {"Control": 60.0, NAVIGATION: 60.0, THRUSTERS: 5.0}
#: Shares of a page's views from left to right; the plots are the last of them, or on page Thrusters below.
SHARES = {
    "Flight": (9, 5, 10), "Entry": (5, 8), "Parachute": (11, 8), POWERED: (5, 8), "Control": (2, 5),
    NAVIGATION: (4, 9), THRUSTERS: (1, 1), CAMPAIGN: (8, 9, 8),
}  # fmt: skip
#: Lanes of every page.
PHASE, VEHICLE, ENGINE = "Phase", "Vehicle", "Engine"
#: Titles of the lanes of instruments by kind.
INSTRUMENTS = {"gyro": "Gyros", "accelerometer": "Accelerometers", "beam": "Radar beams"}
TIMELINE = "time"
#: The viewer's field of view from top to bottom, deg.
FIELD_DEG = 55.0
#: Half the angle (deg) that the sphere which a camera follows fills: less than half the field, so that the
#: sphere also fits into a view that is narrower than high.
KEPT_DEG = 20.0
#: Where the eye stands in a camera's frame, whose unit is the sphere's radius: beside, a little above.
EYE = np.array([2.6, 9.2, 2.6]) / np.linalg.norm([2.6, 9.2, 2.6]) / np.sin(np.radians(KEPT_DEG))
#: Where the director's eye stands in the frame of its camera, which looks along x.
TOUR_EYE = np.array([-1.0, 0.0, 0.0]) / np.sin(np.radians(KEPT_DEG))
#: Labels of the states of each lane, in their order, by page and lane.
Labels = dict[str, dict[str, list[str]]]


def lane_of(kind: str, name: str) -> str:
    """Return the entity of the lane of a thruster or an instrument."""
    return f"/{kind.capitalize()}-{name}"


def plot_columns(page: str, count: int) -> int:
    """Return the number of columns in which a page shows ``count`` plots."""
    return 1 if page in ("Flight", THRUSTERS) else 3 if count > 8 else 2


def spans_of(flown_s: tuple[float, float], when: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Return first and last time (s) of the pages that show a part of the flight, if it has this part."""
    first, last = flown_s
    mortar, shell = when.get("mortar", last), when.get("backshell", last)
    spans = {"Entry": (first, min(mortar + 3.0, last))}
    if "mortar" in when:
        spans["Parachute"] = (min(mortar, last - 1.0) - 3.0, min(shell + 3.0, last))
    if "backshell" in when:
        spans[POWERED] = (min(shell - 5.0, last - 1.0), last)
    return spans


def root_of(number: int) -> str:
    """Return the entity above everything that belongs to one flight of a recording only."""
    return f"/site/flight_{number}" if number else "/site"


def body_eye(start: np.ndarray, end: np.ndarray, size: float) -> np.ndarray:
    """Return the place of the eye (m in L) that looks at frames and forces of a vehicle of this size (m)."""
    along, length, side = course(start, end)
    return size * (0.84 * along / length - 2.4 * side + [0.0, 0.0, 0.78])


def course(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """Return the vector from start to end, its length (m), and a level unit vector to its right."""
    along = end - start
    length = float(np.linalg.norm(along)) or 1.0
    side = np.array([along[1], -along[0], 0.0])
    return along, length, side / (np.linalg.norm(side) or 1.0)
