"""``edl6dof params`` and ``schema``."""

from __future__ import annotations

import json
from typing import Any

import pytest
import yaml
from cli_run import ROOT, run

from edl6dof.app.inspect import scenario_schema


def test_section_shows_everything_about_its_parameters(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "params", "vehicle.parachutes")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert "vehicle.parachutes[]" in lines
    first = next(i for i, line in enumerate(lines) if line.startswith("  mortar_speed_m_s "))
    assert lines[first].split() == ["mortar_speed_m_s", "30.0", "m/s", ">", "0,", "<=", "100000"]
    assert lines[first + 1].strip() == "speed of the pack relative to the vehicle at mortar fire (estimate)"
    assert "initial" not in out


def test_every_parameter_is_legible_on_80_columns(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params")
    assert code == 0
    too_wide = [line for line in out.splitlines() if len(line) > 80 and " " in line.strip()]
    assert not too_wide
    assert "\x1b" not in out


@pytest.mark.parametrize(
    "path",
    [
        "vehicle.rcs.thrusters",
        "vehicle.rcs.thrusters[]",
        "vehicle.rcs.thrusters.0",
        "vehicle.rcs.thrusters[].thrust_n",
    ],
)
def test_list_items_are_found_by_any_spelling(path, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", path)
    assert code == 0
    assert "thrust_n" in out


def test_one_parameter(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "simulation.step_s")
    assert code == 0
    assert out.splitlines()[0] == "simulation"
    assert out.splitlines()[1].split() == ["step_s", "0.02", "s", ">=", "0.0001,", "<=", "0.1"]
    assert len(out.splitlines()) == 3


def test_part_of_a_name_finds_it_anywhere(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "MORTAR_speed")
    assert code == 0
    assert "vehicle.parachutes[]" in out
    assert "mortar_speed_m_s" in out


def test_unknown_path_names_the_nearest(capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "params", "vehicle.parashute")
    assert (code, out) == (2, "")
    assert "did you mean 'vehicle.parachutes'?" in err
    assert len(err.splitlines()) == 1


def test_json_has_the_same_rows(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "params", "vehicle.parachutes", "--json")
    assert code == 0
    found = {row["path"]: row for row in json.loads(out)}
    assert found["vehicle.parachutes[].mortar_speed_m_s"] == {
        "path": "vehicle.parachutes[].mortar_speed_m_s",
        "type": "number",
        "unit": "m/s",
        "bounds": "> 0 and <= 100000",
        "default": "30.0",
        "meaning": "speed of the pack relative to the vehicle at mortar fire",
        "status": "estimate",
        "source": "",
        "printed": "",
    }
    assert all(path.startswith("vehicle.parachutes[]") for path in found)


SHIPPED = sorted((ROOT / "scenarios").glob("*.yaml"))
SCHEMA = scenario_schema()


class _Core(yaml.SafeLoader):
    """YAML 1.1 reads ``off`` as false and ``1e5`` as text; editors and this package read YAML 1.2."""


_Core.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in rules if tag != "tag:yaml.org,2002:bool" or first in "tTfF"]
    for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
}


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_schema_accepts_shipped_scenarios(path):
    assert list(faults(yaml.load(path.read_text(encoding="utf-8"), _Core), SCHEMA)) == []


@pytest.mark.parametrize("path", sorted((ROOT / "vehicles").glob("*.yaml")), ids=lambda path: path.stem)
def test_schema_accepts_shipped_vehicles(path):
    vehicle = SCHEMA["properties"]["vehicle"]["anyOf"][1]
    assert list(faults(yaml.load(path.read_text(encoding="utf-8"), _Core), vehicle)) == []


def test_schema_refuses_what_the_program_refuses():
    good = yaml.load(SHIPPED[0].read_text(encoding="utf-8"), _Core)
    for bad in (
        {"seed": -1},
        {"seed": "1"},
        {"simulatoin": {}},
        {"simulation": {"step_s": 1.0}},
        {"wind": {"model": "gale"}},
    ):
        assert list(faults({**good, **bad}, SCHEMA)), bad
    assert list(faults({key: value for key, value in good.items() if key != "initial"}, SCHEMA))


def test_schema_describes_units_for_editors():
    text = json.dumps(SCHEMA)
    assert "integration step [s]" in text
    assert '"record"' not in text


def faults(value: Any, schema: dict[str, Any], path: str = "") -> Any:
    """The part of JSON schema draft 7 that pydantic writes; yields the paths that are refused."""
    if "$ref" in schema:
        yield from faults(
            value,
            SCHEMA["definitions" if "definitions" in SCHEMA else "$defs"][schema["$ref"].split("/")[-1]],
            path,
        )
        return
    if "anyOf" in schema:
        tried = [list(faults(value, option, path)) for option in schema["anyOf"]]
        if all(tried):
            yield from min(tried, key=len)
        if "properties" not in schema:
            return
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "integer": int,
        "number": (int, float),
        "boolean": bool,
        "null": type(None),
    }
    kind = schema.get("type")
    if kind and (
        not isinstance(value, kinds[kind]) or isinstance(value, bool) and kind in ("integer", "number")
    ):
        yield f"{path}: not {kind}"
        return
    if ("enum" in schema and value not in schema["enum"]) or ("const" in schema and value != schema["const"]):
        yield f"{path}: not allowed"
    for word, broken in {
        "minimum": lambda limit: value < limit,
        "maximum": lambda limit: value > limit,
        "exclusiveMinimum": lambda limit: value <= limit,
        "exclusiveMaximum": lambda limit: value >= limit,
        "minItems": lambda limit: len(value) < limit,
        "maxItems": lambda limit: len(value) > limit,
        "minLength": lambda limit: len(value) < limit,
    }.items():
        if word in schema and broken(schema[word]):
            yield f"{path}: {word}"
    if isinstance(value, dict):
        known, more = schema.get("properties", {}), schema.get("additionalProperties", True)
        yield from (f"{path}.{key}: missing" for key in schema.get("required", []) if key not in value)
        for key, item in value.items():
            if key in known:
                yield from faults(item, known[key], f"{path}.{key}")
            elif more is False:
                yield f"{path}.{key}: unknown"
            elif isinstance(more, dict):
                yield from faults(item, more, f"{path}.{key}")
    if isinstance(value, list):
        items = schema.get("items", {})
        for index, item in enumerate(value):
            yield from faults(item, items[index] if isinstance(items, list) else items, f"{path}.{index}")
