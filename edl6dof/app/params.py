"""``edl6dof params``: the reference table, legible on a narrow terminal."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import groupby
from textwrap import wrap

from rich.console import Console

from edl6dof.app.exit_status import refuse
from edl6dof.config.parameter_table import Row, rows
from edl6dof.config.wording import nearest
from edl6dof.scenario.schema import Scenario

#: Longest default that stands in the table; a longer one gets a line of its own.
SHORT = 15
WIDEST = 100


def run_params(path: str, as_json: bool) -> int:
    """Print the reference table from ``path`` downwards, or of all parameters whose path contains that
    text.
    """
    table = rows(Scenario)
    found = select(table, path)
    if not found:
        near = nearest(path, known_paths(table))
        hint = f"; did you mean {near!r}?" if near else ""
        return refuse(f"{path}: no such parameter{hint} ('edl6dof params' lists all)")
    if as_json:
        print(json.dumps([row._asdict() for row in found], indent=1))
        return 0
    console = Console(highlight=False, soft_wrap=True)
    width = min(console.width, WIDEST)
    for index, (section, members) in enumerate(groupby(found, key=lambda row: row.path.rpartition(".")[0])):
        if index:
            console.print()
        console.print(section or "scenario", style="bold", markup=False)
        for line, style in _lines(list(members), width):
            console.print(line, style=style, markup=False)
    return 0


def select(table: list[Row], path: str) -> list[Row]:
    """Rows at and below a dotted path, written with or without list indices, or else rows whose path contains
    the text.
    """
    wanted = _plain(path)
    below = [row for row in table if f"{_plain(row.path)}.".startswith(f"{wanted}.")] if wanted else table
    return below or [row for row in table if path.strip().casefold() in row.path.casefold()]


def known_paths(table: list[Row]) -> list[str]:
    """Dotted paths of all parameters and sections, without list brackets."""
    paths = [_plain(row.path).split(".") for row in table]
    return list(
        dict.fromkeys(".".join(parts[:length]) for parts in paths for length in range(1, len(parts) + 1))
    )


def _plain(path: str) -> str:
    """``vehicle.rcs.thrusters[].name`` or ``vehicle.rcs.thrusters.0.name`` as
    ``vehicle.rcs.thrusters.name``.
    """
    parts = path.strip().replace("[]", "").split(".")
    return ".".join(part for part in parts if part and not part.isdecimal())


def _lines(members: list[Row], width: int) -> Iterator[tuple[str, str]]:
    """Aligned lines of one section and their style: key, default, unit and bounds; below it meaning, kind and
    status.
    """
    names = [row.path.rpartition(".")[2] for row in members]
    key_width = max(map(len, names))
    for name, row in zip(names, members, strict=True):
        is_short = len(row.default) <= SHORT
        default = row.default if is_short else ""
        limits = row.bounds.replace(" and ", ", ")
        is_range = limits.startswith(("<", ">"))
        yield (
            f"  {name:<{key_width}}  {default:>{SHORT}}  {row.unit:<8}  "
            f"{limits if is_range else ''}".rstrip(),
            "",
        )
        if not is_short:
            yield from _paragraph(f"default: {row.default}", width)
        source = f"{row.printed} in {row.source}" if row.printed else row.source
        claim = ": ".join(part for part in (row.status, source) if part)
        kind = "" if row.type == "number" else f"; {row.type}"
        if limits and not is_range:
            kind += f", {limits}"
        kind += f"; usually {row.usual}" if row.usual else ""
        yield from _paragraph(f"{row.meaning}{kind}" + (f" ({claim})" if claim else ""), width)


def _paragraph(text: str, width: int) -> Iterator[tuple[str, str]]:
    indent = " " * 6
    for line in wrap(text, width, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False):
        yield line, "dim"
