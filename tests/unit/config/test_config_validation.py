"""Messages for documents that the model refuses."""

from __future__ import annotations

import pytest
from config_toy import GOOD, LEAST, Toy, document, load

from edl6dof.config.document.document import Document
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.validate import validate


def problems(text: str) -> list[Problem]:
    with pytest.raises(ConfigError) as caught:
        load(text)
    return list(caught.value.problems)


def test_a_good_document_becomes_an_instance():
    toy = load(GOOD)
    assert toy.vehicle.mass.entry_mass_kg == 1285.0
    assert isinstance(toy.vehicle.mass.entry_mass_kg, float)
    assert toy.vehicle.mass.cg_m == (0.0, 0.0, 0.15)
    assert toy.vehicle.rcs.thrusters[1].name == "D8"
    assert toy.guidance.law == "apollo"
    assert toy.stop_s == 1000.0


#: text in front of LEAST -> key of the only problem, and its exact message
TOP = {
    "sed: 1": ("sed", "unknown key; did you mean 'seed'?"),
    "window_m: [0, 1]": ("window_m", "unknown key; did you mean 'window_s'? (only the unit suffix differs)"),
    "window: [0, 1]": ("window", "unknown key; did you mean 'window_s'? (only the unit suffix differs)"),
    "stop_s: '12'": (
        "stop_s",
        "must be a number in s or null (got '12'); write the number without quotes or underscores",
    ),
    "stop_s: 1_000": (
        "stop_s",
        "must be a number in s or null (got '1_000'); write the number without quotes or underscores",
    ),
    "stop_s: true": ("stop_s", "must be a number in s or null (got true)"),
    "stop_s: [1]": ("stop_s", "must be a number in s or null (got [1])"),
    "stop_s: 0": ("stop_s", "must be > 0 s (got 0)"),
    "seed: 1.5": ("seed", "must be a whole number (got 1.5)"),
    "seed: 100000000000000000000": (
        "seed",
        "must be >= 0 and <= 9223372036854775807 (got 100000000000000000000)",
    ),
    "seed: -1": ("seed", "must be >= 0 (got -1)"),
    "seed:": ("seed", "must be a whole number (got nothing)"),
    "logging: on": ("logging", "must be true or false (got 'on')"),
    "logging: 1": ("logging", "must be true or false (got 1)"),
    "title: 12": ("title", "must be text (got 12)"),
    "title: {a: 1}": ("title", "must be text (got a mapping of keys)"),
    "method: hun": ("method", "unknown name; did you mean 'heun'? (got 'hun'; allowed rk4, euler, heun)"),
    "method: 4": ("method", "unknown name (got 4; allowed rk4, euler, heun)"),
    "window_s: [1]": ("window_s", "must be a list of 2 numbers in s (got [1], 1 entries)"),
    "window_s: [1, 2, 3]": ("window_s", "must be a list of 2 numbers in s (got [1, 2, 3], 3 entries)"),
    "window_s: []": ("window_s", "must be a list of 2 numbers in s (got [], 0 entries)"),
    "window_s: 3": ("window_s", "must be a list of 2 numbers in s (got 3)"),
    "window_s: [1, x]": ("window_s.1", "must be a number in s (got 'x')"),
    "window_s: [2, 1]": ("", "window_s: the first time must be before the last"),
    "guidance: {law: apolo}": (
        "guidance.law",
        "unknown name; did you mean 'apollo'? (got 'apolo'; allowed apollo, predictor)",
    ),
    "guidance: {gain: 1}": (
        "guidance",
        "needs the key 'law', which says which kind it is (allowed apollo, predictor)",
    ),
    "guidance: {law: predictor, gain: 1}": ("guidance.gain", "unknown key; allowed: law, step_s"),
    "guidance: {law: predictor, step_s: 0}": ("guidance.step_s", "must be > 0 s (got 0)"),
    "guidance: apollo": ("guidance", "must be a mapping of keys (got 'apollo')"),
    "rate_hz: manual": ("rate_hz", "must be a number in Hz or 'auto' (got 'manual')"),
    "limit_deg: x": ("limit_deg", "must be a number in deg or a list of numbers in deg or null (got 'x')"),
    "limit_deg: [1, x]": ("limit_deg.1", "must be a number in deg (got 'x')"),
    "rate_hz: 0": ("rate_hz", "must be > 0 Hz (got 0)"),
    "gains: {a: x}": ("gains.a", "must be a number (got 'x')"),
    "gains: [1]": ("gains", "must be a mapping of keys (got [1])"),
}


@pytest.mark.parametrize("line", TOP)
def test_each_mistake_has_one_problem_in_plain_words(line):
    (problem,) = problems(f"{line}\n{LEAST}")
    assert (problem.path, problem.message) == TOP[line]
    assert (problem.file, problem.line) == ("toy.yaml", 1)


VEHICLE = {
    "vehicle: {}": ("vehicle.mass", "required key is missing: mass properties"),
    "vehicle: 3": ("vehicle", "must be a mapping of keys (got 3)"),
    "vehicle: {mass: {}}": ("vehicle.mass.entry_mass_kg", "required key is missing: mass at entry, in kg"),
    "vehicle: {mass: {entry_mass_kg: '1.1'}}": (
        "vehicle.mass.entry_mass_kg",
        "must be a number in kg (got '1.1'); write the number without quotes or underscores",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, chute: {deploy_mach: 17}}": (
        "vehicle.chute.deploy_mach",
        "must be > 0 and <= 2.5 (got 17)",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, chute: {drag_table: [[1, 2], [3]]}}": (
        "vehicle.chute.drag_table.1",
        "must be a list of 2 numbers (got [3], 1 entries)",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, rcs: {thrusters: {}}}": (
        "vehicle.rcs.thrusters",
        "must be a list of mappings (got a mapping of keys)",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, rcs: {thrusters: [1]}}": (
        "vehicle.rcs.thrusters.0",
        "must be a mapping of keys (got 1)",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, rcs: {thrusters: [{name: a, position_m: [0, 0, x]}]}}": (
        "vehicle.rcs.thrusters.0.position_m.2",
        "must be a number in m (got 'x')",
    ),
    "vehicle: {mass: {entry_mass_kg: 1}, rcs: {thrusters: [{}, {}, {}, {}]}}": (
        "vehicle.rcs.thrusters",
        "must have at most 3 entries (got 4)",
    ),
}


@pytest.mark.parametrize("line", VEHICLE)
def test_nested_mistakes_are_named_by_their_dotted_path(line):
    (problem,) = problems(line + "\n")
    assert (problem.path, problem.message) == VEHICLE[line]


def test_all_problems_are_reported_at_once_in_the_order_of_the_lines():
    found = problems(
        "sed: 1\nmethod: hun\nvehicle:\n  mass:\n    entry_mass_kg: x\n    cg_m: [1]\n  rcs:\n    "
        "thrusters:\n    - {name: 3}\n"
    )
    assert [(problem.line, problem.column, problem.path) for problem in found] == [
        (1, 1, "sed"),
        (2, 1, "method"),
        (5, 5, "vehicle.mass.entry_mass_kg"),
        (6, 5, "vehicle.mass.cg_m"),
        (9, 7, "vehicle.rcs.thrusters.0.position_m"),
        (9, 8, "vehicle.rcs.thrusters.0.name"),
    ]


def test_a_short_list_of_wrong_items_reports_both():
    assert [problem.path for problem in problems(f"window_s: [x]\n{LEAST}")] == ["window_s", "window_s.0"]


def test_a_missing_key_points_at_its_parent():
    (problem,) = problems("title: x\nvehicle:\n  mass:\n    cg_m: [0, 0, 0]\n")
    assert (problem.line, problem.column) == (3, 3)


def test_a_problem_prints_as_one_line_with_place_and_key():
    (problem,) = problems(f"stop_s: -1\n{LEAST}")
    assert str(problem) == "toy.yaml:1:1: stop_s: must be > 0 s (got -1)"


def test_a_document_made_in_memory_needs_no_marks():
    assert validate(Toy, Document({"vehicle": {"mass": {"entry_mass_kg": 5}}})).seed == 1
    with pytest.raises(ConfigError, match=r"^\(configuration\): sed: unknown key"):
        validate(Toy, Document({"sed": 1, "vehicle": {"mass": {"entry_mass_kg": 5}}}))


def test_no_message_shows_pydantic_words():
    everything = [problem.message for line in TOP for problem in problems(f"{line}\n{LEAST}")]
    everything += [problem.message for line in VEHICLE for problem in problems(line + "\n")]
    assert not [
        text for text in everything if "Input should" in text or "pydantic" in text or "Extra inputs" in text
    ]


def test_decimal_fractions_keep_their_bits():
    for number in (
        "0.1",
        "1.7976931348623157e308",
        "5e-324",
        "123456789.12345678",
        "2.2250738585072014e-308",
    ):
        assert load(f"gains: {{a: {number}}}\n{LEAST}").gains["a"] == float(number)


def test_reading_does_not_change_the_document():
    read = document()
    before = repr(read.data)
    validate(Toy, read)
    assert repr(read.data) == before
