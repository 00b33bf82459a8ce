"""Fault diagnosis: what the thrusters failed to deliver, and what the flight computer made of it; what went
through their propellant branches, and what the meters of these read.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.document import Table
from edl6dof.report.figure import BAD, BLUE, GREEN, GREY, VERMILION, Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.parts import TIME, event_marks, has_signal, stacked
from edl6dof.runs.run import Run

#: Time, s, shown before a fault and after its diagnosis, or after the fault without one.
BEFORE_S, AFTER_S = 2.0, 3.0
#: Time, s, over which a flow is the mean; branches shown at most.
MEAN_S, MOST = 0.1, 4


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
    threshold = float(run.scenario["flight_software"]["diagnosis"]["confidence"])
    isolated = Trace(t, run["diagnosis.isolated"][rows], kind="steps", colour=BAD, width=2.0)
    panels = [
        Panel(Axis(TIME), Axis("torque residual\n(N m)"), residual, marks=marks),
        Panel(
            Axis(TIME),
            Axis("confidence (1)", (0.0, 1.18)),
            [Trace(t, run["diagnosis.confidence"][rows], colour=BLUE)],
            marks=[*marks, Mark("y", threshold, "needed", BAD)],
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
