"""Lists in a file that extends another: items with names are merged, others replaced."""

from __future__ import annotations

import pytest
from config_toy import write

from edl6dof.config.document.overrides import apply_overrides
from edl6dof.config.document.source import parse_document, read_document
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario

BASE = """\
chutes:
  - {name: drogue, area: 1, when: {mach: 2, late: 9}}
  - name: main
    area: 5  # [P] S1
    lines: 6
vector: [1, 2]
"""


def extended(folder, text):
    write(folder, "base.yaml", BASE)
    return read_document(write(folder, "top.yaml", "extends: base.yaml\n" + text))


def problem(folder, text):
    with pytest.raises(ConfigError) as caught:
        extended(folder, text)
    (found,) = caught.value.problems
    return found.file.rsplit("/", 1)[-1], found.line, found.path, found.message


def test_named_items_are_laid_over_those_of_the_base_and_new_ones_follow(tmp_path):
    document = extended(
        tmp_path,
        "chutes:\n  - {name: new, area: 3}\n  - {name: main, lines: 7}\n"
        "  - {name: drogue, when: {mach: 1}}\n",
    )
    assert document.data["chutes"] == [
        {"name": "drogue", "area": 1, "when": {"mach": 1, "late": 9}},
        {"name": "main", "area": 5, "lines": 7},
        {"name": "new", "area": 3},
    ]
    places = {key: document.mark(("chutes", *key)) for key in ((1, "area"), (1, "lines"), (2, "area"))}
    assert [(mark.file.rsplit("/", 1)[-1], mark.line) for mark in places.values()] == [
        ("base.yaml", 4), ("top.yaml", 4), ("top.yaml", 3)
    ]  # fmt: skip
    assert document.status == {"chutes.1.area": "published"}


def test_an_item_of_a_similar_name_with_fewer_keys_is_noted(tmp_path):
    """One with all keys of the other is meant to be new."""
    assert extended(tmp_path, "chutes: [{name: maain, area: 3}]").similar == {("chutes", 2): "main"}
    assert not extended(tmp_path, "chutes: [{name: maain, area: 3, lines: 4}]").similar
    assert not extended(tmp_path, "chutes: [{name: pilot, area: 3}]").similar
    assert not extended(tmp_path, "chutes: !replace [{name: maain, area: 3}]").similar


def test_a_mapping_cannot_add_an_item(tmp_path):
    document = extended(tmp_path, "chutes: {maain: {area: 3}, drogue: {area: 2}}")
    assert [item["area"] for item in document.data["chutes"]] == [2, 5]
    ((path, (found,)),) = document.refused.items()
    assert (path, found.line, found.message) == (
        ("chutes", "maain"), 2, "no entry named 'maain'; did you mean 'main'?"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("item", "said"),
    [
        (
            "{name: P1x, thrust_n: 30}",
            "name: is a new entry; did you mean 'P1'? (a new one also needs group, ",
        ),
        (
            "{name: P5, group: fine, position_m: [0, 0, 1], direction: [0, 0, 1], thrust_n: 9, "
            "specific_impulse_s: 270, minimum_pulse_s: 0.04}",
            "name: must be on one of vehicle.rcs.branches (got P5 on none)",
        ),
    ],
)
def test_a_new_thruster_is_reported_where_it_stands(tmp_path, item, said):
    text = f"extends: tianwen1\nvehicle:\n  rcs:\n    thrusters:\n      - {item}\n"
    with pytest.raises(ConfigError) as caught:
        load_scenario(write(tmp_path, "mine.yaml", text))
    (found,) = caught.value.problems
    assert (found.file.rsplit("/", 1)[-1], found.line) == ("mine.yaml", 5)
    assert found.message.startswith(said.partition(": ")[2]) and found.path == "vehicle.rcs.thrusters.22.name"


def test_a_part_with_a_mistyped_name_gives_a_warning(tmp_path):
    text = "extends: tianwen1\nvehicle:\n  parts: [{name: heatshield, mass_kg: 3}]\n"
    (warning,) = load_scenario(write(tmp_path, "mine.yaml", text)).warnings
    assert warning.endswith("vehicle.parts.3.name: is a new entry; did you mean 'heat_shield'?")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("chutes: !replace [{name: main, area: 2}]", [{"name": "main", "area": 2}]),
        ("chutes: !replace []", []),
        ("chutes: []", []),
        ("chutes: [{area: 2}]", [{"area": 2}]),
        ("chutes: [{name: [main]}]", [{"name": ["main"]}]),
    ],
)
def test_a_list_is_replaced_where_that_is_said_or_names_are_missing(tmp_path, text, found):
    document = extended(tmp_path, text)
    assert document.data["chutes"] == found
    assert document.status == {}


def test_a_list_without_names_is_replaced(tmp_path):
    assert extended(tmp_path, "vector: [3]").data["vector"] == [3]
    assert extended(tmp_path, "vector: !replace [3]").data["vector"] == [3]


def test_a_name_given_twice_is_refused_where_it_stands(tmp_path):
    text = "chutes:\n  - {name: main, area: 2}\n  - {name: main, area: 3}\n"
    assert problem(tmp_path, text) == (
        "top.yaml", 4, "chutes.1.name", "name is given twice (first on line 3; got 'main')"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        ("sails: !replace []", "sails", "needs a list to replace"),
        ("chutes: !replace [{name: a, b: !replace [1]}]", "chutes.0.b", "needs a list to replace"),
        ("chutes: !replace {main: {area: 1}}", "chutes", "stands before a list only"),
        ("chutes: !other []", "chutes", "tags (!other) are not supported"),
    ],
)
def test_a_tag_that_means_nothing_is_refused_where_it_stands(tmp_path, text, path, words):
    file, line, where, message = problem(tmp_path, text)
    assert (file, line, where) == ("top.yaml", 2, path)
    assert words in message


def test_replace_needs_a_base(tmp_path):
    with pytest.raises(ConfigError, match=r"alone.yaml:1:1: chutes: !replace needs a list to replace"):
        read_document(write(tmp_path, "alone.yaml", "chutes: !replace []\n"))


def test_a_value_that_is_set_needs_no_replace():
    with pytest.raises(ConfigError, match="leave out !replace"):
        apply_overrides(parse_document("faults: []", "a.yaml"), ["faults=!replace []"], Scenario)


def test_a_parachute_over_that_of_tianwen1_keeps_its_size(tmp_path):
    text = "extends: tianwen1\nvehicle: {parachutes: [{name: main, drag_coefficient: 0.60}]}\n"
    (chute,) = read_document(write(tmp_path, "mine.yaml", text)).data["vehicle"]["parachutes"]
    assert (chute["drag_coefficient"], chute["diameter_m"], chute["line_length_m"]) == (0.60, 15.96, 31.15)
