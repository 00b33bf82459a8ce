"""Thrusters: activity, torque, propellant and disturbances; faults, and their diagnosis by torque and by the
meters of their branches.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.catalogue import DISTURBANCE, PROPELLANT_AND_MASS, TORQUE
from edl6dof.report.document import Table
from edl6dof.report.figure import Axis, Band, Figure, Heat, Mark, Panel, Trace
from edl6dof.report.flight.common import figure_of, has_signal, over_flight, stacked, time_panel
from edl6dof.report.palette import BAD, BLUE, GREEN, GREY, ORANGE, VERMILION
from edl6dof.runs.run import Run

#: Number of columns (time intervals) of the activity map.
BINS = 600
#: Time (s) shown before a fault and after its diagnosis, or after the fault without one.
BEFORE_S, AFTER_S = 2.0, 3.0
#: Time (s) over which a flow is averaged; most branches shown.
MEAN_S, MOST = 0.1, 4


def thruster_use(run: Run) -> Iterator[Figure | Table]:
    """Draw activity, torque and propellant, and tabulate the use of each thruster."""
    jets = run.scenario["vehicle"]["rcs"]["thrusters"]
    thrusters = [jet["name"] for jet in jets if f"rcs.{jet['name']}" in run]
    if has_signal(run, *(f"rcs.{name}" for name in thrusters)):
        yield activity(run, thrusters)
        yield use(run)
        yield from branch_use(run)
        yield from over_flight(run, [TORQUE])
    yield from over_flight(run, [PROPELLANT_AND_MASS])


def activity(run: Run, thrusters: list[str]) -> Figure:
    """Draw the mean duty of each thruster over time, one lane each."""
    edges = np.linspace(run.t[0], run.t[-1], BINS + 1)
    place = np.clip(np.searchsorted(edges, run.t, side="right") - 1, 0, BINS - 1)
    count = np.maximum(np.bincount(place, minlength=BINS), 1)
    duty = np.stack([np.bincount(place, run[f"rcs.{name}"], BINS) / count for name in thrusters])
    high = max(float(np.quantile(duty[duty > 0.0], 0.98)) if np.any(duty > 0.0) else 1.0, 0.05)
    heat = Heat(0.5 * (edges[1:] + edges[:-1]), np.arange(len(thrusters)), duty, "mean duty", 0.0, high)
    caption, bands = f"Mean thrust fraction over {edges[1] - edges[0]:.2f} s;", list[Band]()
    caption += " the colour scale ends at the 98th percentile of firing."
    for lane, name in enumerate(thrusters):
        faulty = run.get(f"fault.{name}", np.zeros(1)) != 0
        if faulty.any():
            span = float(run.t[np.argmax(faulty)]), float(run.t[-1])
            bands.append(Band(BAD, span, (lane - 0.5, lane + 0.5), "failed", 0.25, outline=True))
            caption += f" {name} failed at {span[0]:.1f} s."
    y = Axis("thruster", (len(thrusters) - 0.5, -0.5), names=thrusters)
    panel = replace(time_panel(run, run.t, y, ()), bands=bands, heat=heat)
    return Figure("thrusters", "Thruster activity", [panel], caption, height=22 * len(thrusters))


def use(run: Run) -> Table:
    """Tabulate pulses, time at full thrust, impulse and propellant of each thruster."""
    step = float(np.median(np.diff(run.t)))
    rows = []
    for jet in run.scenario["vehicle"]["rcs"]["thrusters"]:
        duty = run[f"rcs.{jet['name']}"]
        on = duty > 0.0
        seconds = float(np.sum(duty) * step)
        impulse = seconds * float(jet["thrust_n"])
        pulses = int(np.sum(on[1:] & ~on[:-1]))
        used = impulse / (float(jet["specific_impulse_s"]) * G0)
        numbers = (f"{pulses:,}", f"{seconds:.2f}", f"{impulse:,.0f}", f"{used:.2f}")
        rows.append([jet["name"], jet["group"], f"{jet['thrust_n']:g}", *numbers])
    columns = ["thruster", "group", "thrust (N)>", "pulses>", "time at full thrust (s)>"]
    columns += ["vacuum impulse (N s)>", "propellant (kg)>"]
    caption = f"Thruster use, from the telemetry of one integration step each {step * 1e3:g} ms"
    return Table(columns, rows, caption)


def disturbances(run: Run) -> Iterator[Figure]:
    """Draw torque and force from other sources than the thrusters, and their estimates.

    Telemetry lacks the direction of the riser's pull, so that true forces under tension are left out.
    """
    if not has_signal(run, *(f"truth.disturbance_{axis}_nm" for axis in "xyz")):
        return
    acting = "all but the thrusters" if run.scenario["vehicle"]["rcs"]["thrusters"] else "all that acts"
    yield figure_of(run, DISTURBANCE, acting=acting)
    if not has_signal(run, *(f"estimate.force_{axis}_n" for axis in "xyz")):
        return
    rows = run.between(until="touchdown")
    free, t = np.where(run["truth.riser_tension_n"] > 0.0, np.nan, 1.0), run.t[rows]
    panels = []
    for axis in "xyz":
        thrust = run["truth.engine_thrust_n"] if axis == "x" else 0.0
        acted = free * (run[f"truth.aero_force_{axis}_n"] - thrust)
        true = Trace(t, acted[rows], "true", colour=BLUE)
        estimated = Trace(t, run[f"estimate.force_{axis}_n"][rows], "estimated", colour=ORANGE)
        panels.append(time_panel(run, t, Axis(f"{axis} (N)"), [estimated, true]))
    vehicle = run.scenario["vehicle"]
    engine = " and, along x, the engine" if vehicle["engines"] else ""
    pulled = " True values are left out while the parachute pulls." if vehicle["parachutes"] else ""
    caption = f"Force of {acting}, in body axes: air{engine}.{pulled}"
    yield stacked("disturbance_force", "Disturbance force", panels, caption, 160)


def fault_diagnosis(run: Run) -> Iterator[Figure]:
    """Draw the history of the diagnosis; nothing without a fault and without an isolation."""
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
    yield from branch_flows(run, near)


def history(run: Run, rows: np.ndarray, key: str, title: str) -> Figure:
    """Draw residual torque, confidence, branch under test and thrusters isolated, at some rows (bool)."""
    t, isolated = run.t[rows], run["diagnosis.isolated"][rows]
    free = np.where(run["truth.riser_tension_n"][rows] > 0.0, np.nan, 1.0)
    residual = []
    for axis, name, colour in zip("xyz", ("roll", "pitch", "yaw"), (BLUE, VERMILION, GREEN), strict=True):
        torque = run[f"estimate.torque_{axis}_nm"] - run[f"truth.disturbance_{axis}_nm"]
        residual.append(Trace(t, free * torque[rows], name, colour=colour))
    needed = Mark("y", float(run.scenario["flight_software"]["diagnosis"]["confidence"]), "needed", BAD)
    confidence = Trace(t, run["diagnosis.confidence"][rows], colour=BLUE)
    count = Trace(t, isolated, kind="steps", colour=BAD, width=2.0)
    most = max(float(isolated.max()), 1.0)
    panels = [
        time_panel(run, t, Axis("torque residual\n(N m)"), residual),
        time_panel(run, t, Axis("confidence (1)", (0.0, 1.18)), [confidence], [needed]),
        leaks(run, rows),
        time_panel(run, t, Axis("isolated (1)", (-0.1, most + 0.1)), [count]),
    ]
    caption = "Residual: estimated less true disturbance torque, which is thrust that never came;"
    return stacked(key, title, panels, f"{caption} left out while the parachute pulls.", 150)


def leaks(run: Run, rows: np.ndarray) -> Panel:
    """Draw the times at which each branch was closed to test it for a leak."""
    t, leaking = run.t[rows], run["diagnosis.leaking"][rows]
    lanes = sorted({int(number) for number in leaking if number >= 0.0})
    y = Axis("leak in branch", names=[list(thrusters_of(run))[number] for number in lanes])
    traces = [
        Trace(t, np.where(leaking == number, lane, np.nan), colour=BAD, width=7.0)
        for lane, number in enumerate(lanes)
    ]
    return replace(time_panel(run, t, y, traces), weight=0.25 + 0.15 * len(lanes))


def branch_flows(run: Run, rows: np.ndarray) -> Iterator[Figure]:
    """Draw the flow through each branch with a failed thruster, at some rows (bool)."""
    branches = thrusters_of(run).items()
    failed = [name for name, jets in branches if has_signal(run, *(f"fault.{jet}" for jet in jets))]
    shown = [name for name in failed[:MOST] if f"metered.{name}_kg" in run]
    if not shown:
        return
    left = f", the first {MOST} of {len(failed)}" if len(failed) > MOST else ""
    caption = f"Means over {MEAN_S:g} s{left}; the meter as the flight computer reads it."
    caption += " A valve that stays open lets the flow of one thruster through, a dead one none."
    panels = [flow_panel(run, name, rows) for name in shown]
    yield stacked("flows", "Flow through the branches that failed", panels, caption, 150)


def branch_use(run: Run) -> Iterator[Table]:
    """Tabulate the propellant of each branch and the count of its meter, if the run has meters."""
    branches = {name: jets for name, jets in thrusters_of(run).items() if f"metered.{name}_kg" in run}
    kinds = ["used", "metered"] if has_signal(run, *(f"metered.{name}_kg" for name in branches)) else ["used"]
    rows = [
        [name, ", ".join(jets), *(f"{run[f'{kind}.{name}_kg'][-1]:.3f}" for kind in kinds)]
        for name, jets in branches.items()
    ]
    columns = ["branch", "thrusters", "propellant (kg)>", "metered (kg)>"][: 2 + len(kinds)]
    if rows:
        yield Table(columns, rows, "Propellant branches, each behind one latch valve")


def thrusters_of(run: Run) -> dict[str, list[str]]:
    """Return the propellant branches and the thrusters of each."""
    rcs = run.scenario["vehicle"]["rcs"]
    given = {branch["name"]: branch["thrusters"] for branch in rcs["branches"]}
    return given or {jet["name"]: [jet["name"]] for jet in rcs["thrusters"]}


def mean_flow(t: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Return the mean flow (kg/s) up to each row from a count (kg); ``nan`` in the first."""
    first = np.searchsorted(t, t - MEAN_S)
    with np.errstate(invalid="ignore"):
        return np.asarray((counted - counted[first]) / (t - t[first]))


def flow_panel(run: Run, branch: str, rows: np.ndarray) -> Panel:
    """Draw the commanded and metered flow of one branch, as far as known, and the true flow."""
    t, expected = run.t[rows], run[f"expected.{branch}_kg_s"]
    counts = [
        ("commanded", np.cumsum(expected * np.diff(run.t, prepend=run.t[0])), GREY),
        ("true", run[f"used.{branch}_kg"], BLUE),
        ("metered", run[f"metered.{branch}_kg"], VERMILION),
    ]
    traces = [
        Trace(t, 1e3 * mean_flow(run.t, counted)[rows], name, colour=colour)
        for name, counted, colour in counts
        if name == "true" or np.any(counted)
    ]
    jets = thrusters_of(run)[branch]
    largest = max(
        float(jet["thrust_n"]) / (float(jet["specific_impulse_s"]) * G0)
        for jet in run.scenario["vehicle"]["rcs"]["thrusters"]
        if jet["name"] in jets
    )
    y = Axis(f"{branch}: {', '.join(jets)}\n(g/s)")
    return time_panel(run, t, y, traces, [Mark("y", 1e3 * largest, "one open", GREY)])
