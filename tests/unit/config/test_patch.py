"""Numbers put into a validated model: the same model as validating all of it again, or a plain refusal."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import field_validator, model_validator

from edl6dof.config.base import REQUIRED, Params, Vec3, group, param
from edl6dof.config.dtype import dtype_of, fill, refill
from edl6dof.config.patch import LongWay, patched


class Jet(Params):
    name: str = param(REQUIRED, "name", record=False)
    thrust_n: float = param(1.0, "thrust", ge=0.0, le=10.0)
    direction: Vec3 = param((1.0, 0.0, 0.0), "direction")

    @field_validator("direction")
    @classmethod
    def _unit(cls, value):
        length = float(np.linalg.norm(value))
        return tuple(component / length for component in value)


class Body(Params):
    mass_kg: float = param(10.0, "mass", gt=0.0)
    fuel_kg: float = param(1.0, "fuel", ge=0.0)
    centre_m: Vec3 = param((0.0, 0.0, 0.1), "centre")
    sloshes: bool = param(False, "whether the fuel sloshes")
    engines: int = param(1, "engines", ge=0)
    spare_kg: float | None = param(None, "reserve", record=False, ge=0.0)

    @model_validator(mode="after")
    def _fuel_fits(self):
        if self.fuel_kg > self.mass_kg:
            raise ValueError("more fuel than mass")
        return self


class Craft(Params):
    body: Body = group(Body, "body")
    jets: list[Jet] = param(None, "jets", record=False, factory=list)


CRAFT = Craft.model_validate_json('{"jets": [{"name": "a"}, {"name": "b", "direction": [0, 3, 4]}]}')

CHANGES = {
    "number": ([(("body", "mass_kg"), 12.5)], '{"body": {"mass_kg": 12.5}, "jets": JETS}'),
    "whole number for a broken one": ([(("body", "mass_kg"), 12)], '{"body": {"mass_kg": 12}, "jets": JETS}'),
    "element": (
        [(("body", "centre_m", 2), 0.3), (("body", "centre_m", 0), -1)],
        '{"body": {"centre_m": [-1, 0, 0.3]}, "jets": JETS}',
    ),
    "all elements": (
        [(("body", "centre_m"), [1, 2.0, 3.0])],
        '{"body": {"centre_m": [1, 2, 3]}, "jets": JETS}',
    ),
    "switch and count": (
        [(("body", "sloshes"), True), (("body", "engines"), 3)],
        '{"body": {"sloshes": true, "engines": 3}, "jets": JETS}',
    ),
    "not given before": ([(("body", "spare_kg"), 2.0)], '{"body": {"spare_kg": 2}, "jets": JETS}'),
    "both sides of a check": (
        [(("body", "fuel_kg"), 20.0), (("body", "mass_kg"), 30.0)],
        '{"body": {"fuel_kg": 20, "mass_kg": 30}, "jets": JETS}',
    ),
    "item": (
        [(("jets", 1, "thrust_n"), 4.0)],
        '{"jets": [{"name": "a"}, {"name": "b", "direction": [0, 3, 4], "thrust_n": 4}]}',
    ),
}
JETS = '[{"name": "a"}, {"name": "b", "direction": [0, 3, 4]}]'


@pytest.mark.parametrize("changes, text", CHANGES.values(), ids=CHANGES)
def test_patched_model_equals_the_validated_one(changes, text):
    expected = Craft.model_validate_json(text.replace("JETS", JETS))
    found = patched(CRAFT, changes)
    assert found == expected
    assert repr(found) == repr(expected)  # 12 and 12.0 are equal, and are not the same


@pytest.mark.parametrize(
    "changes",
    [
        [(("body", "mass_kg"), -1.0)],
        [(("body", "mass_kg"), float("nan"))],
        [(("body", "mass_kg"), True)],
        [(("body", "mass_kg"), np.float64(3.0))],
        [(("body", "engines"), 1.5)],
        [(("body", "fuel_kg"), 11.0)],  # refused by the check of the whole
        [(("body", "weight_n"), 1.0)],
        [(("body", "centre_m", 3, 1), 1.0)],
        [(("body",), 1.0)],
        [(("jets", 2, "thrust_n"), 1.0)],
        [(("jets", 0, "name"), "c")],
        # brought to length one, which patching the normal form would not repeat
        [(("jets", 0, "direction", 0), 2.0)],
    ],
)
def test_what_patching_cannot_judge_goes_the_long_way(changes):
    with pytest.raises(LongWay):
        patched(CRAFT, changes)


def test_models_beside_the_way_are_shared():
    found = patched(CRAFT, [(("jets", 0, "thrust_n"), 2.0)])
    assert found.body is CRAFT.body and found.jets[1] is CRAFT.jets[1]
    assert CRAFT.jets[0].thrust_n == 1.0


def test_checks_before_validation_go_the_long_way():
    class Early(Params):
        x: float = 1.0

        @model_validator(mode="before")
        @classmethod
        def _shift(cls, data):
            return {"x": data["x"] + 1.0}

    with pytest.raises(LongWay):
        patched(Early(x=1.0), [(("x",), 2.0)])


def test_refilled_record_equals_a_filled_one():
    before, after = np.zeros(1, dtype_of(Body)), np.zeros(1, dtype_of(Body))
    fill(before[0], CRAFT.body)
    changed = patched(
        CRAFT.body, [(("mass_kg",), 3.0), (("centre_m", 1), 0.2), (("engines",), 0), (("sloshes",), True)]
    )
    refill(before[0], changed, CRAFT.body)
    fill(after[0], changed)
    assert before.tobytes() == after.tobytes()
