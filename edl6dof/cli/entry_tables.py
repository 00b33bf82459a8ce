"""A designed entry: its bank profile and figures beside the planned ones, and the scenario that flies it."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

from rich.console import Console
from rich.table import Table

from edl6dof.config.document.extends import EXTENDS
from edl6dof.config.document.overrides import with_values
from edl6dof.config.document.scalars import write_scalar
from edl6dof.config.errors import refusal
from edl6dof.design.entry_profile import Design, Goal, Plan
from edl6dof.report.terminal import open_table
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import resolved_text


def goal_of(maximise: str | None, minimise: str | None) -> Goal:
    """Return what is asked for: one of the goals, by the option that belongs to it."""
    given = {"--maximise": maximise, "--minimise": minimise}
    if None not in given.values():
        raise refusal("--minimise", "and --maximise cannot both be given")
    known = dict(zip(given, get_args(Goal), strict=True))
    for option, value in given.items():
        if value is not None and value != known[option]:
            raise refusal(option, f"must be {known[option]!r} (got {value!r})")
    return "dispersion" if minimise else "parachute_altitude"


def designed_text(scenario: str, whole: bool, loaded: LoadedScenario, found: Design) -> str:
    """Write the scenario with the designed profile as YAML: one that extends it, or ``whole`` all of it."""
    name = f"{loaded.scenario.name}_designed"
    if not whole:
        return _overlay(scenario, name, found)
    points = [{"at": round(at, 1), "bank_deg": round(bank, 2)} for at, bank in found.after.points]
    values = {"name": name, "flight_software.guidance.entry.reference_bank.points": points}
    return resolved_text(check_document(with_values(loaded.document, values, Scenario)))


def _overlay(scenario: str, name: str, found: Design) -> str:
    file = Path(scenario)
    extended = str(file.resolve()) if file.is_file() else scenario
    rows = (f"          - {{at: {at:.1f}, bank_deg: {bank:.2f}}}" for at, bank in found.after.points)
    return "\n".join(
        (
            f"{EXTENDS}: {write_scalar(extended)}",
            f"name: {write_scalar(name)}",
            "flight_software:",
            "  guidance:",
            "    entry:",
            "      reference_bank:",
            f"        points:  # [D] edl6dof design entry {scenario}",
            *rows,
            "",
        )
    )


def show(name: str, found: Design) -> None:
    """Print profile, figures and limits that are not kept."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(_profile(name, found))
    console.print(_figures(found))
    for broken in found.broken:
        console.print(f"not kept: {_REMEDIES[broken]}", markup=False)


def _profile(name: str, found: Design) -> Table:
    table = open_table(f"{name}: bank profile", "speed m/s>", "planned deg>", "designed deg>")
    for bank, (speed, designed) in zip(found.planned_deg, found.after.points, strict=True):
        table.add_row(f"{speed:.0f}", f"{bank:.1f}", f"{designed:.1f}")
    return table


def _figures(found: Design) -> Table:
    limits = found.limits
    table = open_table("Plan, open loop", "figure", "unit", "planned>", "designed>", "limit>")

    def row(figure: str, unit: str, of: tuple[float, float], limit: str = "", places: int = 0) -> None:
        table.add_row(figure, unit, *(f"{round(value, places) + 0.0:,.{places}f}" for value in of), limit)

    def both(name: str) -> tuple[float, float]:
        return getattr(found.before, name), getattr(found.after, name)

    row("altitude of the parachute", "m", both("altitude_m"))
    row("beyond the aim point", "m", both("beyond_m"))
    row("right of it", "m", both("aside_m"), f"{limits.aside_m:,.0f}")
    row("largest load", "g0", both("load_g0"), f"{limits.load_g0:.1f}", 2)
    row("largest heat rate", "W/cm2", both("heat_rate_w_cm2"), f"{limits.heat_rate_w_cm2:.0f}", 1)
    row("largest dynamic pressure", "Pa", both("dynamic_pressure_pa"), f"{limits.dynamic_pressure_pa:,.0f}")
    row("least distance to the bank limits", "deg", both("reserve_deg"), f"{limits.reserve_deg:g}", 1)
    row("fastest change of the profile", "deg/s", both("bank_slope_deg_s"), f"{limits.bank_slope_deg_s:g}", 2)
    row("miss by 1 sigma of density", "m", _misses(found, 0))
    row("miss by 1 sigma of lift", "m", _misses(found, 1))
    row("miss by 1 sigma of entry angle", "m", _misses(found, 2))
    row("1 sigma of the miss without guidance", "m", both("dispersion_m"))
    return table


def _misses(found: Design, index: int) -> tuple[float, float]:
    def of(plan: Plan) -> float:
        return plan.misses_m[index]

    return of(found.before), of(found.after)


_LIMITS = "flight_software.guidance.entry.limits"
#: What to change where a designed plan does not keep a limit.
_REMEDIES = {
    "load": f"load: enter at a flatter angle, or raise {_LIMITS}.load_g0",
    "heat rate": f"heat rate: enter at a flatter angle, or raise {_LIMITS}.heat_rate_w_cm2",
    "dynamic pressure": f"dynamic pressure: enter at a flatter angle, or raise {_LIMITS}.dynamic_pressure_pa",
    "bank slope": "change of the bank angle: fewer --points",
    "reserve": "reserve: move the landing site or the entry state along the track, or lower --reserve",
    "crossrange": "crossrange: narrow the corridor of the bank reversals",
    "aim point": "aim point: out of reach within the reserve; move the landing site or the entry state along "
    "the track, or lower --reserve",
}
