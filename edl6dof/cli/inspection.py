"""Scenario files: their mistakes, parameters, the shipped ones; plugins, and the consent to run them."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import accumulate, chain, groupby
from pathlib import Path
from textwrap import fill, wrap
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from edl6dof.api.functions import draw_vehicle, load
from edl6dof.calibration.problem import calibration_of
from edl6dof.campaign.design.plan import plan_of
from edl6dof.cli.group import BAD_INPUT, NOT_WITHIN_LIMITS
from edl6dof.config.document.locate import find_shipped, resolve_scenario, shipped_names, shown
from edl6dof.config.document.source import parse_document, read_document
from edl6dof.config.errors import ConfigError, did_you_mean, refusal
from edl6dof.config.parameter_table import Value, rows, values
from edl6dof.config.plugin_files import accept, accepted_file, is_accepted
from edl6dof.plugins import named_by, plugin_content, source_text
from edl6dof.report.terminal import open_table
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import CALIBRATION, CAMPAIGN_SECTIONS, load_document
from edl6dof.scenario.schema import Scenario

if TYPE_CHECKING:
    from edl6dof.design.thruster_authority import Configuration

#: Longest value in the table of parameters, longest one on lines of its own, and widest line, in letters.
SHORT, LONGEST, WIDEST = 15, 400, 100


def check_files(files: Sequence[str], sets: Sequence[str]) -> int:
    """Validate each file and print every problem of every file; returns the exit status."""
    bad = False
    for name in files:
        try:
            loaded = _loaded(name, tuple(sets))
        except ConfigError as error:
            print(error, file=sys.stderr)
            bad = True
        else:
            for warning in loaded.warnings:
                print(f"warning: {warning}", file=sys.stderr)
            print(f"{name}: ok ({', '.join(shown(file) for file in loaded.document.files)})")
    return BAD_INPUT if bad else 0


def _loaded(name: str, sets: tuple[str, ...]) -> LoadedScenario:
    document = read_document(resolve_scenario(name))
    if any(document.data.get(section) is not None for section in CAMPAIGN_SECTIONS):
        return plan_of(document, sets).loaded
    if document.data.get(CALIBRATION) is not None:
        return calibration_of(document, sets).loaded
    return load_document(document, sets)


def list_scenarios() -> None:
    """Print the names of the shipped scenarios and what they are."""
    console = Console(highlight=False)
    table = open_table("", "scenario", "what it is")
    for name in shipped_names("scenarios"):
        path = find_shipped("scenarios", name)
        data = parse_document(path.read_text(encoding="utf-8"), name).data if path else {}
        table.add_row(name, Text(str(data.get("description") or "")))
    console.print(table)
    console.print("A file of your own: edl6dof scenarios tianwen1 > mine.yaml", style="dim")


def show_params(path: str, as_json: bool) -> None:
    """Print the reference table from ``path`` downwards, or of parameters whose path contains it."""
    table = [Value(row, row.default, row.path, "") for row in rows(Scenario)]
    found = _found(table, path, "edl6dof params")
    if as_json:
        print(json.dumps([one.row._asdict() for one in found], indent=1))
    else:
        _print_sections(found)


def show_values(name: str, path: str, sets: Sequence[str], as_json: bool) -> None:
    """Print the values of a scenario from ``path`` downwards, or whose path contains it."""
    found = _found(_values(name, sets), path, f"edl6dof show {name}")
    if as_json:
        print(json.dumps([{**one.row._asdict(), **_given(one)} for one in found], indent=1))
    else:
        _print_sections(found)


def show_differences(names: tuple[str, str], path: str, sets: Sequence[str], as_json: bool) -> None:
    """Print the values in which two scenarios differ, and where each is given; ``sets`` are of the first."""
    one, two = _values(names[0], sets), _values(names[1], ())
    mine, other = ({value.row.path: value for value in table} for table in (one, two))
    units = {
        value.row.path: value.row.unit for value in _found([*one, *two], path, f"edl6dof show {names[0]}")
    }
    pairs = {key: (mine.get(key), other.get(key)) for key in units}
    pairs = {key: pair for key, pair in pairs.items() if len({value and value.value for value in pair}) > 1}
    if as_json:
        data = [
            {"path": key, "unit": units[key], "values": [value and _given(value) for value in pair]}
            for key, pair in pairs.items()
        ]
        print(json.dumps(data, indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    console.print(" | ".join(names) if pairs else "The scenarios are the same.", style="bold", markup=False)
    for key, pair in pairs.items():
        shown = (f"{_short(value.value)} {units[key]}".rstrip() if value else "-" for value in pair)
        console.print(f"{key}: {' | '.join(shown)}", markup=False)
        places = (value.origin if value else "-" for value in pair)
        console.print(f"    {' | '.join(places)}", style="dim", markup=False)


def show_vehicle(name: str, sets: Sequence[str], out: Path, force: bool, as_json: bool) -> None:
    """Draw the vehicle of a scenario, and print the authority of its thrusters."""
    from edl6dof.report.vehicle_drawing import NOTE, authority_tables

    loaded = load(name, sets)
    states = draw_vehicle(loaded, out, force=force)
    if as_json:
        print(json.dumps([_plain(state) for state in states], indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    for table in authority_tables(loaded.scenario.vehicle, states):
        shown = open_table(table.caption, *table.columns)
        for row in table.rows:
            shown.add_row(*map(str, row))
        console.print(shown)
    words = NOTE if states[0].groups else f"{loaded.scenario.vehicle.name} has no thrusters."
    console.print(fill(words, 80), style="dim", markup=False)
    print(out)


def _plain(state: Configuration) -> dict[str, object]:
    """The configuration as JSON: forces (N) and torques (N m) along - and + of x, y, z."""
    groups = {
        group: {
            f"{kind}_{unit}": rows.tolist()
            for kind, values in (("pure", found.pure), ("total", found.total))
            for unit, rows in (("force_n", values[:3]), ("torque_nm", values[3:]))
        }
        for group, found in state.groups.items()
    }
    return {"configuration": state.name, "centre_m": state.centre_m.tolist(), "groups": groups}


def _values(name: str, sets: Sequence[str]) -> list[Value]:
    loaded = _loaded(name, tuple(sets))
    return list(values(loaded.scenario, loaded.document))


def _given(value: Value) -> dict[str, str]:
    return {"value": value.value, "origin": value.origin}


def _print_sections(found: Sequence[Value]) -> None:
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


def _found(table: Sequence[Value], path: str, command: str) -> list[Value]:
    """Return the values that ``path`` selects; refuse a path without any, naming the ``command`` for all."""
    if (found := select(table, path)) is None:
        near = did_you_mean(path, known_paths(table))
        raise refusal(path, f"no such parameter{near} ('{command}' lists all)")
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
    """True if the path ``way`` begins with ``parts``; ``x[]`` in it is any item of x, ``<key>`` any key."""
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
            yield from _paragraph(f"{'value' if origin else 'default'}: {_short(value)}", width)
        source = f"{row.printed} in {row.source}" if row.printed else row.source
        claim = ": ".join(part for part in (row.status, source) if part)
        kind = "" if row.type == "number" else f"; {row.type}"
        if limits and not is_range:
            kind += f", {limits}"
        kind += f"; usually {row.usual}" if row.usual else ""
        claimed = f" ({claim})" if claim else ""
        yield from _paragraph(f"{row.meaning}{kind}{claimed}{f' [{origin}]' if origin else ''}", width)


def _short(value: str) -> str:
    return value if len(value) <= LONGEST else f"{value[: LONGEST - 4]} ..."


def _paragraph(text: str, width: int) -> Iterator[tuple[str, str]]:
    indent = " " * 6
    for line in wrap(text, width, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False):
        yield line, "dim"


def trust_plugins(files: Sequence[str], yes: bool) -> int:
    """Show each plugin, ask for consent to run it, and record it; return the exit status."""
    for path in [path for file in files for path in _plugins(file)]:
        content = plugin_content(path, partial(refusal, shown(path)))
        if is_accepted(content):
            print(f"{shown(path)}: accepted before")
            continue
        print(_printable(source_text(content)))
        if not yes and not _consent(path):
            print(f"{shown(path)}: not accepted")
            return NOT_WITHIN_LIMITS
        try:
            accept(path, content)
        except OSError as error:
            raise refusal(shown(accepted_file()), f"cannot be written: {error.strerror or error}") from error
        print(f"{shown(path)}: accepted")
    return 0


def _plugins(file: str) -> list[Path]:
    if file.endswith(".py"):
        return [Path(file).absolute()]
    if found := list(named_by(file)):
        return found
    raise refusal(file, "names no plugins; give a plugin (.py) or a scenario that names some")


def _consent(path: Path) -> bool:
    try:
        answer = input(f"Run {shown(path)} with your rights? [y/N] ")
    except EOFError:
        return False
    return answer.strip().lower() in ("y", "yes")


def _printable(source: str) -> str:
    """Source text for a terminal, lines as Python counts them; escapes show control characters."""
    text = source.replace("\r\n", "\n").replace("\r", "\n")
    kept = (one if one.isprintable() or one in "\n\t" else ascii(one)[1:-1] for one in text)
    return "".join(kept)
