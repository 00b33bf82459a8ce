"""Propellant branches: what went through them, and what their meters read."""

from __future__ import annotations

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.document import Table
from edl6dof.report.figure import BLUE, GREY, VERMILION, Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.parts import TIME, event_marks, stacked
from edl6dof.runs.run import Run

#: Time, s, over which a flow is the mean; branches shown at most.
MEAN_S, MOST = 0.1, 4


def branch_flows(run: Run, rows: np.ndarray) -> Figure | None:
    """Flow through each branch with a thruster that failed, for some rows (bool); none without one."""
    failed = [
        name for name, jets in thrusters_of(run).items() if any(failed_within(run, jet) for jet in jets)
    ]
    shown = [name for name in failed[:MOST] if f"metered.{name}_kg" in run]
    if not shown:
        return None
    left = f", the first {MOST} of {len(failed)}" if len(failed) > MOST else ""
    caption = (
        f"Means over {MEAN_S:g} s{left}; the meter as the flight computer reads it. A valve that stays open "
        "lets the flow of one thruster through, a dead one none."
    )
    panels = [flow_panel(run, name, rows) for name in shown]
    return stacked("flows", "Flow through the branches that failed", panels, caption, 150)


def branch_use(run: Run) -> Table | None:
    """What each branch used and its meter counted; none where runs do not tell."""
    shown = {name: jets for name, jets in thrusters_of(run).items() if f"metered.{name}_kg" in run}
    if not shown:
        return None
    counts = {name: [run[f"{kind}.{name}_kg"][-1] for kind in ("used", "metered")] for name in shown}
    rows = [[name, ", ".join(jets), *(f"{kg:.3f}" for kg in counts[name])] for name, jets in shown.items()]
    columns = ["branch", "thrusters", "propellant (kg)>", "metered (kg)>"]
    return Table(columns, rows, "Propellant branches, each behind one latch valve")


def failed_within(run: Run, thruster: str) -> bool:
    """Whether a thruster has truly failed in the flight."""
    return bool(np.any(run.get(f"fault.{thruster}", np.zeros(1)) != 0))


def thrusters_of(run: Run) -> dict[str, list[str]]:
    """Names of the propellant branches, and of the thrusters of each."""
    rcs = run.scenario["vehicle"]["rcs"]
    given = {branch["name"]: branch["thrusters"] for branch in rcs.get("branches", [])}
    return given or {jet["name"]: [jet["name"]] for jet in rcs["thrusters"]}


def largest_flow(run: Run, thrusters: list[str]) -> float:
    """Full flow (kg/s) of the largest of some thrusters."""
    return max(
        float(jet["thrust_n"]) / (float(jet["specific_impulse_s"]) * G0)
        for jet in run.scenario["vehicle"]["rcs"]["thrusters"]
        if jet["name"] in thrusters
    )


def mean_flow(t: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Mean flow (kg/s) up to each row from a count (kg); ``nan`` in the first."""
    first = np.searchsorted(t, t - MEAN_S)
    with np.errstate(invalid="ignore"):
        return np.asarray((counted - counted[first]) / (t - t[first]))


def flow_panel(run: Run, branch: str, rows: np.ndarray) -> Panel:
    """What one branch was to let through, where that is known, lets through, and its meter reads."""
    t, expected = run.t[rows], run[f"expected.{branch}_kg_s"]
    counts = [
        ("commanded", np.cumsum(expected * np.diff(run.t, prepend=run.t[0])), GREY),
        ("true", run[f"used.{branch}_kg"], BLUE),
        ("metered", run[f"metered.{branch}_kg"], VERMILION),
    ]
    traces = [
        Trace(t, 1e3 * mean_flow(run.t, counted)[rows], name, colour=colour)
        for name, counted, colour in counts[0 if np.any(expected) else 1 :]
    ]
    jets = thrusters_of(run)[branch]
    marks = [*event_marks(run, t), Mark("y", 1e3 * largest_flow(run, jets), "one open", GREY)]
    return Panel(Axis(TIME), Axis(f"{branch}: {', '.join(jets)}\n(g/s)"), traces, marks=marks)
