"""One contract for every member of every family: its parameters, its source, its kernels and its name."""

import importlib
import inspect
import re
from typing import Literal, get_origin

import pytest
from source_rules import modules

from edl6dof.campaign.design.sections import DISTRIBUTIONS
from edl6dof.config.base import Params
from edl6dof.config.model_paths import bounds, field_slot
from edl6dof.environment.atmosphere_models import ATMOSPHERES
from edl6dof.environment.wind_models import WINDS
from edl6dof.fsw.allocation.registry import ALLOCATORS
from edl6dof.fsw.control.registry import CONTROLLERS
from edl6dof.fsw.estimation.registry import ESTIMATORS
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.hazard.registry import HAZARD_DETECTION
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.sensors.registry import SENSOR_FAMILY
from edl6dof.vehicle.faults.fault import FAULT_KINDS
from edl6dof.vehicle.parachutes.canopy_models import PARACHUTE_MODELS
from edl6dof.vehicle.propulsion.engine_models import ENGINE_MODELS

FAMILIES = (
    *(CONTROLLERS, ENTRY_LAWS, REVERSALS, POWERED_LAWS, ALLOCATORS, ESTIMATORS),
    *(ATMOSPHERES, WINDS, SENSOR_FAMILY, FAULT_KINDS, DISTRIBUTIONS),
    *(PARACHUTE_MODELS, ENGINE_MODELS, NAVIGATION_FILTERS, HAZARD_DETECTION),
)
MEMBERS = [(family, member) for family in FAMILIES for member in family.members]
#: Families whose members are a few lines each and share a file.
SHARED = (FAULT_KINDS, ATMOSPHERES, WINDS, DISTRIBUTIONS, PARACHUTE_MODELS, ENGINE_MODELS)
#: A law fills a file of its own.
LAWS = [(family, member) for family, member in MEMBERS if family not in SHARED]
CITED = [(family, member) for family, member in MEMBERS if family is not FAULT_KINDS]


def each(pairs):
    return pytest.mark.parametrize(
        "family, member", pairs, ids=[f"{family.title}: {member.name}" for family, member in pairs]
    )


def module_of(member):
    return inspect.getmodule(member.params)


def leaves(model, path=""):
    for name, info in model.model_fields.items():
        slot = field_slot(name, info)
        if slot.models:
            for sub in slot.models:
                yield from leaves(sub, f"{path}{name}.")
        else:
            yield f"{path}{name}", slot


def test_no_family_is_left_out():
    written = [name for _, text in modules() for name in re.findall(r"^(\w+) = Family\(", text, re.MULTILINE)]
    assert len(written) == len(FAMILIES) == len({family.title for family in FAMILIES}), written


@each(MEMBERS)
def test_every_parameter_is_documented_bounded_and_has_a_status(family, member):
    assert issubclass(member.params, Params)
    assert member.params.__doc__
    for path, slot in leaves(member.params):
        assert slot.info.description and len(slot.info.description) > 5, path
        assert slot.info.json_schema_extra["status"], path
        literal = any(get_origin(option) is Literal for option in slot.options)
        if family is DISTRIBUTIONS:
            continue  # its numbers have the unit and the bounds of what is dispersed
        bounded = bounds(slot) or bounds(slot.child(0) or slot)  # of a vector: its numbers
        assert literal or bool in slot.options or bounded, f"{path} has no bounds"


@each(MEMBERS)
def test_member_names_its_source_and_has_one_documented_kernel_for_each_role(family, member):
    assert member.source.strip()
    assert set(member.kernels) == {role for other in family.members for role in other.kernels}
    for kernel in member.kernels.values():
        assert kernel.py_func.__doc__
        assert kernel.py_func.__module__ == module_of(member).__name__


@each(LAWS)
def test_law_is_one_file(family, member):
    assert importlib.import_module(module_of(member).__name__).MEMBER is member
    assert [other for _, other in LAWS if module_of(other) is module_of(member)] == [member]


@each(CITED)
def test_source_is_cited_by_the_member_s_file(family, member):
    text = module_of(member).__doc__ or ""
    if "null member" in member.source or member.name == "off":
        return
    author = member.source.replace(",", " ").split()
    year = next(
        (
            word.strip("().;")
            for word in author
            if word.strip("().;").isdigit() and len(word.strip("().;")) == 4
        ),
        None,
    )
    assert "ource" in text or "eq" in text or (year and year in text), (  # codespell:ignore ource
        "the module's docstring mentions no source"
    )
    if year:
        whole = inspect.getsource(module_of(member))
        assert whole.count(year) >= 2 or author[0] in text


def test_names_are_unique_and_can_be_written_in_yaml():
    for family in FAMILIES:
        assert len(set(family.names)) == len(family.names)
        assert all(name.isidentifier() and name == name.lower() for name in family.names)
