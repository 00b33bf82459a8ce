"""All files that are shipped are what the exported JSON schemas say, in editors of YAML 1.1 and of 1.2."""

import json
from pathlib import Path

import pytest
import small_programs
import yaml

jsonschema = pytest.importorskip("jsonschema")

from edl6dof.api.schema_files import SCHEMAS  # noqa: E402
from edl6dof.config.document.yamltree import parse_yaml, read_scalar, write_scalar  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
FILES = {
    "scenario": [
        path for path in sorted((ROOT / "scenarios").rglob("*.yaml")) if path.parent.name != "plugin"
    ],
    "vehicle": sorted((ROOT / "vehicles").rglob("*.yaml")),
    "planet": sorted((ROOT / "edl6dof/data/planets").glob("*.yaml")),
}


class Editor(yaml.SafeLoader):
    """The older YAML of many editors, told of the tag ``!replace``."""


Editor.add_constructor("!replace", lambda loader, node: loader.construct_sequence(node, deep=True))

#: How text is read: by the older YAML of many editors, and by the newer one of this package.
READERS = {"1.1": lambda text: yaml.load(text, Editor), "1.2": lambda text: parse_yaml(text, "").data}


@pytest.fixture(scope="module")
def validators():
    made = {kind: make() for kind, make in SCHEMAS.items()}
    for schema in made.values():
        jsonschema.Draft7Validator.check_schema(schema)
    return {kind: jsonschema.Draft7Validator(schema) for kind, schema in made.items()}


@pytest.mark.parametrize("version", [pytest.param("1.1", marks=pytest.mark.long), "1.2"])
@pytest.mark.parametrize("kind", SCHEMAS)
def test_shipped_files_are_valid(validators, kind, version):
    assert len(FILES[kind]) > 4
    for path in FILES[kind]:
        data = READERS[version](path.read_text(encoding="utf-8"))
        found = [
            f"{list(one.absolute_path)}: {one.message[:100]}" for one in validators[kind].iter_errors(data)
        ]
        assert found == [], path.name


def test_a_change_of_one_item_is_valid_without_all_that_a_whole_item_needs(validators):
    change = {"extends": "tianwen1", "vehicle": {"parachutes": [{"name": "main", "drag_coefficient": 0.6}]}}
    assert not [one.message for one in validators["scenario"].iter_errors(change) if "parachutes" in one.path]


@pytest.mark.parametrize(
    "kind, bad",
    [
        ("scenario", {"simulation": {"step_s": 1.0}}),
        ("scenario", {"simulatoin": {}}),
        ("scenario", {"seed": -1}),
        ("scenario", {"seed": "1"}),
        ("scenario", {"wind": {"model": "gale"}}),
        ("scenario", {"campaign": {"cases": 0}}),
        ("scenario", {"mission": {"phases": [{"name": "a", "control": True}]}}),
        ("vehicle", {"mass": "heavy"}),
        ("planet", {"mu_m3_s2": -1.0}),
    ],
)
def test_what_the_program_refuses_is_invalid(validators, kind, bad):
    data = READERS["1.2"](FILES[kind][0].read_text(encoding="utf-8"))
    assert validators[kind].is_valid(data)
    assert not validators[kind].is_valid({**data, **bad})


def test_a_scenario_needs_its_start_and_may_hold_its_vehicle(validators):
    scenario, vehicle = (
        READERS["1.2"](FILES[kind][0].read_text(encoding="utf-8")) for kind in ("scenario", "vehicle")
    )
    assert validators["scenario"].is_valid({**scenario, "vehicle": vehicle})
    assert not validators["scenario"].is_valid({**scenario, "vehicle": {**vehicle, "mass": "heavy"}})
    del scenario["initial"]
    assert not validators["scenario"].is_valid(scenario)


def test_members_of_plugins_are_in_the_schema_of_their_scenario():
    file = ROOT / "scenarios/plugin/energy_law.yaml"
    words = ["edl6dof", "schema", str(file)]
    found = small_programs.run(
        f"import sys; sys.argv = {words!r}; from edl6dof.cli import main; main()", cwd=ROOT
    )
    schema = json.loads(found.stdout)
    assert jsonschema.Draft7Validator(schema).is_valid(yaml.safe_load(file.read_text(encoding="utf-8")))


@pytest.mark.parametrize("value", ["off", "On", "no", "yes", 1e-5, 1e16, 2.5e-7, 3, 0.25, "1e5", "text"])
def test_what_is_written_is_read_alike_by_both(value):
    text = write_scalar(value)
    assert yaml.safe_load(text) == value
    assert (json.loads(text) if text.startswith('"') else read_scalar(text)) == value
