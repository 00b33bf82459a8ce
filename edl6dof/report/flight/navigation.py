"""Navigation: the error of the estimate beside the bounds that the flight software claims for it.

Errors are hundreds of metres at entry and decimetres at touchdown: each stretch of the flight has a figure of
its own scale.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.document import Row, Table
from edl6dof.report.figure import BAD, BLUE, GREEN, GREY, ORANGE, Figure, Mark, Panel
from edl6dof.report.flight.parts import Curve, has_signal, over_time, stacked
from edl6dof.runs.run import Run

#: Claimed standard deviations that the bounds stand at.
BOUND = 3.0
#: Bounds are shown up to this many times the largest error, which would not be seen otherwise.
FAR = 30.0
#: Time before touchdown (s) that is shown by itself.
LAST_S = 40.0
AXES = ("north", "east", "down")
#: What is estimated: its name, unit, format, and the ends of its channels of error and sigma after the axis.
ESTIMATED = (
    ("position", "m", ",.1f", "", "_m"),
    ("velocity", "m/s", ".3f", "_v", "_m_s"),
    ("attitude", "deg", ".4f", "_attitude", "_deg"),
)
#: Moments of the table, by event.
MOMENTS = {"mortar": "mortar fire", "ignition": "ignition", "touchdown": "touchdown"}


def figures(run: Run) -> Iterator[Figure | Table]:
    """Figures of the section; none where navigation takes the word of ideal instruments."""
    if not has_signal(run, "nav.sigma_down_m"):
        return
    flown, seen = run.between(until="touchdown"), echoes(run)
    before = flown & ~(np.cumsum(seen) > 0)
    if any(key in run.when for key in MOMENTS):
        yield at_moments(run)
    yield errors(run, flown, "nav_position", "Error of position", "", "_m", "m")
    yield errors(
        run, before, "nav_velocity", "Error of velocity before the radar's first echo", "_v", "_m_s", "m/s"
    )
    yield errors(run, flown, "nav_attitude", "Error of attitude", "_attitude", "_deg", "deg")
    if np.any(flown & seen):
        yield landing(run, flown & run.between("ignition"), "nav_landing", "Height and velocity under power")
        yield innovations(run, flown, seen)
    if "touchdown" in run.when:
        last = flown & (run.t > run.when["touchdown"] - LAST_S)
        yield landing(run, last, "nav_touchdown", f"Height and velocity in the last {LAST_S:.0f} s")


def echoes(run: Run) -> np.ndarray:
    """Rows in which a beam of the radar has an echo, shape (rows,), bool."""
    ranges = [run[name] for name in run if name.startswith("range.")]
    return np.any(ranges, axis=0) if ranges else np.zeros(len(run.t), bool)


def at_moments(run: Run) -> Table:
    """Error and bound of everything that is estimated, at the moments that count."""
    reached = [key for key in MOMENTS if key in run.when]
    rows: list[Row] = []
    for name, unit, form, stem, suffix in ESTIMATED:
        for axis in AXES:
            channels = f"nav.error{stem}_{axis}{suffix}", f"nav.sigma{stem}_{axis}{suffix}"
            rows.append([f"{name} {axis}", unit, *(_beside(run, *channels, key, form) for key in reached)])
    height = "nav.error_height_m", "nav.sigma_height_m"
    rows.append(["height above the ground", "m", *(_beside(run, *height, key, ",.2f") for key in reached)])
    caption = f"Estimated less true, and the {BOUND:.0f} σ that the flight software claims"
    return Table(["error", "unit", *(f"{MOMENTS[key]}>" for key in reached)], rows, caption)


def _beside(run: Run, error: str, sigma: str, key: str, form: str) -> str:
    t = run.when[key]
    if (
        key == "touchdown"
    ):  # the estimate is a reading old: where contact shakes the vehicle, it has not seen that yet
        t = float(run.t[max(int(np.searchsorted(run.t, t)) - 1, 0)])
    return f"{run.at(error, t):{form}} ± {BOUND * run.at(sigma, t):{form}}"


def with_bounds(run: Run, rows: np.ndarray, title: str, error: str, sigma: str) -> Panel:
    """An error and the bounds of ``BOUND`` claimed standard deviations, on a scale symmetrical about zero."""
    curves = [
        Curve(sigma, f"{BOUND:.0f} σ claimed", BOUND, GREY, "dash"),
        Curve(sigma, f"{BOUND:.0f} σ claimed", -BOUND, GREY, "dash"),
        Curve(error, "error", colour=BLUE),
    ]
    largest, bound = float(np.max(np.abs(run[error][rows]))), BOUND * float(np.max(run[sigma][rows]))
    reach = 1.08 * max(largest, min(bound, FAR * largest))
    return over_time(run, title, curves, rows, (-reach, reach) if reach > 0.0 else None)


def errors(run: Run, rows: np.ndarray, key: str, title: str, stem: str, suffix: str, unit: str) -> Figure:
    """Errors along north, east and down."""
    panels = [
        with_bounds(
            run,
            rows,
            f"{axis} ({unit})",
            f"nav.error{stem}_{axis}{suffix}",
            f"nav.sigma{stem}_{axis}{suffix}",
        )
        for axis in AXES
    ]
    return stacked(key, title, panels, "Estimated less true, in the axes of the true place.", 150)


def landing(run: Run, rows: np.ndarray, key: str, title: str) -> Figure:
    """Errors of the height above the ground and of the velocity."""
    velocity = [
        with_bounds(run, rows, f"{axis} (m/s)", f"nav.error_v_{axis}_m_s", f"nav.sigma_v_{axis}_m_s")
        for axis in reversed(AXES)
    ]
    height = with_bounds(
        run, rows, "height above\nthe ground (m)", "nav.error_height_m", "nav.sigma_height_m"
    )
    caption = "Estimated less true: height above the ground below, and velocity relative to it."
    return stacked(key, title, [height, *velocity], caption, 130)


def innovations(run: Run, rows: np.ndarray, seen: np.ndarray) -> Figure:
    """How far the beam that was farthest off was from what the filter expected, while there are echoes."""
    parts = (
        ("range (σ)", Curve("nav.range_innovation", colour=GREEN)),
        ("speed (σ)", Curve("nav.speed_innovation", colour=ORANGE)),
    )
    gate = run.scenario["flight_software"]["navigation"].get(_filter(run), {}).get("gate")
    limit = [] if gate is None else [Mark("y", float(gate), "gate", BAD)]
    panels = []
    for title, curve in parts:
        panel = over_time(run, title, [curve], rows & seen)
        panels.append(Panel(panel.x, panel.y, panel.traces, marks=[*panel.marks, *limit]))
    caption = "Largest normalised innovation of a beam; a reading beyond the gate is not used."
    return stacked("nav_innovation", "Radar: innovations", panels, caption, 130)


def _filter(run: Run) -> str:
    return str(run.scenario["flight_software"]["navigation"]["filter"])
