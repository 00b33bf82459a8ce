"""A fault matrix in the terminal."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.api.reports import report_of, write_page
from edl6dof.campaign.executor import Row
from edl6dof.campaign.faults import can_be_known, is_right
from edl6dof.campaign.store import Store
from edl6dof.cli.exit_status import NOT_WITHIN_LIMITS
from edl6dof.config.base import stated
from edl6dof.config.dump import json_text
from edl6dof.config.wording import counted

#: A matrix of more moments or components is left to the report, and so are more lines of one kind.
_COLUMNS, _ROWS, _LINES = 10, 40, 20
#: Characters of a line where there is no terminal.
_WIDTH = 120
_LEGEND = """\
matrix: s from first use to the right isolation; a name: what was named instead;
?: in use, and not named; -: not used after the fault, so nobody can know;
x: not within limits
tables: right names and kinds are shares of the flights in which the fault can
be known; times are to the right isolation, and first use may be a leak"""


def show_matrix(store: Store, as_json: bool) -> int:
    """Print what a complete matrix came to, and write its report; returns the exit status.

    Raises:
        ConfigError: its table or its summary is not as it was written.
    """
    rows = store.table().to_pylist()
    figures = stated(store.summary.faults)
    if not (page := store.folder / "report.html").exists():
        write_page(report_of(store.folder), page, False, store.folder)
    if as_json:
        print(json_text({**figures, "rows": rows}), end="")
    else:
        width = None if sys.stdout.isatty() else _WIDTH
        _print(Console(highlight=False, soft_wrap=True, width=width), rows, figures)
        print(f"{store.folder}: report.html, cases.parquet, summary.json")
        print(f"next: edl6dof refly {store.folder} CASE")
    return 0 if all(row["success"] for row in rows) else NOT_WITHIN_LIMITS


def _print(console: Console, rows: Sequence[Row], figures: Mapping[str, Any]) -> None:
    for kind in dict.fromkeys(row["kind"] for row in rows):
        some = [row for row in rows if row["kind"] == kind]
        if _fits(some):
            console.print(_matrix(some, kind))
    console.print(_shares(figures["groups"]))
    for start, words in (("from_use_s", "first use"), ("from_fault_s", "the fault")):
        console.print(_times(figures["groups"], start, f"time from {words} to isolation, s"))
    console.print(_LEGEND, style="dim")
    lost = [row for row in rows if not row["success"]]
    _lines(console, "red", [f"{_case(row)}: {row['outcome']}" for row in lost])
    wrong = [f"{_case(row)}: named {row['wrongly_named']}" for row in rows if row.get("wrongly_named")]
    _lines(console, "magenta", wrong)
    for one in figures["acceptance"]:
        words = f"{one['meaning']}: {one['value']:.2f} {one['unit']} (required: {one['limit']})"
        console.print(Text(words, style="green" if one["met"] else "bold red"))
    flights = counted(len(rows), "flight")
    outcome = f"{len(lost)} of {flights} not within limits" if lost else f"{flights} within limits"
    console.print(Text(outcome, style="bold red" if lost else "bold green"))


def _fits(rows: Sequence[Row]) -> bool:
    """Say if a matrix, of one flight in each cell, can be read in a terminal."""
    components, moments = ({row[name] for row in rows} for name in ("component", "moment"))
    one_each = len(rows) <= len(components) * len(moments)
    return one_each and len(moments) <= _COLUMNS and len(components) <= _ROWS


def _case(row: Row) -> str:
    return f"case {row['case']}, {row['component']} {row['kind']} at {row['moment']}"


def _lines(console: Console, style: str, lines: Sequence[str]) -> None:
    for line in lines[:_LINES]:
        console.print(Text(line, style=style))
    if len(lines) > _LINES:
        console.print(Text(f"and {len(lines) - _LINES} more, in report.html", style=style))


def _matrix(rows: Sequence[Row], kind: str) -> Table:
    """Components by moments: named rightly green, wrongly magenta, not yellow; out of limits red."""
    table = _empty(kind.replace("_", " "))
    table.add_column("")
    moments = list(dict.fromkeys(row["moment"] for row in rows))
    for moment in moments:
        table.add_column(moment.replace("_", " "), justify="right", vertical="bottom")
    cells = {(row["component"], row["moment"]): _cell(row) for row in rows}
    for name in dict.fromkeys(row["component"] for row in rows):
        table.add_row(name, *(cells[name, moment] for moment in moments))
    return table


def _cell(row: Row) -> Text:
    if is_right(row):
        found, style = f"{row['isolation_from_use_s']:.2f}", "green"
    elif row.get("named"):
        found, style = str(row["named"]), "magenta"
    else:
        found, style = "?" if can_be_known(row) else "-", "yellow"
    return Text(found, style=style) if row["success"] else Text(f"x {found}", style="bold red")


def _shares(groups: Sequence[Mapping[str, Any]]) -> Table:
    """Return the number of flights of each kind of fault and regime, and percentages of them."""
    headings = ("flights", "% in\nlimits", "can be\nknown", "% right\nname", "% right\nkind", "wrong\nnames")
    table = _by_group("", headings)
    for group in groups:
        flights, known, wrong = group["flights"], group["can_be_known"], group["with_wrong_isolations"]
        right = (_share(group[name], known) for name in ("name_right", "kind_right"))
        cells = (str(flights), _share(group["within_limits"], flights), str(known), *right, str(wrong))
        table.add_row(group["kind"], group["regime"], *cells)
    return table


def _times(groups: Sequence[Mapping[str, Any]], start: str, title: str) -> Table:
    """Times (s) from a start to the right isolations of each kind of fault and regime."""
    names = {"median": "median", "p95": "95 %", "worst": "longest"}
    table = _by_group(title, list(names.values()))
    for group in groups:
        shown = [f"{group[start][name]:.2f}" if group[start] else "" for name in names]
        table.add_row(group["kind"], group["regime"], *shown)
    return table


def _by_group(title: str, headings: Sequence[str]) -> Table:
    table = _empty(title)
    for heading in ("kind", "regime"):
        table.add_column(heading, vertical="bottom", no_wrap=True)
    for heading in headings:
        table.add_column(heading, justify="right", vertical="bottom", no_wrap=True)
    return table


def _empty(title: str) -> Table:
    """A table of 80 characters for the longest name of a kind."""
    return Table(
        title=title or None,
        title_justify="left",
        title_style="bold",
        header_style="",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )


def _share(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f}" if whole else ""
