"""The review of one flight: its tables, and the figures of its parts section by section."""

from __future__ import annotations

import json
import math
import platform
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from pydantic import ValidationError

from edl6dof.config.base import STATUS_MARKS
from edl6dof.design.thruster_authority import configurations
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.catalogue import STACKS
from edl6dof.report.document import (
    Block,
    Cell,
    Fact,
    Listing,
    Mood,
    Report,
    Row,
    Section,
    Table,
    Text,
    in_percent,
    printed,
)
from edl6dof.report.flight import landing, navigation_errors, phase_planes, thrusters, trajectory
from edl6dof.report.flight.common import has_signal, over_flight
from edl6dof.report.flight.first_screen import first_screen
from edl6dof.report.terminal import LIMIT_STATUS, aligned_pair, comparison
from edl6dof.report.vehicle_drawing import NOTE, authority_tables, vehicle_figure
from edl6dof.runs.run import Run
from edl6dof.vehicle.vehicle import VehicleParams

#: Figures of merit at the head of the report, and their formats.
_FACTS = (
    ("landing_distance_m", ",.0f"),
    ("touchdown_vertical_m_s", ".2f"),
    ("peak_load_g0", ".2f"),
    ("peak_heat_flux_w_cm2", ".1f"),
    ("propellant_used_kg", ".1f"),
    ("parachute_mach", ".2f"),
    ("peak_dynamic_pressure_pa", ",.0f"),
    ("max_load_parachute_g0", ".2f"),
)
#: Number of these figures that are shown, the first ones that the flight has.
_MOST_FACTS = 5
#: State of the vehicle at an event, and its formats.
_STATE = {"height_m": ",.0f", "speed_m_s": ",.1f", "mach": ".2f"}
#: Mood of a requirement that is met or missed; other differences (``None``) are neither good nor bad.
_KEPT: dict[bool | None, Mood] = {True: "good", False: "bad", None: "plain"}


def flight_report(run: Run) -> Report:
    """Return the review of a run, without sections that would be empty."""
    authority = " and thruster authority" if run.scenario["vehicle"]["rcs"]["thrusters"] else ""
    sections: tuple[tuple[str, str, Iterable[Block]], ...] = (
        ("limits", "Limits and published flight", limits_and_published(run)),
        ("events", "Timeline", timeline(run)),
        ("trajectory", "Trajectory", trajectory.figures(run)),
        ("guidance", "Entry guidance", over_flight(run, STACKS["guidance"])),
        ("navigation", "Navigation", navigation_errors.figures(run)),
        ("attitude", "Attitude", over_flight(run, STACKS["attitude"])),
        ("phase_planes", "Phase planes", phase_planes.figures(run)),
        ("vehicle", f"Vehicle{authority}", vehicle_section(run)),
        ("actuators", "Thrusters and propellant", thrusters.thruster_use(run)),
        ("disturbances", "Disturbances", thrusters.disturbances(run)),
        ("diagnosis", "Fault diagnosis", thrusters.fault_diagnosis(run)),
        ("chute", "Parachute", over_flight(run, STACKS["chute"])),
        ("landing", "Powered descent", landing.powered_descent(run)),
        ("hazards", "Hazards and the chosen spot", landing.hazard_maps(run)),
        ("site", "Landing site", landing.landing_site(run)),
        ("configuration", "Configuration", configuration(run)),
        ("software", "Software and data", [software(run)]),
    )
    filled = ((key, title, list(blocks)) for key, title, blocks in sections)
    return Report(
        title=run.name,
        subtitle=subtitle(run),
        headline=headline(run),
        mood=mood(run.summary),
        facts=facts(run),
        picture=first_screen(run),
        sections=[Section(*section) for section in filled if section[2]],
        footer=f"edl6dof {run.summary['edl6dof_version']}; scenario SHA-256 {run.summary['scenario_sha256']}",
    )


def mood(summary: Mapping[str, Any]) -> Mood:
    """Return good within limits, warn if the goal was reached outside them, bad otherwise."""
    if summary["success"]:
        return "good"
    return "warn" if summary.get("reached_goal") else "bad"


def headline(run: Run) -> str:
    """Return the outcome and its time."""
    return f"{run.summary['outcome']} at t = {run.summary['time_s']:.1f} s"


def facts(run: Run) -> list[Fact]:
    """Return the first key figures that the flight has; those beyond a limit are marked bad."""
    figures = run.summary["figures"]
    missed = {limit["name"] for limit in run.summary["limits"] if not limit["ok"]}
    found = []
    for name, form in _FACTS:
        there = name != "propellant_used_kg" or has_signal(run, "truth.propellant_kg")
        if there and (value := figures.get(name)) is not None:
            figure = figure_of_merit(name)
            words = f"{value:{form}} {printed(figure.unit.label)}".strip()
            found.append(Fact(figure.meaning, words, "bad" if figure.meaning in missed else "plain"))
    return found[:_MOST_FACTS]


def limits_and_published(run: Run) -> Iterator[Block]:
    """Tabulate limits, published figures and unusual values."""
    of_limits, of_published = limits(run), published(run)
    yield of_limits if of_limits.rows else Text("No limit applies as far as this flight went.")
    if of_published.rows:
        yield of_published
    if unusual := run.summary.get("warnings"):
        yield Table(["unusual value"], [[warning] for warning in unusual], "Warnings")


def limits(run: Run) -> Table:
    """Tabulate each limit with the share of it that was used."""
    rows: list[Row] = []
    for limit in run.summary["limits"]:
        value = math.nan if limit["value"] is None else float(limit["value"])
        bound, mood = float(limit["limit"]), _KEPT[limit["ok"]]
        shown, allowed = aligned_pair(value, bound, limit["ok"])
        share = bound / max(value, 1e-9) if limit["least"] else value / bound
        used = Cell("-", mood) if math.isnan(share) else Cell(in_percent(share), mood, share)
        sign, result = "≥" if limit["least"] else "≤", Cell(LIMIT_STATUS[limit["ok"]], mood)
        rows.append([limit["name"], printed(limit["unit"]), shown, f"{sign} {allowed}", used, result])
    return Table(["limit", "unit", "this flight>", "allowed>", "used>", "result"], rows, "Limits")


def published(run: Run) -> Table:
    """Tabulate this flight's figures and the published ones."""
    rows: list[Row] = []
    for row in comparison(run.summary["figures"], run.summary["published"]):
        bound = row.published.replace("<=", "≤").replace(">=", "≥").replace("+-", "±")
        rows.append([row.figure, printed(row.unit), row.own, bound, Cell(row.difference, _KEPT[row.kept])])
    columns = ["figure", "unit", "this flight>", "published>", "difference>"]
    return Table(columns, rows, "Comparison with the published flight")


def subtitle(run: Run) -> str:
    """Return the description of the scenario, and its faults."""
    faults = [f"{event['name']} at {event['t_s']:.1f} s" for event in run.events if event["key"] == "fault"]
    return "; ".join(filter(None, [str(run.scenario.get("description") or ""), *faults]))


def timeline(run: Run) -> Iterator[Block]:
    """Tabulate events in order of time."""
    rows: list[Row] = []
    for event in run.events:
        name = event["phase"].replace("_", " ") if "phase" in event else f"\u2003{event['name']}"
        values = ((event.get(key), form) for key, form in _STATE.items())
        state = ("" if value is None else f"{value:{form}}" for value, form in values)
        rows.append([f"{event['t_s']:.2f}", name, *state])
    columns = ["t (s)>", "event", "height above ground (m)>", "speed over ground (m/s)>", "Mach in the air>"]
    yield Table(columns, rows)
    if "touchdown" in run.when:
        words = "The Mach number is that of the airspeed: of a vehicle at rest on the ground,"
        yield Text(f"{words} that of the wind.")


def vehicle_section(run: Run) -> Iterator[Block]:
    """Draw the vehicle and tabulate the authority of its thrusters; nothing of a point mass."""
    if run.scenario["dynamics"] == "point_mass":
        return
    try:
        vehicle = VehicleParams.model_validate_json(json.dumps(run.scenario["vehicle"]))
    except ValidationError:
        yield Text("Not drawn: the vehicle has parameters of a plugin, which a report does not load.")
        return
    states = configurations(vehicle)
    yield vehicle_figure(vehicle, states)
    if tables := authority_tables(vehicle, states):
        yield from tables
        yield Text(NOTE)


def configuration(run: Run) -> Iterator[Block]:
    """List the resolved scenario by section, each with the count of its status marks."""
    counts = defaultdict[str, Counter[str]](Counter)
    for path, status in run.document.status.items():
        counts[path.partition(".")[0]][status] += 1
    total, marks = sum(counts.values(), Counter()), STATUS_MARKS.items()
    claims = ", ".join(f"[{mark}] {status} ({total[status]})" for mark, status in marks if total[status])
    words = "The scenario as it was flown, every default written out."
    yield Text(f"{words} Marks say what kind of claim a number is: {claims}.")
    lines, loose = run.scenario_text.splitlines(), list[str]()
    starts = [i for i, line in enumerate(lines) if line and line[0] not in " #-"] + [len(lines)]
    for start, end in pairwise(starts):
        key, text = lines[start].partition(":")[0], "\n".join(lines[start:end])
        if end - start == 1:
            loose.append(text)
            continue
        note = ", ".join(f"{counts[key][status]} {status}" for _, status in marks if counts[key][status])
        yield Listing(key.replace("_", " "), text, note)
    if loose:
        yield Listing("name and seed", "\n".join(loose))


def software(run: Run) -> Table:
    """Tabulate versions, seed, hash and telemetry."""
    from edl6dof import __version__

    rows: list[Row] = [
        ["flown by", f"edl6dof {run.summary['edl6dof_version']}"],
        ["report by", f"edl6dof {__version__}, Python {platform.python_version()}"],
        ["scenario", f"{run.name}, seed {run.summary['seed']}"],
        ["SHA-256 of the resolved scenario", run.summary["scenario_sha256"]],
        ["telemetry", f"{len(run.t):,} rows, {len(run) - 1} channels, {run.t[0]:.2f} to {run.t[-1]:.2f} s"],
    ]
    return Table(["what", "which"], rows, "Software and data")
