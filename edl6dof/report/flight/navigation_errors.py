"""Navigation: the error of the estimate and the bounds that the flight software claims for it.

Errors are hundreds of metres at entry and decimetres at touchdown: each stretch of the flight has a figure of
its own scale.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from edl6dof.report import catalogue as plots
from edl6dof.report.document import Row, Table
from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.common import figure_of, has_signal, over_flight, stacked, time_panel
from edl6dof.report.palette import BAD
from edl6dof.runs.run import Run
from edl6dof.telemetry.columns import Instrument, describe, instruments
from edl6dof.telemetry.thinning import spans
from edl6dof.vehicle.faults.component import Component, Components

#: Errors in the table axis by axis, and their formats.
ERRORS = ((plots.POSITION_ERROR, ",.1f"), (plots.VELOCITY_ERROR, ".3f"), (plots.ATTITUDE_ERROR, ".4f"))
#: Moments of the table, by event.
MOMENTS = {"mortar": "mortar fire", "ignition": "ignition", "touchdown": "touchdown"}
TITLES = {"gyro": "gyros", "accelerometer": "accelerometers", "beam": "radar beams"}


def figures(run: Run) -> Iterator[Figure | Table]:
    """Draw the figures of the section; none with ideal navigation."""
    if not has_signal(run, "nav.sigma_down_m"):
        return
    seen = echoes(run)
    if any(key in run.when for key in MOMENTS):
        yield at_moments(run)
    yield figure_of(run, plots.NAV_POSITION)
    yield figure_of(run, plots.NAV_VELOCITY, ~(np.cumsum(seen) > 0))
    yield figure_of(run, plots.NAV_ATTITUDE)
    if np.any(run.between(until="touchdown") & seen):
        yield figure_of(run, plots.NAV_LANDING)
        if (shown := innovations(run, seen)).panels:  # the filter used an echo
            yield shown
    yield from over_flight(run, [plots.NAV_TOUCHDOWN])
    yield from instrument_lanes(run)


def innovations(run: Run, seen: np.ndarray) -> Figure:
    """Draw the largest innovation of a radar beam at the rows with an echo (``seen``, bool)."""
    navigation = run.scenario["flight_software"]["navigation"]
    gate = navigation.get(str(navigation["filter"]), {}).get("gate")
    limit = [] if gate is None else [Mark("y", float(gate), "gate", BAD)]
    figure = figure_of(run, plots.NAV_INNOVATION, seen)
    return replace(figure, panels=[replace(panel, marks=[*panel.marks, *limit]) for panel in figure.panels])


def instrument_lanes(run: Run) -> Iterator[Figure]:
    """Draw a lane for each gyro, accelerometer and radar beam, coloured by its use."""
    found = instruments(run, names(run))
    if found:
        kinds = dict.fromkeys(one.kind for one in found)
        panels = [lanes(run, [one for one in found if one.kind == kind]) for kind in kinds]
        caption = (
            "What the flight computer made of each instrument; a saturated one is at the end of its range, "
            "a beam without an echo has no line."
        )
        yield stacked("nav_instruments", "Instruments", panels, caption, 150)


def echoes(run: Run) -> np.ndarray:
    """Return the rows in which a beam of the radar has an echo, shape (rows,), bool."""
    ranges = [run[name] for name in run if name.startswith("range.")]
    return np.any(ranges, axis=0) if ranges else np.zeros(len(run.t), bool)


def at_moments(run: Run) -> Table:
    """Tabulate error and bound of every estimate at the main events."""
    reached = [key for key in MOMENTS if key in run.when]
    rows: list[Row] = []
    of_axes = [(one, form) for plot, form in ERRORS for one in plot.apart()]
    for plot, form in (*of_axes, (plots.HEIGHT_ERROR._replace(title="height above the ground"), ",.2f")):
        error, sigma = plot.channels
        values = (_bounded(run, error, sigma, key, form) for key in reached)
        rows.append([plot.title.replace(" error,", ""), describe(error)[0], *values])
    caption = f"Estimated less true, and the {plots.BOUND:.0f} σ that the flight software claims"
    return Table(["error", "unit", *(f"{MOMENTS[key]}>" for key in reached)], rows, caption)


def _bounded(run: Run, error: str, sigma: str, key: str, form: str) -> str:
    t = run.when[key]
    if key == "touchdown":  # one row earlier, without the shock of the contact
        t = float(run.t[max(int(np.searchsorted(run.t, t)) - 1, 0)])
    return f"{run.at(error, t):{form}} ± {plots.BOUND * run.at(sigma, t):{form}}"


def names(run: Run) -> Components:
    """Return the names of the instruments carried, by kind."""
    sensors = run.scenario["sensors"]
    found: dict[Component, list[str]] = {}
    if "inertial_unit" in sensors["carried"]:
        unit = sensors["inertial_unit"]
        found["gyro"] = [str(one["name"]) for one in unit["gyros"]["axes"]]
        found["accelerometer"] = [str(one["name"]) for one in unit["accelerometers"]["axes"]]
    if "radar" in sensors["carried"]:
        found["beam"] = [str(one["name"]) for one in sensors["radar"]["beams"]]
    return found


def lanes(run: Run, those: Sequence[Instrument]) -> Panel:
    """Draw a lane for each of ``those`` instruments, all of one kind."""
    traces = []
    for state, colour in plots.STATES.items():
        ends = [
            (run.t[first], run.t[min(last, len(run.t) - 1)], lane)
            for lane, one in enumerate(those)
            if state in one.states
            for first, last in spans(one.holds(state))
        ]
        if ends:
            x = np.array([[begin, end, np.nan] for begin, end, _ in ends]).ravel()
            places = np.repeat([float(lane) for _, _, lane in ends], 3)
            traces.append(Trace(x, np.where(np.isnan(x), np.nan, places), state, colour=colour, width=7.0))
    y = Axis(TITLES[those[0].kind], (len(those) - 0.5, -0.5), names=[one.name for one in those])
    panel = time_panel(run, run.t, y, traces)
    unnamed = [replace(mark, label="") for mark in panel.marks]
    return replace(panel, marks=unnamed, weight=0.3 + 0.13 * len(those))
