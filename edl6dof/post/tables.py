"""What a flight looks like on a terminal: timeline, limits, comparison with the published flight."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.config.units import split_unit

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight

#: Published figures that are upper bounds or "at least" statements, not values to meet.
_BOUNDS = {"max_", "parachute_total_alpha", "backshell_height", "backshell_speed", "powered_deceleration"}


def show_flight(console: Console, flight: Flight) -> None:
    """Print timeline, limits, the table against the published flight, and the verdict."""
    console.print(timeline_table(flight))
    if flight.scenario.published:
        console.print(published_table(flight))
    if flight.checks:
        console.print(limits_table(flight))
    console.print(verdict(flight))


def timeline_table(flight: Flight) -> Table:
    """Events in order of time."""
    table = Table(title="Timeline", title_justify="left", header_style="bold")
    table.add_column("t (s)", justify="right")
    table.add_column("event")
    table.add_column("height (m)", justify="right")
    table.add_column("speed (m/s)", justify="right")
    table.add_column("Mach", justify="right")
    for event in flight.events:
        style = "bold cyan" if event["key"].startswith("phase.") else ""
        height = event["height_m"]
        shown = f"{height:,.0f}" if height is not None and height < 1e7 else ""
        table.add_row(
            f"{event['t_s']:.2f}", Text(event["name"], style=style), shown, f"{event['speed_m_s']:.1f}", f"{event['mach']:.2f}"
        )
    return table


def published_table(flight: Flight) -> Table:
    """This flight's figures beside the published ones, whatever the difference."""
    table = Table(title="This flight beside the published flight", title_justify="left", header_style="bold")
    table.add_column("figure")
    table.add_column("unit")
    table.add_column("this flight", justify="right")
    table.add_column("published", justify="right")
    table.add_column("difference", justify="right")
    for name, published in flight.scenario.published.items():
        base, unit = split_unit(name)
        own = flight.metrics.get(name)
        relation = _relation(name)
        if own is None or not math.isfinite(own):
            table.add_row(_words(base), unit.label, "-", f"{relation}{_number(published)}", "not reached")
            continue
        difference = _compared(relation, own, published)
        table.add_row(_words(base), unit.label, _number(own), f"{relation}{_number(published)}", difference)
    return table


def limits_table(flight: Flight) -> Table:
    """Limits of the verdict."""
    table = Table(title="Limits", title_justify="left", header_style="bold")
    table.add_column("limit")
    table.add_column("unit")
    table.add_column("this flight", justify="right")
    table.add_column("allowed", justify="right")
    table.add_column("")
    for check in flight.checks:
        mark = Text("ok", style="green") if check.ok else Text("missed", style="bold red")
        table.add_row(check.label, check.unit, _number(check.value), f"<= {_number(check.limit)}", mark)
    return table


def verdict(flight: Flight) -> Text:
    """One line: how it ended."""
    style = "bold green" if flight.success else "bold yellow" if flight.landed else "bold red"
    return Text(f"{flight.name}: {flight.outcome} at t = {flight.time_s:.1f} s", style=style)


def _relation(name: str) -> str:
    if name == "bank_reversals":
        return ">= "
    return "<= " if any(name.startswith(start) for start in _BOUNDS) else ""


def _compared(relation: str, own: float, published: float) -> str:
    if relation == "<= ":
        return "kept" if own <= published else f"+{_number(own - published)}"
    if relation == ">= ":
        return "kept" if own >= published else f"{_number(own - published)}"
    return f"{own - published:+.3g}"


def _words(name: str) -> str:
    return name.replace("_", " ")


def _number(value: float) -> str:
    size = abs(value)
    if size >= 1000.0:
        return f"{value:,.0f}"
    if size >= 100.0:
        return f"{value:.1f}"
    return f"{value:.3g}" if size < 1.0 else f"{value:.2f}"
