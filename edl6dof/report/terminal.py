"""A flight on a terminal: outcome, limits, timeline, comparison with the published flight."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from rich import box
from rich.console import Console, JustifyMethod
from rich.table import Table
from rich.text import Text

from edl6dof.metrics.evaluation import Check
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.metrics.published import Published, PublishedPair, published_figures
from edl6dof.report.document import Report, as_cell, decimals
from edl6dof.report.document import Table as ReportTable
from edl6dof.report.document import Text as Paragraph

if TYPE_CHECKING:
    from edl6dof.scenario.loaded import LoadedScenario
    from edl6dof.sim.flight import Flight

#: Most letters in a line of a table.
_WIDEST = 400
#: Style of a cell by its mood.
_STYLES = {"good": "green", "warn": "yellow", "bad": "red", "plain": ""}
#: Status of a limit or a requirement.
LIMIT_STATUS = {True: "met", False: "violated"}
#: Remark below the figures of one flight.
ONE_DRAW = "One flight is one draw; mean and spread of many: edl6dof figures SCENARIO"
#: Figures of navigation and their formats.
NAVIGATION = {
    "parachute_nav_position_m": ",.0f",
    "ignition_nav_height_m": ",.2f",
    "ignition_nav_velocity_m_s": ",.3f",
    "touchdown_nav_height_m": ",.2f",
    "touchdown_nav_velocity_m_s": ",.3f",
    "touchdown_nav_vertical_deg": ",.3f",
}


class Compared(NamedTuple):
    """A figure and its published value, formatted; ``kept``: True or False for a requirement; ``sigmas``:
    difference in standard deviations, if known.
    """

    figure: str
    unit: str
    own: str
    published: str
    difference: str
    sigmas: str
    kept: bool | None


def show_flight(console: Console, flight: Flight, verbose: bool = False) -> None:
    """Print the outcome, the limits that are violated, and warnings.

    With ``verbose`` all limits, the timeline, the published flight and the errors of navigation follow.
    """
    console.print(headline(flight))
    violated = [check for check in flight.checks if not check.ok]
    if verbose and flight.checks:
        console.print(limits_table("Limits", flight.checks))
    elif violated:
        console.print(limits_table("Violated limits", violated))
    for warning in flight.loaded.warnings:
        console.print(f"warning: {warning}", style="yellow", markup=False)
    if not verbose:
        return
    console.print(timeline_table(flight))
    if stated := stated_figures(flight.loaded):
        rows = comparison(flight.figures, stated)
        console.print(published_table(rows, "Comparison with the published flight", "this flight"))
        console.print(ONE_DRAW, style="dim", end="\n\n")
    if any(name in flight.figures for name in NAVIGATION):
        console.print(navigation_table(flight))


def stated_figures(loaded: LoadedScenario) -> Published:
    """Return the published figures that the file of a scenario states itself.

    The flight of a scenario that extends another, or that an option changes, is not the published one.
    """
    document = loaded.document
    own = document.mark(()).file
    if any(mark.file.startswith("--set") for mark in document.marks.values()):
        return {}
    entries = loaded.scenario.published
    return {name: entries[name] for name in entries if document.mark(("published", name)).file == own}


def timeline_table(flight: Flight) -> Table:
    """Tabulate events in order of time, those inside a phase indented."""
    # a heading of one line would leave no room for the events in 80 columns
    heads = ("\nt (s)>", "\nevent", "height above\nground (m)>", "\nspeed (m/s)>", "\nMach>")
    table = open_table("Timeline", *heads)
    landed = False
    for event in flight.events:
        landed = landed or event["key"] == "touchdown"
        starts_phase = "phase" in event
        name = event["name"] if starts_phase or event["key"] == "end" else f"  {event['name']}"
        height = event["height_m"]
        shown = f"{height:,.0f}" if height is not None and height < 1e7 else ""
        speed, mach = (event[key] if event[key] is not None else math.nan for key in ("speed_m_s", "mach"))
        flying = math.isfinite(mach) and not landed  # on the ground the number is that of the wind
        number = f"{mach:.2f}" if flying else ""
        cells = Text(name, style="bold cyan" if starts_phase else ""), shown, f"{speed:,.1f}", number
        table.add_row(f"{event['t_s']:.2f}", *cells)
    return table


def published_table(rows: Sequence[Compared], title: str, own: str) -> Table:
    """Tabulate figures next to the published ones; ``own``: heading of the column of the flight's figures."""
    spread = any(row.sigmas for row in rows)
    heads = ["figure", "unit", f"{own}>", "published>", "difference>", *(["sigma>"] if spread else [])]
    table = open_table(title, *heads)
    for row in rows:
        style = {True: "green", False: "bold red", None: ""}[row.kept]
        cells: list[str | Text] = [*row[:4], Text(row.difference, style=style), row.sigmas]
        table.add_row(*cells[: len(heads)])
    return table


def comparison(
    figures: Mapping[str, float | None], published: Published, deviations: Mapping[str, float] | None = None
) -> list[Compared]:
    """Return a row for each published figure.

    Args:
        figures: figures of a flight, or means over flights.
        published: published figures.
        deviations: standard deviations of the figures, if these are means over flights.
    """
    return [
        _compared(pair, figures.get(pair.figure.name), (deviations or {}).get(pair.figure.name))
        for pair in published_figures(published)
    ]


def navigation_table(flight: Flight) -> Table:
    """Tabulate the errors of navigation."""
    table = open_table("Navigation", "figure", "unit", "this flight>")
    for name, form in NAVIGATION.items():
        if (value := flight.figures.get(name)) is not None:
            figure = figure_of_merit(name)
            table.add_row(figure.meaning, figure.unit.label, f"{value:{form}}")
    return table


def limits_table(title: str, checks: Sequence[Check]) -> Table:
    """Tabulate limits of the mission."""
    table = open_table(title, "limit", "unit", "this flight>", "allowed>", "")
    for check in checks:
        mark = Text(LIMIT_STATUS[check.ok], style="green" if check.ok else "bold red")
        value, limit = aligned_pair(check.value, check.limit, check.ok)
        table.add_row(check.label, check.unit, value, f"{check.allowed} {limit}", mark)
    return table


def headline(flight: Flight) -> Text:
    """Return the outcome in one line."""
    style = "bold green" if flight.success else "bold yellow" if flight.termination.reached else "bold red"
    return Text(f"{flight.name}: {flight.outcome} (at t = {flight.time_s:.1f} s)", style=style)


def open_table(title: str, *columns: str, narrow: bool = False) -> Table:
    """Return an empty table without a frame; a heading that ends in ``>`` marks right-aligned numbers.

    A ``narrow`` table has smaller gaps between its columns, and breaks no cell into lines.
    """
    look: Any = {"title_justify": "left", "header_style": "", "box": box.SIMPLE_HEAD, "pad_edge": False}
    table = Table(title=Text(title, style="bold") if title else None, **look)
    table.padding = (0, 1, 0, 0) if narrow else (0, 1)
    look = {"overflow": "fold", "vertical": "bottom" if narrow else "top"}
    for column in columns:
        numbers = column.endswith(">")
        side: JustifyMethod = "right" if numbers else "left"
        table.add_column(column.rstrip(">"), justify=side, no_wrap=narrow or numbers, **look)
    return table


def as_rich(table: ReportTable) -> Table:
    """Return a table of a report for the terminal."""
    printed = open_table(table.caption, *table.columns)
    for row in table.rows:
        cells = map(as_cell, row)
        printed.add_row(*(Text(cell.text, style=_STYLES[cell.mood]) for cell in cells))
    return printed


def show_report(report: Report) -> None:
    """Print headline, facts, tables and paragraphs of a report."""
    console = Console(highlight=False)
    console.print(Text(report.headline, style=f"bold {_STYLES[report.mood]}"))
    print("; ".join(f"{fact.label}: {fact.value}" for fact in report.facts))
    print(report.subtitle)
    for section in report.sections:
        console.print(Text(f"\n{section.title}", style="bold"))
        for block in section.blocks:
            if isinstance(block, ReportTable):
                print_whole(as_rich(block))
            elif isinstance(block, Paragraph):
                print(block.words)


def print_whole(table: Table) -> None:
    """Print a table at its full width: numbers are never cut, and the terminal wraps long lines."""
    Console(highlight=False, soft_wrap=True, width=_WIDEST).print(table)


def _compared(pair: PublishedPair, own: float | None, deviation: float | None) -> Compared:
    figure, published = pair
    places = _published_places(published.number)
    head, shown = (figure.meaning, figure.unit.label), f"{published.mark}{published.number:,.{places}f}"
    if own is None or not math.isfinite(own):
        return Compared(*head, "-", shown, "not reached", "", published.kept(math.nan))
    more = places if own == round(own) else places + (places < 2)
    kept = published.kept(own)
    sigmas = None if deviation is None else published.sigmas(own, deviation)
    flown = f"{published.of(own):,.{more}f}" + ("" if deviation is None else f" +- {deviation:,.{more}f}")
    difference = f"{published.of(own) - published.number:+,.{more}f}" if kept is None else LIMIT_STATUS[kept]
    return Compared(*head, flown, shown, difference, "" if sigmas is None else f"{sigmas:+.1f}", kept)


def _published_places(value: float) -> int:
    """Decimal places of a published figure, six at most."""
    return min(len(repr(float(value)).rstrip("0").partition(".")[2]), 6) if abs(value) >= 1e-4 else 0


def aligned_pair(value: float, limit: float, ok: bool) -> tuple[str, str]:
    """Format value and limit with three digits of the limit, or more if rounding would hide a violation."""
    places = min(decimals(limit, 3), 6)
    while not ok and places < 9 and f"{value:.{places}f}" == f"{limit:.{places}f}":
        places += 1
    return (f"{value:,.{places}f}" if math.isfinite(value) else "-"), f"{limit:,.{places}f}"
