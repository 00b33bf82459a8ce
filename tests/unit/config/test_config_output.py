"""What follows from a model besides the check: resolved YAML, reference table, JSON schema."""

from __future__ import annotations

import subprocess
import sys

import pytest
from config_toy import GOOD, LEAST, Toy, document, load
from pydantic import ValidationError

from edl6dof.config.base import Params, param
from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.document.source import parse_document
from edl6dof.config.dump import dump_resolved
from edl6dof.config.json_schema import json_schema
from edl6dof.config.parameter_table import rows
from edl6dof.config.validate import validate

TRICKY = LEAST + (
    "title: \"a: 'b' # [P] \\u2028 \\\\ é\"\n"
    "gains: {'1': 0.1, 'null': 1e22, 'x y': -0.0, 'a:b': 5e-324}\n"
    "guidance: {law: predictor, step_s: 0.30000000000000004}\n"
    "plugin: {list: [{a: []}, {}, 3, null, true, [1, [2]]], none: null, empty: {}, text: 'true'}\n"
)
LONG = LEAST.replace(
    "vehicle: {", "vehicle: {chute: {drag_table: [" + ", ".join(f"[{i}, 0.{i}]" for i in range(40)) + "]}, "
)
WIDE = LEAST + "plugin: {numbers: [" + ", ".join(f"{i}.125" for i in range(60)) + "]}\n"


@pytest.mark.parametrize(
    "text", [GOOD, LEAST, TRICKY, LONG, WIDE], ids=["good", "least", "tricky", "long table", "wide list"]
)
def test_a_resolved_scenario_reads_back_as_an_equal_model(text):
    read = document(text)
    toy = validate(Toy, read)
    dumped = dump_resolved(toy, ["edl6dof 0.1.0", "two\nlines"], read.status, read.sources)
    again = parse_document(dumped, "resolved.yaml")
    assert validate(Toy, again) == toy
    assert repr(validate(Toy, again)) == repr(toy)
    assert read.status.items() <= again.status.items()
    assert max(map(len, dumped.splitlines())) <= 130


def test_a_resolved_scenario_holds_every_default_in_declaration_order():
    lines = dump_resolved(load(LEAST), ["edl6dof 0.1.0"]).splitlines()
    assert lines[:4] == ["# edl6dof 0.1.0", "title: toy  # [S]", "seed: 1  # [S]", "method: rk4  # [S]"]
    assert "  chute:" in lines
    assert "    deploy_mach: 1.8  # [S]" in lines
    assert "    cg_m: [0.0, 0.0, 0.1]  # [E]" in lines


def test_marks_of_the_file_win_and_declared_ones_hold_only_for_the_default():
    text = LEAST.replace("1.0", "1.0, fuel_fraction: 0.25")
    assert "fuel_fraction: 0.25  # [P] S1 table 2" in dump_resolved(load(text))
    path = "vehicle.mass.fuel_fraction"
    assert "fuel_fraction: 0.25  # [E] guess" in dump_resolved(
        load(text), [], {path: "estimate"}, {path: "guess"}
    )
    assert "fuel_fraction: 0.5\n" in dump_resolved(load(text.replace("0.25", "0.5")))


def test_an_overridden_value_loses_the_mark_of_the_file():
    read = apply_overrides(document(), ["vehicle.mass.entry_mass_kg=1300"], Toy)
    assert "entry_mass_kg: 1300.0\n" in dump_resolved(validate(Toy, read), [], read.status, read.sources)


def test_the_reference_lists_every_parameter_with_unit_bounds_and_claim():
    table = {row.path: row for row in rows(Toy)}
    fuel = table["vehicle.mass.fuel_fraction"]
    assert fuel[1:] == (
        "number",
        "",
        ">= 0 and <= 1",
        "0.25",
        "fuel over mass",
        "published",
        "S1 table 2",
        "",
        "",
    )
    assert table["vehicle.mass.entry_mass_kg"][2:5] == ("kg", "> 0 and <= 1e+09", "required")
    assert table["vehicle.rcs.thrusters[]"].bounds == "at most 3 entries"
    assert table["vehicle.rcs.thrusters[].position_m"].type == "list of 3 numbers"
    assert table["stop_s"][1:5] == ("number or null", "s", "> 0 and <= 1e+09", "null")
    assert table["method"].type == "one of rk4, euler, heun"
    assert {"guidance.gain", "guidance.step_s"} <= set(table)
    assert next(iter(rows(Toy, "case"))).path == "case.title"


def test_every_row_of_the_reference_can_be_set():
    values = {"guidance.step_s": "guidance.law=predictor"}
    for row in rows(Toy):
        path = row.path.replace("[]", ".0") if not row.path.endswith("[]") else row.path.removesuffix("[]")
        before = [values[row.path]] if row.path in values else []
        apply_overrides(document(), [*before, f"{path}=1"], Toy)


def test_the_json_schema_serves_an_editor():
    schema = json_schema(Toy)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    assert schema["title"] == "Toy"
    kinds = schema["properties"]["vehicle"]["anyOf"]
    assert kinds[0]["type"] == "string"
    assert kinds[1]["$ref"] == "#/$defs/Vehicle"
    mass = schema["$defs"]["Mass"]["properties"]
    assert mass["entry_mass_kg"]["description"] == "mass at entry [kg] (design)"
    assert len(mass["cg_m"]["items"]) == 3
    assert "record" not in mass["cg_m"]
    assert schema["additionalProperties"] is False
    listed, by_name = schema["$defs"]["Rcs"]["properties"]["thrusters"]["anyOf"]
    assert listed["maxItems"] == 3 and by_name["type"] == "object"


def test_a_default_outside_its_own_bounds_is_refused():
    class Wrong(Params):
        mass_kg: float = param(0.0, "mass", gt=0)

    with pytest.raises(ValidationError):
        Wrong()


def test_reading_a_configuration_does_not_import_numpy():
    modules = ", ".join(
        f"edl6dof.config.{name}"
        for name in (
            "document.source",
            "document.overrides",
            "validate",
            "parameter_table",
            "dump",
        )
    )
    code = f"import sys, {modules}; sys.exit('numpy' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
