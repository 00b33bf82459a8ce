"""Every number with a unit has bounds on both sides, and they hold: a leg of 10 km or a mass of a planet is a
mistake, not a vehicle.
"""

from __future__ import annotations

import math
import types
from collections.abc import Iterator
from typing import Annotated, Any, Union, get_args, get_origin

import pytest
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

import edl6dof
from edl6dof.campaign.design.sections import CampaignParams, SweepParams
from edl6dof.config.errors import ConfigError
from edl6dof.config.model_paths import Slot, bounds, field_slot, is_model
from edl6dof.config.units import DIMENSIONLESS, UNITS
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.vehicle import VehicleParams


def models(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """A model and all models inside it."""
    yield model
    for name, info in model.model_fields.items():
        for inner in models_in(field_slot(name, info)):
            yield from models(inner)


def models_in(slot: Slot) -> Iterator[type[BaseModel]]:
    yield from slot.models
    if (item := element(slot)) is not None:
        yield from models_in(item)


def element(slot: Slot) -> Slot | None:
    """The place of an item of a list or of a value of a mapping."""
    kinds = {get_origin(option) for option in slot.options}
    return slot.child(0) if kinds & {list, tuple} else slot.child("any") if dict in kinds else None


def numbers(slot: Slot) -> Iterator[Slot]:
    """Places of single numbers at or below a field, without those of models inside it."""
    if {float, int} & set(slot.options):
        yield slot
    if (item := element(slot)) is not None and not any(map(is_model, slot.options)):
        yield from numbers(item)


ALL = list(dict.fromkeys(one for root in (Scenario, CampaignParams, SweepParams) for one in models(root)))
FIELDS = [(model, name) for model in ALL for name in model.model_fields]
PLACES = [
    (model, name, place)
    for model, name in FIELDS
    for place in numbers(field_slot(name, model.model_fields[name]))
]


def limits(place: Slot) -> tuple[float, float]:
    found = bounds(place)
    return found.get("ge", found.get("gt", -math.inf)), found.get("le", found.get("lt", math.inf))


def filled(annotation: Any, number: float) -> Any:
    """A value of a type with ``number`` for each of its numbers."""
    origin, args = get_origin(annotation), get_args(annotation)
    if origin in (Union, types.UnionType):
        return filled(next(option for option in args if option is not type(None)), number)
    if origin is Annotated:
        return filled(args[0], number)
    if origin is tuple and args[-1] is not Ellipsis:
        return tuple(filled(item, number) for item in args)
    if origin in (list, tuple):
        return origin(filled(args[0], number) for _ in range(2))
    return int(number) if annotation is int else float(number)


def test_the_walk_finds_numbers_in_lists_of_lists():
    found = {f"{model.__name__}.{name}" for model, name, _ in PLACES}
    assert len(found) > 250
    assert {
        "LandingGearParams.footpads_m",
        "MassParams.entry_kg",
        "Thruster.position_m",
        "Part.inertia_kg_m2",
        "Scenario.seed",
    } <= found


def refuses(info: FieldInfo, number: float) -> bool:
    """Whether a field says of a number that it lies beyond its bounds."""
    check = TypeAdapter(Annotated[info.annotation, info], config=ConfigDict(strict=True))
    try:
        check.validate_python(filled(info.annotation, number))
    except ValidationError as error:
        return "less than" in str(error) or "greater than" in str(error)
    return False


def test_numbers_with_a_unit_and_whole_numbers_are_bounded_and_refused_beyond():
    unbounded, taken = [], []
    for model, name, place in PLACES:
        if place.unit == DIMENSIONLESS and float in place.options:
            continue
        low, high = limits(place)
        if not (math.isfinite(low) and math.isfinite(high)) or int in place.options and high >= 2**63:
            unbounded.append((model.__name__, name, low, high))
            continue
        beyond = (high + abs(high) + 1, low - abs(low) - 1)
        info = model.model_fields[name]
        taken += [(model.__name__, name, number) for number in beyond if not refuses(info, number)]
    assert unbounded == []
    assert taken == []


def test_nothing_of_a_vehicle_is_larger_than_a_ship():
    most = {UNITS["m"]: 200.0, UNITS["m2"]: 50e3}
    of_vehicle = set(models(VehicleParams))
    lengths = [case for case in PLACES if case[0] in of_vehicle and case[2].unit in most]
    assert len(lengths) > 20
    assert [
        (model.__name__, name, limits(place))
        for model, name, place in lengths
        if max(map(abs, limits(place))) > most[place.unit]
    ] == []


@pytest.mark.parametrize(
    ("override", "allowed"),
    [
        ("vehicle.landing_gear.footpads_m.0.0=10000", ">= -200 and <= 200 m"),
        (
            "vehicle.landing_gear.footpads_m=[[0, 1e4, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]]",
            ">= -200 and <= 200 m",
        ),
        ("vehicle.mass.entry_inertia_kg_m2.1=1e300", ">= -1e+10 and <= 1e+10 kg m2"),
        ("vehicle.mass.entry_kg=1e300", "> 0 and <= 1e+09 kg"),
        ("vehicle.aero.capsule.diameter_m=1e4", "> 0 and <= 200 m"),
        ("vehicle.rcs.thrusters.D7.position_m.2=-1e4", ">= -200 and <= 200 m"),
        ("seed=1000000000000000000000000000000", ">= 0 and <= 9223372036854775807"),
        ("seed=9223372036854775808", ">= 0 and <= 9223372036854775807"),
    ],
)
def test_what_is_beyond_is_refused_with_what_is_allowed(override, allowed):
    with pytest.raises(ConfigError) as caught:
        edl6dof.load("tianwen1", [override])
    (problem,) = caught.value.problems
    assert problem.message.startswith(f"must be {allowed} (got ")
