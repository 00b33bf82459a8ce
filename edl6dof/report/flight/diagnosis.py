"""Fault diagnosis: what the thrusters failed to deliver, and what the flight computer made of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.figure import BAD, BLUE, GREEN, VERMILION, Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.flows import branch_flows, thrusters_of
from edl6dof.report.flight.parts import TIME, Curve, event_marks, has_signal, over_time, stacked
from edl6dof.runs.run import Run

#: Time, s, shown before a fault and after its diagnosis, or after the fault without one.
BEFORE_S, AFTER_S = 2.0, 3.0


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section; none where nothing failed and the flight computer named nothing."""
    if not {"fault", "diagnosis"} & run.when.keys():
        return
    flown = run.between(until="touchdown")
    if has_signal(run, "diagnosis.confidence"):
        yield history(run, flown, "diagnosis", "Fault diagnosis")
    if "fault" not in run.when:
        return
    end = run.when.get("diagnosis", run.when["fault"]) + AFTER_S
    near = flown & (run.t > run.when["fault"] - BEFORE_S) & (run.t < end)
    if "diagnosis" in run.when:
        yield history(run, near, "diagnosis_close", "Fault diagnosis, from the fault to its name")
    if (flows := branch_flows(run, near)) is not None:
        yield flows


def history(run: Run, rows: np.ndarray, key: str, title: str) -> Figure:
    """Residual torque, confidence of the best hypothesis, branch looked into, and thrusters isolated, for
    some rows (bool).
    """
    t = run.t[rows]
    marks = event_marks(run, t)
    free = np.where(run["truth.riser_tension_n"][rows] > 0.0, np.nan, 1.0)
    residual = [
        Trace(
            t,
            free * (run[f"estimate.torque_{axis}_nm"] - run[f"truth.disturbance_{axis}_nm"])[rows],
            name,
            colour=colour,
        )
        for axis, name, colour in zip("xyz", ("roll", "pitch", "yaw"), (BLUE, VERMILION, GREEN), strict=True)
    ]
    confidence = over_time(
        run, "confidence (1)", [Curve("diagnosis.confidence", colour=BLUE)], rows, (0.0, 1.18)
    )
    threshold = float(run.scenario["flight_software"]["diagnosis"]["confidence"])
    isolated = Trace(t, run["diagnosis.isolated"][rows], kind="steps", colour=BAD, width=2.0)
    panels = [
        Panel(Axis(TIME), Axis("torque residual\n(N m)"), residual, marks=marks),
        Panel(
            confidence.x, confidence.y, confidence.traces, marks=[*marks, Mark("y", threshold, "needed", BAD)]
        ),
        leaks(run, rows),
        Panel(
            Axis(TIME),
            Axis("isolated (1)", (-0.1, max(float(isolated.y.max()), 1.0) + 0.1)),
            [isolated],
            marks=marks,
        ),
    ]
    caption = (
        "Residual: estimated less true disturbance torque, which is thrust that never came; left out while "
        "the parachute pulls."
    )
    return stacked(key, title, panels, caption, 150)


def leaks(run: Run, rows: np.ndarray) -> Panel:
    """When which branch was shut to look into its leak: a lane for each that was."""
    leaking = run["diagnosis.leaking"][rows]
    lanes = sorted({int(number) for number in leaking if number >= 0.0})
    names = [list(thrusters_of(run))[number] for number in lanes]
    traces = [
        Trace(run.t[rows], np.where(leaking == number, lane, np.nan), kind="line", colour=BAD, width=7.0)
        for lane, number in enumerate(lanes)
    ]
    return Panel(
        Axis(TIME),
        Axis("leak in branch", names=names),
        traces,
        marks=event_marks(run, run.t[rows]),
        weight=0.25 + 0.15 * len(lanes),
    )
