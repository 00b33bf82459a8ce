"""Every parameter of the scenario tells what it means, in which unit, and what kind of claim its value is."""

from typing import get_args

import pytest

from edl6dof.config.base import Status
from edl6dof.config.parameter_table import rows
from edl6dof.config.units import UNITS, split_unit
from edl6dof.scenario.schema import Scenario

ROWS = rows(Scenario)
#: Words that say a unit which the name does not carry.
SPOKEN = ("1/s", "1/s2", "1/s3", "m/s", "kg/m3", "W/m2", "N m s", "per degree", "rad/s", "km/s")


def last(path):
    return path.replace("[]", "").split(".")[-1]


def test_the_walk_reaches_all_parts_of_a_scenario():
    assert len(ROWS) > 250
    heads = {row.path.split(".")[0] for row in ROWS}
    parts = "planet atmosphere wind terrain vehicle initial simulation flight_software mission limits"
    assert set(parts.split()) <= heads


def test_every_parameter_has_a_meaning():
    assert [row.path for row in ROWS if len(row.meaning.strip()) < 4] == []


def test_every_parameter_has_a_known_status():
    assert [(row.path, row.status) for row in ROWS if row.status not in get_args(Status)] == []


def test_published_default_names_its_source():
    """A number that claims to be printed somewhere says where; required values carry their source in the
    YAML.
    """
    unsourced = [
        r.path
        for r in ROWS
        if r.status == "published" and not r.source and r.default not in ("required", "null", "{}")
    ]
    assert unsourced == []


def test_every_number_has_a_unit_of_the_table_or_is_dimensionless():
    labels = {unit.label for unit in UNITS.values()} | {""}
    assert [row.path for row in ROWS if row.unit not in labels] == []


def test_name_with_a_unit_suffix_shows_that_unit():
    for row in ROWS:
        unit = split_unit(last(row.path))[1].label
        if "number" in row.type and unit:
            assert row.unit == unit, row.path


def test_numbers_whose_meaning_speaks_of_a_unit_carry_it_in_the_name():
    """A meaning that ends in a unit belongs to a name without suffix only when the table of suffixes lacks
    that unit.
    """
    labels = {unit.label for unit in UNITS.values() if unit.label}
    wrong = []
    for row in ROWS:
        tail = row.meaning.rsplit(", ", 1)[-1]
        if "number" in row.type and not row.unit and tail in labels:
            wrong.append((row.path, tail))
    assert wrong == []


def test_unit_in_the_name_does_not_contradict_the_meaning():
    """``growth per km/s`` cannot be in km."""
    per = [text for unit in SPOKEN for text in (f"per {unit}", f"per ({unit})")]
    wrong = [row.path for row in ROWS if row.unit and any(text in row.meaning for text in per)]
    assert wrong == []


def test_bounds_of_each_number_are_met_by_its_default():
    from edl6dof.config.base import Params  # the models validate their defaults; building them is the check

    def build(model):
        for info in model.model_fields.values():
            if isinstance(info.annotation, type) and issubclass(info.annotation, Params):
                build(info.annotation)
        if not any(info.is_required() for info in model.model_fields.values()):
            model()

    build(Scenario)


@pytest.mark.parametrize(
    "name, label", [("rate_deg_s", "deg/s"), ("mass_kg", "kg"), ("gain", ""), ("stiffness_n_m", "N/m")]
)
def test_longest_suffix_decides_the_unit(name, label):
    assert split_unit(name)[1].label == label
