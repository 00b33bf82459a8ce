"""The fault matrix in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.app.faults.summary import found_s, groups_of, never_used
from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.manifest import listed

_LEGEND = """\
matrix: s from the fault to its {found}; a name: another {thing} was named;
-: never {used} after the fault; ?: in use, but not named
below it: medians of s to the {found}, from the fault and from its first use;
largest {largest}"""
#: Words of the legend, and columns of the overview: heading, figure of a group, digits.
_THRUSTERS = {
    "found": "isolation", "thing": "thruster", "used": "fired",
    "largest": "distance from the site (m) and attitude error (deg)",
}  # fmt: skip
_SENSORS = {
    "found": "exclusion", "thing": "instrument", "used": "used",
    "largest": "errors of height, velocity and vertical that navigation has at touchdown",
}  # fmt: skip
_TIMES = (("from\nfault s", "median_time_to_detect_s", 2), ("from\nuse s", "median_from_first_use_s", 2))
_OF_FLIGHT = (("site\nm", "worst_landing_distance_m", 0), ("error\ndeg", "worst_attitude_error_deg", 1))
_OF_NAVIGATION = (
    ("height\nm", "worst_nav_height_m", 2),
    ("velocity\nm/s", "worst_nav_velocity_m_s", 2),
    ("vertical\ndeg", "worst_nav_vertical_deg", 2),
)


def show(
    console: Console, rows: list[Row], phases: Mapping[str, Sequence[str]], sensors: bool, target: Path
) -> None:
    """A matrix and an overview for each kind of fault, what was lost, and where the table is.

    ``phases``: by kind of fault; ``sensors``: whether instruments failed.
    """
    for kind, columns in phases.items():
        console.print(_matrix([row for row in rows if row["kind"] == kind], kind, columns))
        console.print(_overview(groups_of(rows, kind, columns), sensors))
    console.print(_LEGEND.format(**(_SENSORS if sensors else _THRUSTERS)), style="dim")
    for row in rows:
        if not row["success"]:
            console.print(
                Text(f"{row['component']} {row['kind']} in {row['phase']}: {row['outcome']}", style="red")
            )
    lost = sum(not row["success"] for row in rows)
    flights = counted(len(rows), "flight")
    outcome = f"{lost} of {flights} not within limits" if lost else f"{flights} landed within limits"
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(outcome, style="bold red" if lost else "bold green"))


def _matrix(rows: list[Row], kind: str, phases: Sequence[str]) -> Table:
    """Components by phases: green landed and named, yellow landed and not named, red not within limits."""
    table = Table(
        title=kind.replace("_", " "),
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    table.add_column("", header_style="")
    for phase in phases:
        table.add_column(phase, justify="right", header_style="")
    cells = {(row["component"], row["phase"]): _cell(row) for row in rows}
    for name in dict.fromkeys(row["component"] for row in rows):
        table.add_row(name, *(cells[name, phase] for phase in phases))
    return table


def _cell(row: Row) -> Text:
    after = found_s(row)
    if after is not None:
        found = f"{after:.2f}"
    elif row.get("named"):
        found = str(row["named"])
    else:
        found = "-" if never_used(row) else "?"
    if not row["success"]:
        return Text(f"{row.get('cause', 'lost')} {found}", style="bold red")
    wrong = "magenta" if row.get("named") else "yellow"
    return Text(found, style="green" if after is not None else wrong)


def _overview(groups: list[dict[str, Any]], sensors: bool) -> Table:
    """Counts, median times from fault and from first use, and the largest figures of the flights."""
    figures = _TIMES + (_OF_NAVIGATION if sensors else _OF_FLIGHT)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(
        ("phase", "landed", "named", "wrong", *(heading for heading, _, _ in figures))
    ):
        table.add_column(
            heading, justify="right" if index else "left", header_style="", vertical="bottom", no_wrap=True
        )
    for group in groups:
        counts = (f"{group['survived']}/{group['flights']}", group["named_right"], group["named_wrong"])
        values = ((group[name], digits) for _, name, digits in figures)
        shown = ("" if value is None else f"{value:.{digits}f}" for value, digits in values)
        table.add_row(group["phase"], *map(str, counts), *shown)
    return table
