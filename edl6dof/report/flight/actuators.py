"""Every thruster's activity, torque asked for and not delivered, propellant; and what acted besides."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.document import Table
from edl6dof.report.figure import BAD, BLUE, ORANGE, Axis, Band, Figure, Heat, Panel, Trace
from edl6dof.report.flight.diagnosis import branch_use
from edl6dof.report.flight.parts import TIME, event_marks, figure_of, has_signal, over_flight, stacked
from edl6dof.report.panels import DISTURBANCE, PROPELLANT_AND_MASS, TORQUE
from edl6dof.runs.run import Run

#: Columns of the activity map.
BINS = 600


def figures(run: Run) -> Iterator[Figure | Table]:
    """Figures and tables of the section."""
    thrusters = [
        jet["name"] for jet in run.scenario["vehicle"]["rcs"]["thrusters"] if f"rcs.{jet['name']}" in run
    ]
    if thrusters and any(has_signal(run, f"rcs.{name}") for name in thrusters):
        yield activity(run, thrusters)
        yield use(run)
        if (branches := branch_use(run)) is not None:
            yield branches
        yield from over_flight(run, [TORQUE])
    yield from over_flight(run, [PROPELLANT_AND_MASS])


def activity(run: Run, thrusters: list[str]) -> Figure:
    """Mean duty of each thruster over time, one lane each."""
    edges = np.linspace(run.t[0], run.t[-1], BINS + 1)
    place = np.clip(np.searchsorted(edges, run.t, side="right") - 1, 0, BINS - 1)
    count = np.maximum(np.bincount(place, minlength=BINS), 1)
    duty = np.stack([np.bincount(place, run[f"rcs.{name}"], BINS) / count for name in thrusters])
    high = max(float(np.quantile(duty[duty > 0.0], 0.98)) if np.any(duty > 0.0) else 1.0, 0.05)
    heat = Heat(0.5 * (edges[1:] + edges[:-1]), np.arange(len(thrusters)), duty, "mean duty", 0.0, high)
    down = (len(thrusters) - 0.5, -0.5)
    failed = {
        name: float(run.t[np.argmax(faulty)])
        for name in thrusters
        if (faulty := run.get(f"fault.{name}", np.zeros(1)) != 0).any()
    }
    bands = [
        Band(BAD, (since, float(run.t[-1])), (lane - 0.5, lane + 0.5), "failed", 0.25, outline=True)
        for lane, name in enumerate(thrusters)
        if (since := failed.get(name)) is not None
    ]
    panel = Panel(
        Axis(TIME),
        Axis("thruster", down, names=thrusters),
        bands=bands,
        heat=heat,
        marks=event_marks(run, run.t),
    )
    width = edges[1] - edges[0]
    caption = (
        f"Mean thrust fraction over {width:.2f} s; the colour scale ends at the 98th percentile of firing."
    )
    caption += "".join(f" {name} failed at {since:.1f} s." for name, since in failed.items())
    return Figure("thrusters", "Thruster activity", [panel], caption, height=22 * len(thrusters))


def use(run: Run) -> Table:
    """What each thruster did: pulses, time at full thrust, impulse and propellant."""
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
    """What acted on the vehicle besides its thrusters, and the estimates where the run has them."""
    if not any(has_signal(run, f"truth.disturbance_{axis}_nm") for axis in "xyz"):
        return
    acting = "all but the thrusters" if run.scenario["vehicle"]["rcs"]["thrusters"] else "all that acts"
    yield figure_of(run, DISTURBANCE, acting=acting)
    if any(has_signal(run, f"estimate.force_{axis}_n") for axis in "xyz"):
        yield force(run, acting)


def force(run: Run, acting: str) -> Figure:
    """Estimated force beside the aerodynamic force and engine thrust, where no riser pulls in a direction
    that telemetry lacks.
    """
    rows = run.between(until="touchdown")
    free, t = np.where(run["truth.riser_tension_n"] > 0.0, np.nan, 1.0), run.t[rows]
    panels = []
    for axis in "xyz":
        thrust = run["truth.engine_thrust_n"] if axis == "x" else 0.0
        acted = free * (run[f"truth.aero_force_{axis}_n"] - thrust)
        traces = [
            Trace(t, run[f"estimate.force_{axis}_n"][rows], "estimated", colour=ORANGE),
            Trace(t, acted[rows], "true", colour=BLUE),
        ]
        panels.append(Panel(Axis(TIME), Axis(f"{axis} (N)"), traces, marks=event_marks(run, t)))
    vehicle = run.scenario["vehicle"]
    engine = " and, along x, the engine" if vehicle["engines"] else ""
    pulled = " True values are left out while the parachute pulls." if vehicle["parachutes"] else ""
    caption = f"Force of {acting}, in body axes: air{engine}.{pulled}"
    return stacked("disturbance_force", "Disturbance force", panels, caption, 160)
