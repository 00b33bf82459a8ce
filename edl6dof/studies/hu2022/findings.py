"""What the study says: figures of the nominal beside those of the real flight, and of each experiment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import nan

import numpy as np

from edl6dof.campaign.neighbours import SampleMean
from edl6dof.campaign.rows import Row
from edl6dof.interface.roles import HAZARD_AVOIDANCE
from edl6dof.metrics.published import Beside, published_figures
from edl6dof.sim.flight import Flight
from edl6dof.studies.attitude_loops import flown_loops, margins
from edl6dof.studies.hu2022.printed_force import POLES_RAD_S, largest_n
from edl6dof.studies.hu2022.rigs import FORMULATIONS, HELD, STEP_NM
from edl6dof.studies.quantiles import with_quantile
from edl6dof.studies.study import Finding

#: Figures of the flight, and where Figs. 8 to 12 and the text give them.
_FLIGHT = (
    ("trim_aoa_limit_cycle_deg", "sect. 3"),
    ("trim_aoa_propellant_kg", ""),
    ("lift_start_s", ""),
    ("bank_reversals", "Fig. 8"),
    ("max_bank_rate_deg_s", "Fig. 8"),
    ("max_pitch_rate_lift_deg_s", "Fig. 10"),
    ("max_yaw_rate_lift_deg_s", "Fig. 9"),
    ("trim_wing_s", ""),
    ("parachute_s", ""),
    ("parachute_total_alpha_deg", "sect. 4"),
    ("max_rate_parachute_deg_s", "Figs. 8-10"),
    ("backshell_s", ""),
    ("roll_error_at_ignition_deg", "Fig. 8, size"),
    ("max_attitude_error_powered_deg", "Fig. 10"),
    ("max_rate_powered_deg_s", "Figs. 8-10"),
    ("max_roll_error_powered_deg", "Fig. 8"),
    ("max_estimated_torque_nm", "Fig. 11"),
    ("touchdown_s", ""),
    *((f"touchdown_{axis}_error_deg", "Figs. 8-10") for axis in ("roll", "pitch", "yaw")),
    *((f"touchdown_{axis}_rate_deg_s", "Figs. 8-10") for axis in ("roll", "pitch", "yaw")),
)


def all_of(nominal: Flight, means: Mapping[str, SampleMean], rows: list[Row]) -> tuple[Finding, ...]:
    """Every finding of the study: the flight as a mean over neighbouring ones, and the experiments."""
    published = {name: entry for name, entry in nominal.scenario.published.items() if name in dict(_FLIGHT)}
    flown = (_flown(beside, means) for beside in published_figures(published))
    experiments = (*_entries(rows), *_steps(rows), *_wings(rows), *_loops(nominal))
    return (*flown, *_estimated_force(nominal), *experiments)


def _flown(beside: Beside, means: Mapping[str, SampleMean]) -> Finding:
    """Mean and spread of a figure beside its published value."""
    figure, published = beside
    own = means.get(figure.name, SampleMean(nan, nan, 0))
    return Finding(
        figure.meaning,
        figure.unit.label,
        published.of(own.mean),
        published.number,
        published.bound,
        dict(_FLIGHT)[figure.name],
        own.deviation,
    )


def _estimated_force(flight: Flight) -> tuple[Finding, ...]:
    force = max(_peak(flight, f"estimate.force_{axis}_n", HAZARD_AVOIDANCE) for axis in "yz")
    as_printed = (
        Finding(f"as printed, lambda_v {pole:g}", "N", largest_n(flight, pole), 40.0, note="Fig. 12")
        for pole in POLES_RAD_S
    )
    return Finding("estimated force", "N", force, 40.0, note="Fig. 12, one flight"), *as_printed


def _peak(flight: Flight, channel: str, role: str | None = None) -> float:
    """Largest magnitude of a channel in the powered descent, from half a second after ignition, or in one
    role of it.
    """
    table = flight.telemetry
    rows = (table["t_s"] > flight.metrics["backshell_s"] + 1.0) & (
        table["t_s"] < flight.metrics["touchdown_s"]
    )
    if role is not None:
        rows &= flight.during(role)
    return float(np.max(np.abs(table[channel][rows])))


def _entries(rows: list[Row]) -> tuple[Finding, ...]:
    by = {
        name: [row for row in rows if row["experiment"] == "entry" and row["variant"] == name]
        for name in FORMULATIONS
    }
    found = {name: np.array([row["settled_s"] for row in by[name]]) for name in FORMULATIONS}
    landed = 100.0 * np.mean([row["landed"] for name in FORMULATIONS for row in by[name]])
    findings = []
    for name in FORMULATIONS:
        word, mean = name.replace("_", " "), np.array([row["mean_error_deg"] for row in by[name]])
        findings += [
            with_quantile(Finding(f"thrust found, {word}", "s", nan, note="median"), found[name], 0.5),
            with_quantile(Finding(f"worst tenth, {word}", "s", nan, note="90 %"), found[name], 0.9),
            with_quantile(Finding(f"mean error, {word}", "deg", nan, note="median"), mean, 0.5),
        ]
    quicker = 100.0 * np.mean(found["decoupled"] <= found["shortest_path"] + 0.05)
    return (
        *findings,
        Finding("decoupled is no slower in", "%", float(quicker), note="sect. 6.2"),
        Finding("dispersed entries landed", "%", float(landed), note="both"),
    )


def _of(rows: Iterable[Row], experiment: str) -> list[tuple[str, Row]]:
    return [(row["variant"], row) for row in rows if row["experiment"] == experiment]


def _steps(rows: list[Row]) -> tuple[Finding, ...]:
    findings = []
    for name, row in _of(rows, "torque step"):
        findings.append(
            Finding(f"{STEP_NM:g} N m, {name}: peak", "deg", row["peak_error_deg"], note="sect. 6.2")
        )
        findings.append(Finding(f"{STEP_NM:g} N m, {name}: settled", "s", row["settled_s"]))
    return tuple(findings)


def _wings(rows: list[Row]) -> tuple[Finding, ...]:
    return tuple(
        Finding(
            f"wing failed, {name}",
            "deg",
            row["parachute_total_alpha_deg"],
            7.0,
            "<=" if name == HELD else "",
            "sect. 4.3",
        )
        for name, row in _of(rows, "trim wing")
    )


def _loops(flight: Flight) -> tuple[Finding, ...]:
    findings = []
    for name, loop in flown_loops(flight.scenario).items():
        own = margins(loop)
        note = f"{own.crossover_rad_s:.1f} rad/s"
        findings.append(Finding(f"phase margin, {name.replace('_', ' ')}", "deg", own.phase_deg, note=note))
    return tuple(findings)
