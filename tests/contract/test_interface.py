"""What crosses between plant and flight software stands in ``edl6dof/interface``, and there alone."""

import pytest
from source_rules import breaches, fields_without_meaning, imports, lists_of, modules, whole_number_names

from edl6dof.interface.effectors import ACTIONS, THRUSTER_GROUPS

INTERFACE = modules("interface")
ELSEWHERE = [(name, source) for name, source in modules() if name not in dict(INTERFACE)]
LISTS = {"actions": ACTIONS, "groups of thrusters": THRUSTER_GROUPS}
#: Names of numbers that stand in the interface.
NUMBERS = {name for _, source in INTERFACE for name in whole_number_names(source)}
#: Names that mean something else in one module.
OTHER_MEANING = {"edl6dof.vehicle.plant": {"ATTITUDE"}}  # where the attitude stands in the state


def test_there_is_something_to_check():
    assert {
        "MAX_THRUSTERS",
        "MAX_PHASES",
        "MAX_PARTS",
        "JETTISON",
        "AXIAL",
        "ENGINE_FULL",
    } <= NUMBERS
    assert len(ELSEWHERE) > 150


@pytest.mark.parametrize("folder", ["vehicle", "fsw"])
def test_both_sides_read_it(folder):
    read = {target for name, source in modules(folder) for _, target in imports(source, name)}
    assert {f"edl6dof.interface.{name}" for name in ("capacities", "effectors")} <= read


def test_it_knows_neither_side():
    def sides(name, source):
        ours = {target.split(".")[1] for _, target in imports(source, name) if target.startswith("edl6dof.")}
        return ours - {"interface", "records", "kernels"}

    assert breaches(sides, INTERFACE) == {}


def test_nothing_of_it_is_written_twice():
    def repeated(name, source):
        lists = {what for what, names in LISTS.items() if lists_of(source, names)}
        return (whole_number_names(source) & NUMBERS) - OTHER_MEANING.get(name, set()) | lists

    assert breaches(repeated, ELSEWHERE) == {}


def test_every_capacity_has_one_place():
    placed = [
        name for _, source in modules() for name in whole_number_names(source) if name.startswith("MAX_")
    ]
    assert len(placed) > 5
    assert sorted(placed) == sorted(set(placed))


@pytest.mark.parametrize("record", ["sensed", "command"])
def test_every_field_that_crosses_says_what_it_is(record):
    source = dict(INTERFACE)[f"edl6dof.interface.{record}"]
    assert fields_without_meaning(source) == []


@pytest.mark.parametrize(
    "planted, found",
    [
        ("MAX_THRUSTERS = 32", {"MAX_THRUSTERS"}),
        ("MAX_PHASES: int = 16", {"MAX_PHASES"}),
        ("ENTRY, UNDER_CHUTE, LANDER = range(3)", {"ENTRY", "UNDER_CHUTE", "LANDER"}),
        ("HEAT_SHIELD, BACKSHELL = 0, 1", {"HEAT_SHIELD", "BACKSHELL"}),
        ("(\n  CUT_OFF,\n) = range(len(EVENTS))", {"CUT_OFF"}),
        ("if True:\n    MORTAR = 1", {"MORTAR"}),
        ("ENTRY = 'guidance.entry'\nfrom a import MORTAR\ndef f():\n    LANDER = 2", set()),
    ],
)
def test_planted_number_is_found(planted, found):
    assert whole_number_names(planted) == found


@pytest.mark.parametrize(
    "planted, lines",
    [
        ('GROUPS = ("horizontal", "axial", "attitude", "fine")', [1]),
        ('class A:\n    group: Literal["fine", "axial", "horizontal", "attitude"] = 0', [2]),
        ('def f():\n    return ["horizontal", "axial", "attitude", "fine"]', [2]),
        ('GROUPS = ("horizontal", "axial")', []),
        ('GROUPS = {"horizontal": 1, "axial": 2, "attitude": 3, "fine": 4}', []),
    ],
)
def test_planted_list_is_found(planted, lines):
    assert lists_of(planted, THRUSTER_GROUPS) == lines


def test_planted_field_without_meaning_is_found():
    fields = '        ("t", "f8"),  # s\n        ("v", "f8", (3,)),\n'
    source = f"R = np.dtype(\n    [\n{fields}    ],\n    align=True,\n)\n"
    assert fields_without_meaning(source) == ["v"]
