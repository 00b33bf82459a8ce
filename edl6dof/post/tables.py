"""What a flight looks like on a terminal: timeline, comparison with the published flight, limits, verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.config.units import split_unit

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight

#: Published figures that are upper bounds or "at least" statements, not values to meet.
_BOUNDS = {"max_", "trim_aoa_limit_cycle", "parachute_total_alpha", "backshell_height", "backshell_speed", "powered_deceleration"}


def show_flight(console: Console, flight: Flight) -> None:
    """Print timeline, the table against the published flight, limits, and last, where the eye is, the verdict."""
    console.print(timeline_table(flight))
    if flight.scenario.published:
        console.print(published_table(flight))
    if flight.checks:
        console.print(limits_table(flight))
    console.print(verdict(flight))


def timeline_table(flight: Flight) -> Table:
    """Events in order of time; what happens inside a phase is indented below it."""
    table = open_table("Timeline", "t (s)>", "event", "height (m)>", "speed (m/s)>", "Mach>")
    for event in flight.events:
        starts_phase = "phase" in event
        name = event["name"] if starts_phase or event["key"] == "end" else f"  {event['name']}"
        height = event["height_m"]
        shown = f"{height:,.0f}" if height is not None and height < 1e7 else ""
        speed, mach = (event[key] if event[key] is not None else math.nan for key in ("speed_m_s", "mach"))
        cells = Text(name, style="bold cyan" if starts_phase else ""), shown, f"{speed:,.1f}", f"{mach:.2f}"
        table.add_row(f"{event['t_s']:.2f}", *cells)
    return table


def published_table(flight: Flight) -> Table:
    """This flight's figures beside the published ones, whatever the difference."""
    table = open_table("Beside the published flight", "figure", "unit", "this flight>", "published>", "difference>")
    for row in comparison(flight.metrics, flight.scenario.published):
        table.add_row(*row)
    return table


def comparison(figures: Mapping[str, float | None], published_figures: Mapping[str, float]) -> list[tuple[str, str, str, str, str]]:
    """Rows (figure, unit, this flight, published, difference) in words and rounded numbers."""
    rows = []
    for name, published in published_figures.items():
        base, unit = split_unit(name)
        own = figures.get(name)
        relation = _relation(name)
        places = _published_places(published)
        shown = f"{relation}{published:,.{places}f}"
        if own is None or not math.isfinite(own):
            rows.append((_words(base), unit.label, "-", shown, "not reached"))
        else:
            more = places if own == round(own) else places + (places < 2)
            rows.append((_words(base), unit.label, f"{own:,.{more}f}", shown, _compared(relation, own - published, more)))
    return rows


def limits_table(flight: Flight) -> Table:
    """Limits of the verdict."""
    table = open_table("Limits", "limit", "unit", "this flight>", "allowed>", "")
    for check in flight.checks:
        mark = Text("ok", style="green") if check.ok else Text("MISSED", style="bold red")
        value, limit = aligned_pair(check.value, check.limit, check.ok)
        table.add_row(check.label, check.unit, value, f"<= {limit}", mark)
    return table


def verdict(flight: Flight) -> Text:
    """One line: how it ended."""
    style = "bold green" if flight.success else "bold yellow" if flight.landed else "bold red"
    return Text(f"{flight.name}: {flight.outcome} at t = {flight.time_s:.1f} s", style=style)


def open_table(title: str, *columns: str) -> Table:
    """An open table; a heading that ends in ``>`` is that of right-aligned numbers."""
    table = Table(title=title, title_justify="left", title_style="bold", header_style="", box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(
            column.rstrip(">"), justify="right" if column.endswith(">") else "left", no_wrap=column.endswith(">"), overflow="fold"
        )
    return table


def _relation(name: str) -> str:
    if name == "bank_reversals":
        return ">= "
    return "<= " if any(name.startswith(start) for start in _BOUNDS) else ""


def _compared(relation: str, difference: float, places: int) -> str:
    kept = difference <= 0.0 if relation == "<= " else relation == ">= " and difference >= 0.0
    return "kept" if kept else f"{difference:+,.{places}f}"


def _words(name: str) -> str:
    return name.replace("_", " ")


def _published_places(value: float) -> int:
    """Decimal places with which a figure was published: as many as it has, and not more than six."""
    return min(len(repr(float(value)).rstrip("0").partition(".")[2]), 6) if abs(value) >= 1e-4 else 0


def aligned_pair(value: float, limit: float, ok: bool) -> tuple[str, str]:
    """Value and limit with the same decimals: three digits of the limit, more when a missed limit would look kept."""
    places = min(max(2 - math.floor(math.log10(limit)), 0), 6)
    while not ok and places < 9 and f"{value:.{places}f}" == f"{limit:.{places}f}":
        places += 1
    return (f"{value:,.{places}f}" if math.isfinite(value) else "-"), f"{limit:,.{places}f}"
