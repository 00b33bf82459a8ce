"""Navigation: the error of the estimate beside the bounds that the flight software claims for it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.figure import BLUE, GREEN, GREY, ORANGE, Figure
from edl6dof.report.flight.parts import Curve, has_signal, over_time, stacked
from edl6dof.runs.run import Run

#: Claimed standard deviations that the bounds stand at.
BOUND = 3.0
_AXES = ("north", "east", "down")


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section; none where navigation takes the word of ideal instruments."""
    if not has_signal(run, "nav.sigma_down_m"):
        return
    every, late = run.between(until="touchdown"), run.between("backshell", "touchdown")
    yield errors(run, every, "nav_position", "Error of position", "error", "m", "m")
    yield errors(run, every, "nav_velocity", "Error of velocity", "error_v", "m_s", "m/s")
    yield errors(run, every, "nav_attitude", "Error of attitude", "error_attitude", "deg", "deg")
    if np.any(late):
        yield errors(run, late, "nav_landing", "Error of velocity under power", "error_v", "m_s", "m/s")
    yield heights(run, late if np.any(late) else every)
    yield instruments(run, every)


def with_bounds(error: str, sigma: str) -> list[Curve]:
    """An error and the bounds of ``BOUND`` claimed standard deviations."""
    return [
        Curve(error, "error", colour=BLUE),
        Curve(sigma, f"{BOUND:.0f} σ claimed", BOUND, GREY, "dash"),
        Curve(sigma, "", -BOUND, GREY, "dash"),
    ]


def errors(run: Run, rows: np.ndarray, key: str, title: str, stem: str, suffix: str, unit: str) -> Figure:
    """Errors along north, east and down."""
    claimed = stem.replace("error", "sigma")
    panels = [
        over_time(
            run,
            f"{axis} ({unit})",
            with_bounds(f"nav.{stem}_{axis}_{suffix}", f"nav.{claimed}_{axis}_{suffix}"),
            rows,
        )
        for axis in _AXES
    ]
    return stacked(key, title, panels, "Estimated less true, in the axes of the true place.", 150)


def heights(run: Run, rows: np.ndarray) -> Figure:
    """Error of the height above the ground, and how far the radar's beams were from what was expected."""
    panels = [
        over_time(run, "height (m)", with_bounds("nav.error_height_m", "nav.sigma_height_m"), rows),
        over_time(
            run,
            "largest innovation (σ)",
            [
                Curve("nav.range_innovation", "range", colour=GREEN),
                Curve("nav.speed_innovation", "speed", colour=ORANGE),
            ],
            rows,
        ),
    ]
    caption = "Height above the ground, and the innovation of the beam farthest from what was expected."
    return stacked("nav_height", "Height and radar", panels, caption, 170)


def instruments(run: Run, rows: np.ndarray) -> Figure:
    """Instruments not excluded, as the number that their bits make, and beams that the filter used."""
    panels = [
        over_time(run, title, [Curve(channel, "", colour=BLUE)], rows)
        for title, channel in (
            ("gyros", "nav.gyros_in_use"),
            ("accelerometers", "nav.accelerometers_in_use"),
            ("beams used", "nav.beams_used"),
        )
        if has_signal(run, channel, rows)
    ]
    caption = "Instruments in use: the sum of 2 to the power of their numbers."
    return stacked("nav_instruments", "Instruments", panels, caption, 110)
