"""Scenario files: their mistakes, parameters, the shipped ones; plugins, and the consent to run them."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

from rich.console import Console
from rich.text import Text

from edl6dof.api.functions import load
from edl6dof.api.schema_files import OTHER_SECTIONS
from edl6dof.calibration.problem import calibration_of
from edl6dof.campaign.design.plan import plan_of
from edl6dof.cli.group import BAD_INPUT, NOT_WITHIN_LIMITS
from edl6dof.config.document.locate import find_shipped, resolve_scenario, shipped_names, shown
from edl6dof.config.document.source import parse_document, read_document
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.config.parameter_table import Value, rows, values
from edl6dof.config.plugin_files import accept, accepted_file, is_accepted
from edl6dof.config.validate import validate
from edl6dof.missions.flown import trajectory_of
from edl6dof.plugins import named_by, plugin_content, source_text
from edl6dof.report.parameters import print_values, select, selected, short
from edl6dof.report.terminal import open_table
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import CALIBRATION, CAMPAIGN_SECTIONS, load_document
from edl6dof.scenario.plugin_trial import try_on_plan
from edl6dof.scenario.schema import Scenario

if TYPE_CHECKING:
    from edl6dof.design.thruster_authority import Configuration


def check_files(files: Sequence[str], sets: Sequence[str]) -> int:
    """Validate each file and print every problem of every file; returns the exit status."""
    bad = False
    for name in files:
        try:
            loaded = _loaded(name, tuple(sets))
            try_on_plan(loaded.scenario)
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
    trajectory_of(document)
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
    declared = chain(rows(Scenario), *map(rows, OTHER_SECTIONS))
    table = [Value(row, row.default, row.path, "") for row in declared]
    found = selected(table, path, "edl6dof params")
    if as_json:
        print(json.dumps([one.row._asdict() for one in found], indent=1))
    else:
        print_values(found)


def show_values(name: str, path: str, sets: Sequence[str], as_json: bool) -> None:
    """Print the values of a scenario from ``path`` downwards, or whose path contains it."""
    table = [*_values(name, sets), *_values_of_many_flights(name)]
    if path in CAMPAIGN_SECTIONS and not select(table, path):
        words = f"{name} has no such section; edl6dof new campaign {name} writes a campaign"
        raise refusal(path, words)
    found = selected(table, path, f"edl6dof show {name}")
    if as_json:
        print(json.dumps([{**one.row._asdict(), **_given(one)} for one in found], indent=1))
    else:
        print_values(found)


def show_differences(names: tuple[str, str], path: str, sets: Sequence[str], as_json: bool) -> None:
    """Print the values in which two scenarios differ, and where each is given; ``sets`` are of the first."""
    one, two = _values(names[0], sets), _values(names[1], ())
    mine, other = ({value.row.path: value for value in table} for table in (one, two))
    units = {
        value.row.path: value.row.unit for value in selected([*one, *two], path, f"edl6dof show {names[0]}")
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
        shown = (f"{short(value.value)} {units[key]}".rstrip() if value else "-" for value in pair)
        console.print(f"{key}: {' | '.join(shown)}", markup=False)
        places = (value.origin if value else "-" for value in pair)
        console.print(f"    {' | '.join(places)}", style="dim", markup=False)


def show_vehicle(name: str, sets: Sequence[str], out: Path, force: bool, as_json: bool) -> None:
    """Draw the vehicle of a scenario, and print the authority of its thrusters."""
    from edl6dof.report.vehicle_drawing import NOTE, authority_tables

    vehicle = load(name, sets).vehicle
    vehicle.draw(out, force=force)
    states = vehicle.authority
    if as_json:
        print(json.dumps([_plain(state) for state in states], indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    for table in authority_tables(vehicle.params, states):
        shown = open_table(table.caption, *table.columns)
        for row in table.rows:
            shown.add_row(*map(str, row))
        console.print(shown)
    words = NOTE if states[0].groups else f"{vehicle.params.name} has no thrusters."
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


def _values_of_many_flights(name: str) -> Iterator[Value]:
    """Values of the sections of a scenario that a single flight does not read."""
    whole = read_document(resolve_scenario(name))
    for model in OTHER_SECTIONS:
        given = {key: whole.data[key] for key in model.model_fields if whole.data.get(key) is not None}
        if given:
            found = values(validate(model, replace(whole, data=given)), whole)
            yield from (
                one for one in found if one.row.path in given or one.row.path not in model.model_fields
            )


def _given(value: Value) -> dict[str, str]:
    return {"value": value.value, "origin": value.origin}


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
