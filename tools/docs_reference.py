"""Generated pages of the documentation: the reference, made from the program itself (parameters, telemetry,
records, figures, commands), and the notebooks.

    python tools/docs_reference.py FOLDER       writes them there; the site makes them as it is built
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import chain, groupby
from pathlib import Path
from typing import Any

from docs_notebooks import pages as notebooks
from docs_records import INTRODUCTION, RECORDS, fields

from edl6dof.config.parameter_table import Row, rows

#: Pages of parameters: file, title, dotted paths whose parameters are on it; the first page that fits has it.
PARAMETERS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("planet", "Planet", ("planet",)),
    ("environment", "Air, wind, ground", ("atmosphere", "wind", "terrain")),
    ("aerodynamics", "Aerodynamics of the vehicle", ("vehicle.aero",)),
    ("vehicle", "Vehicle", ("vehicle",)),
    ("sensors", "Sensors", ("sensors",)),
    ("navigation", "Navigation", ("flight_software.navigation",)),
    ("guidance", "Guidance", ("flight_software.guidance",)),
    (
        "control",
        "Control, allocation, modulation, diagnosis",
        (
            "flight_software.control",
            "flight_software.allocation",
            "flight_software.modulation",
            "flight_software.estimation",
            "flight_software.diagnosis",
        ),
    ),
    ("flight_software", "Other flight software", ("flight_software",)),
    ("mission", "Mission, limits, published values", ("mission", "limits", "published", "flown")),
    ("faults", "Faults", ("faults",)),
    (
        "campaign",
        "Campaigns, sweeps, fault matrices, calibration",
        ("campaign", "sweep", "fault_matrix", "calibration"),
    ),
    ("scenario", "Scenario", ("",)),
)

#: Explanation of keys at the top of a scenario that the tables do not contain.
_EXTENDS = (
    "`extends: NAME` starts from another scenario; values in this file replace those of the other, and items "
    "of lists replace those with the same `name`. `edl6dof params PATH` prints these tables, and "
    "`edl6dof schema` the JSON schema for an editor."
)

_STATUS = (
    "The brackets give the origin of a value: *published*, *derived* from published values, *recalled* from "
    "memory, *estimate* or *calibrated*. A value without brackets is a choice of this software."
)


@lru_cache(maxsize=1)
def pages() -> dict[str, str]:
    """All generated pages: path inside the site, and Markdown."""
    made = {f"reference/{name}.md": text for name, text in _parameter_pages()}
    made["reference/records.md"] = records_page()
    made["reference/telemetry.md"] = telemetry_page()
    made["reference/figures.md"] = figures_page()
    made["reference/commands.md"] = commands_page()
    return made | notebooks()


def _all_rows() -> list[Row]:
    from edl6dof.api.schema_files import OTHER_SECTIONS
    from edl6dof.scenario.schema import Scenario

    return [*rows(Scenario), *chain(*map(rows, OTHER_SECTIONS))]


def _parameter_pages() -> Iterator[tuple[str, str]]:
    left = _all_rows()
    for name, title, prefixes in PARAMETERS:
        mine = [row for row in left if any(_below(row.path, prefix) for prefix in prefixes)]
        left = [row for row in left if row not in mine]
        note = _EXTENDS if name == "scenario" else _STATUS
        yield name, f"# {title}\n\n{note}\n\n" + "\n\n".join(_sections(mine)) + "\n"


def _below(path: str, prefix: str) -> bool:
    plain = path.replace("[]", "")
    return not prefix or f"{plain}.".startswith(f"{prefix}.")


def _sections(members: Iterable[Row]) -> Iterator[str]:
    found: dict[str, list[Row]] = {}
    for row in members:
        found.setdefault(row.path.rpartition(".")[0], []).append(row)
    for section, inside in found.items():
        title = f"## `{section}`\n\n" if section else ""
        yield title + table(("key", "default", "unit", "allowed", "meaning"), map(_parameter, inside))


def _parameter(row: Row) -> tuple[str, ...]:
    allowed = (
        row.bounds if row.type in ("number", "whole number") else f"{row.type}; {row.bounds}".strip("; ")
    )
    claim = ": ".join(part for part in (row.status, row.source) if part)
    meaning = f"{row.meaning} ({claim})" if claim and claim != "design" else row.meaning
    return f"`{row.path.rpartition('.')[2]}`", f"`{row.default}`", row.unit, allowed, meaning


def records_page() -> str:
    """Every record that a law, controller, estimator, filter or sensor reads or writes, field by field."""
    text = ["# Records", INTRODUCTION]
    for title, members in RECORDS.items():
        text.append(f"## {title}")
        for module, name, use in members:
            body = [
                (f"`{f.path}{list(f.shape) or ''}`", f.unit, f.frame, f.meaning) for f in fields(module, name)
            ]
            text.append(
                f"### `{name}`\n\n{use[0].upper()}{use[1:]}. Declared in `{module.replace('.', '/')}.py`.\n\n"
                + table(("field", "unit", "frame", "meaning and sign"), body)
            )
    return "\n\n".join(text) + "\n"


def telemetry_page() -> str:
    """Every telemetry channel, by group."""
    from edl6dof.telemetry.channels import BRIEF_CHANNELS, CHANNELS
    from edl6dof.telemetry.columns import describe

    brief = {channel.name for channel in BRIEF_CHANNELS}
    text = [
        "# Telemetry\n\nThese are the columns of `telemetry.parquet` and the keys of `flight.telemetry`, in "
        "addition to `t_s`. The suffix of a name is its unit. A flight of a campaign records the columns "
        "marked *brief* and stores only figures derived from them. The flight computer does not know "
        "`truth`; `nav`, `guide`, `control`, `estimate` and `diagnosis` are its own values; `nav.error_*` is "
        "the difference of the two."
    ]
    for group, members in groupby(CHANNELS, key=lambda channel: channel.group):
        body = [(f"`{c.name}`", c.unit, c.meaning, "yes" if c.name in brief else "") for c in members]
        text.append(f"## `{group}`\n\n" + table(("column", "unit", "meaning", "brief"), body))
    named = (
        "rcs.NAME",
        "fault.NAME",
        "valve.NAME",
        "range.NAME_m",
        "used.NAME_kg",
        "metered.NAME_kg",
        "expected.NAME_kg_s",
    )
    body = [(f"`{name}`", *describe(name)) for name in named]
    text.append(
        "## Of each thruster, radar beam and propellant branch\n\n"
        + table(("column", "unit", "meaning"), body)
    )
    return "\n\n".join(text) + "\n"


def figures_page() -> str:
    """Every figure of merit."""
    from edl6dof.metrics.figures import BALANCES, FIGURES

    body = [
        (f"`{f.name}`", f.unit.label, f.meaning, f.source, f"`limits.{f.limit}`" if f.limit else "")
        for f in FIGURES
        if f not in BALANCES
    ]
    body += [(f"`{f.name}`", f.unit.label, f.meaning, f.source, f"{f.allowed:g}, always") for f in BALANCES]
    return (
        "# Figures of merit\n\nThese are the keys of `flight.figures` and `summary.json`, the columns of a "
        "campaign's `cases.parquet`, and the names that `published` accepts. A figure of an event that a "
        "mission does not have is not computed.\n\n"
        + table(("figure", "unit", "meaning", "formed from", "limit"), body)
        + "\n"
    )


def commands_page() -> str:
    """Every command with its options, from the command line itself."""
    import typer

    from edl6dof.cli import app

    text = ["# Commands\n\n`edl6dof COMMAND --help` prints the same."]
    text += [_command(f"edl6dof {name}", command) for name, command in commands(typer.main.get_command(app))]
    return "\n\n".join(text) + "\n"


def commands(group: Any) -> Iterator[tuple[str, Any]]:
    """Name and click command of every command of a group, those of groups inside it with both names."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from ((f"{name} {inner}", found) for inner, found in commands(command))
        else:
            yield name, command


def _command(name: str, command: Any) -> str:
    shown_params = [p for p in command.params if not getattr(p, "hidden", False)]
    arguments = " ".join(_metavar(p) for p in shown_params if p.param_type_name == "argument")
    body = [_option(p) for p in shown_params]
    about = "\n\n".join(" ".join(part.split()) for part in (command.help or "").split("\n\n"))
    shown = [f"## `{name}`", f"    {name} {arguments}".rstrip(), about]
    if body:
        shown.append(table(("", "", "meaning"), body))
    return "\n\n".join(shown)


def _option(p: Any) -> tuple[str, str, str]:
    if p.param_type_name == "argument":
        return f"`{_metavar(p)}`", "", getattr(p, "help", "") or ""
    names = ", ".join(f"`{name}`" for name in (*p.opts, *p.secondary_opts))
    return names, "" if p.is_flag else f"`{_metavar(p)}`", getattr(p, "help", "") or ""


def _metavar(p: Any) -> str:
    return p.metavar or p.name.upper()


def table(head: tuple[str, ...], body: Iterable[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join([*lines, *("| " + " | ".join(_cell(cell) for cell in row) + " |" for row in body)])


def _cell(text: str) -> str:
    text = " ".join(text.split()).replace("|", "\\|")
    return text if text.startswith("`") else text.replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_")


if __name__ == "__main__":
    for path, content in pages().items():
        target = Path(sys.argv[1]) / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(content, encoding="utf-8")
