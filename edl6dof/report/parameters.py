"""Tables of parameters, and of the values of a scenario, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate, chain, groupby
from textwrap import wrap

from rich.console import Console

from edl6dof.config.errors import refusal
from edl6dof.config.parameter_table import Value, nearest_path

#: Longest value in the table of parameters, longest one on lines of its own, and widest line, in letters.
SHORT, LONGEST, WIDEST = 15, 400, 100


def print_values(found: Sequence[Value]) -> None:
    """Print values by section, each with unit, bounds, meaning, status and origin."""
    console = Console(highlight=False, soft_wrap=True)
    width = min(console.width, WIDEST)
    for index, (section, members) in enumerate(
        groupby(found, key=lambda one: one.row.path.rpartition(".")[0])
    ):
        if index:
            console.print()
        console.print(section or "scenario", style="bold", markup=False)
        for line, style in _lines(list(members), width):
            console.print(line, style=style, markup=False)


def selected(table: Sequence[Value], path: str, command: str) -> list[Value]:
    """Return the selected values; refuse a path without any, where ``command`` lists all."""
    if (found := select(table, path)) is None:
        near = nearest_path(path.strip(), known_paths(table))
        hint = f"; did you mean {near!r}?" if near else ""
        raise refusal(path, f"no such parameter{hint} ('{command}' lists all)")
    return found


def select(table: Sequence[Value], path: str) -> list[Value] | None:
    """Values at and below a dotted path, list items by index or by name, otherwise those whose path contains
    the text; ``None`` if there are none.
    """
    parts = [part for part in path.strip().split(".") if part]
    below = [one for one in table if any(_leads(parts, way.split(".")) for way in (one.row.path, one.place))]
    text = path.strip().casefold()
    return below or [one for one in table if text in one.row.path.casefold()] or None


def _leads(parts: Sequence[str], way: Sequence[str]) -> bool:
    """True if a path leads along another, in which ``x[]`` is any item of x, and ``<key>`` any key."""
    if not parts or not way:
        return not parts
    if way[0].endswith("[]") and parts[0].removesuffix("[]") == way[0].removesuffix("[]"):
        return _leads(parts[1:], way[1:]) or _leads(parts[2:], way[1:])
    return way[0] in ("<key>", parts[0]) and _leads(parts[1:], way[1:])


def known_paths(table: Sequence[Value]) -> list[str]:
    """Dotted paths of all parameters and sections, without list brackets."""
    paths = (accumulate(one.row.path.replace("[]", "").split("."), "{}.{}".format) for one in table)
    return list(dict.fromkeys(chain.from_iterable(paths)))


def _lines(members: list[Value], width: int) -> Iterator[tuple[str, str]]:
    """Lines of one section with styles: key, value, unit, bounds; below them meaning, status, origin."""
    names = [one.row.path.rpartition(".")[2] for one in members]
    key_width = max(map(len, names))
    for name, (row, value, _, origin) in zip(names, members, strict=True):
        is_short = len(value) <= SHORT
        limits = row.bounds.replace(" and ", ", ")
        is_range = limits.startswith(("<", ">"))
        shown = value if is_short else ""
        line = f"  {name:<{key_width}}  {shown:>{SHORT}}  {row.unit:<8}  {limits if is_range else ''}"
        yield line.rstrip(), ""
        if not is_short:
            yield from _paragraph(f"{'value' if origin else 'default'}: {short(value)}", width)
        source = f"{row.printed} in {row.source}" if row.printed else row.source
        claim = ": ".join(part for part in (row.status, source) if part)
        kind = "" if row.type == "number" else f"; {row.type}"
        if limits and not is_range:
            kind += f", {limits}"
        kind += f"; usually {row.usual}" if row.usual else ""
        claimed = f" ({claim})" if claim else ""
        yield from _paragraph(f"{row.meaning}{kind}{claimed}{f' [{origin}]' if origin else ''}", width)


def short(value: str) -> str:
    """Return a value as text of at most :data:`LONGEST` letters."""
    return value if len(value) <= LONGEST else f"{value[: LONGEST - 4]} ..."


def _paragraph(text: str, width: int) -> Iterator[tuple[str, str]]:
    indent = " " * 6
    for line in wrap(text, width, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False):
        yield line, "dim"
