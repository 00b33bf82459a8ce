"""Actuators: every thruster's activity, torque asked for and not delivered, disturbance, and propellant."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.config.units import G0
from edl6dof.report.document import Table
from edl6dof.report.figure import BAD, BLUE, GREEN, GREY, VERMILION, Axis, Band, Figure, Heat, Panel
from edl6dof.report.flight.flows import branch_use
from edl6dof.report.flight.parts import TIME, Curve, event_marks, has_signal, over_time, stacked
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
        yield torque(run)
    if has_signal(run, "truth.propellant_kg"):
        yield propellant(run)


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
        rows.append(
            [
                jet["name"],
                jet["group"],
                f"{jet['thrust_n']:g}",
                f"{pulses:,}",
                f"{seconds:.2f}",
                f"{impulse:,.0f}",
                f"{used:.2f}",
            ]
        )
    columns = [
        "thruster",
        "group",
        "thrust (N)>",
        "pulses>",
        "time at full thrust (s)>",
        "vacuum impulse (N s)>",
        "propellant (kg)>",
    ]
    caption = f"Thruster use, from the telemetry of one integration step each {step * 1e3:g} ms"
    return Table(columns, rows, caption)


def torque(run: Run) -> Figure:
    """Torque demanded by the controller and the part that the allocation could not deliver."""
    rows = run.between(until="touchdown")
    panels = []
    for axis, name in zip("xyz", ("roll", "pitch", "yaw"), strict=True):
        curves = [
            Curve(f"control.torque_{axis}_nm", "demanded", colour=BLUE),
            Curve(f"control.unallocated_{axis}_nm", "unallocated", colour=VERMILION),
        ]
        panels.append(over_time(run, f"{name} (N m)", curves, rows))
    return stacked("torque", "Control torque", panels, "In body axes.", 160)


def propellant(run: Run) -> Figure:
    """Propellant left and mass, true and believed."""
    rows = np.ones(len(run.t), bool)
    mass = [
        Curve("nav.mass_kg", "believed", colour=GREY, dash="dash"),
        Curve("truth.mass_kg", "true", colour=BLUE),
    ]
    panels = [
        over_time(run, "propellant left (kg)", [Curve("truth.propellant_kg", colour=GREEN)], rows),
        over_time(run, "mass (kg)", mass, rows),
    ]
    used = run["truth.propellant_kg"][0] - run["truth.propellant_kg"][-1]
    return stacked(
        "propellant",
        "Propellant and mass",
        panels,
        f"{used:.1f} kg of {run['truth.propellant_kg'][0]:.1f} kg used.",
        180,
    )
