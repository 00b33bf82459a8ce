"""Instruments: a lane for each gyro, accelerometer and radar beam, in the colour of what was made of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from edl6dof.report.figure import BAD, GREEN, ORANGE, SKY, Axis, Figure, Panel, Trace
from edl6dof.report.flight.parts import TIME, event_marks, has_signal, stacked
from edl6dof.runs.run import Run
from edl6dof.telemetry.instruments import EXCLUDED, IN_USE, NOT_USED, SATURATED, USED, Instrument, instruments
from edl6dof.telemetry.spans import spans
from edl6dof.vehicle.faults.component import Component, Components

#: Colour of a state; one that is left out leaves the lane empty.
COLOURS = {IN_USE: GREEN, USED: GREEN, SATURATED: ORANGE, NOT_USED: SKY, EXCLUDED: BAD}
TITLES = {"gyro": "gyros", "accelerometer": "accelerometers", "beam": "radar beams"}


def figures(run: Run) -> Iterator[Figure]:
    """The lanes; none where navigation takes the word of ideal instruments."""
    found = instruments(run, names(run)) if has_signal(run, "nav.sigma_down_m") else []
    if found:
        kinds = dict.fromkeys(one.kind for one in found)
        panels = [lanes(run, [one for one in found if one.kind == kind]) for kind in kinds]
        caption = (
            "What the flight computer made of each instrument; a saturated one is at the end of its range, "
            "a beam without an echo has no line."
        )
        yield stacked("nav_instruments", "Instruments", panels, caption, 150)


def names(run: Run) -> Components:
    """Names of the instruments that are carried, by kind."""
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
    """A lane for each of some instruments of one kind."""
    traces = []
    for state, colour in COLOURS.items():
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
    marks = [replace(mark, label="") for mark in event_marks(run, run.t)]
    return Panel(Axis(TIME), y, traces, marks=marks, weight=0.3 + 0.13 * len(those))
