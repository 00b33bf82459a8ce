"""Dispatch among interchangeable models: the integer of a record must reach the member it names.

Members return numbers that tell them apart (a square, a cube, ...), so a wrong branch shows as a wrong
number.  That a kernel with a dispatch inside can be cached on disk is shown with a second process and numba's
own count of cache hits.
"""

import os
from typing import ClassVar

import numpy as np
import pytest
import small_programs
from pydantic import ValidationError

from edl6dof.config.base import Params, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.kernels import kernel
from edl6dof.registry import Family, Member


@kernel
def square(x, y):
    return x * x + y


@kernel
def cube(x, y):
    return x * x * x + y


@kernel
def root(x, y):
    return x**0.5 + y


def of(*functions):
    """The choice among functions of x and y, as a family's."""
    members = [Member(f.__name__, Params, {"of": f}, "none") for f in functions]
    return Family("function", tuple(members)).switch("of", "x", "y")


POWERS = of(square, cube, root)
ONLY = of(cube)


@kernel
def through_a_kernel(index, x, y):
    return POWERS(index, x, y)


@kernel
def one_member(index, x, y):
    return ONLY(index, x, y)


@pytest.mark.parametrize("dispatch", [POWERS, through_a_kernel], ids=["from Python", "from a kernel"])
def test_the_index_reaches_its_member(dispatch):
    assert [dispatch(index, 4.0, 0.5) for index in range(3)] == [16.5, 64.5, 2.5]


class Gain(Params):
    "Gain."

    gain: float = param(1.0, "gain", ge=0.0)


COUNT = np.dtype([("calls", "i8")])


@kernel
def count_up(params, memory, x):
    memory.calls += 1
    return params.gain * x


@kernel
def count_down(params, memory, x):
    memory.calls -= 1
    return -params.gain * x


BOTH = Family(
    "counter",
    (
        Member("up", Gain, {"step": count_up}, "none", memory=COUNT),
        Member("down", Gain, {"step": count_down}, "none", memory=COUNT),
    ),
)
STEP = BOTH.switch("step", "params", "memory", "x", own=("params", "memory"))


@kernel
def each_its_own(params, memory, x):
    return STEP(0, params, memory, x), STEP(1, params, memory, x), STEP(0, params, memory, x)


def test_each_member_gets_its_own_parameters_and_memory():
    params = np.zeros(1, dtype_of(BOTH.params_model("BothParams", None, "", "Both.")))
    memory = np.zeros(1, BOTH.memory)
    params[0]["up"]["gain"], params[0]["down"]["gain"] = 2.0, 3.0
    assert each_its_own(params[0], memory[0], 5.0) == (10.0, -15.0, 10.0)
    assert (memory[0]["up"]["calls"], memory[0]["down"]["calls"]) == (2, -1)


class Needs(Params):
    gain: float = param(..., "gain", ge=0.0)


def test_a_section_that_must_hold_something_is_none_until_it_is_given():
    nothing = type("Nothing", (Params,), {"__doc__": "No parameters."})
    needs = type("NeedsMore", (Needs,), {"__doc__": "Gain."})
    family = Family("thing", (Member("a", nothing, {}, "none"), Member("b", needs, {}, "none")))
    model = family.params_model("ThingParams", "model", "a", "Things.", bare=True)
    assert list(model.model_fields) == ["model", "b"]
    assert model().b is None and model(b={"gain": 2.0}).b.gain == 2.0
    assert "a" in family.params_model("Whole", "model", "a", "Things.").model_fields


def test_a_family_of_one_needs_no_choice():
    assert one_member(0, 2.0, 1.0) == ONLY(0, 2.0, 1.0) == 9.0


def test_two_switches_in_one_kernel_do_not_mix():
    other = of(root, square)

    @kernel
    def both(i, j, x):
        return POWERS(i, x, 0.0) + 1000.0 * other(j, x, 0.0)

    assert [both(i, j, 4.0) for i, j in ((0, 0), (1, 1), (2, 0))] == [2016.0, 16064.0, 2002.0]


def test_a_second_process_loads_the_dispatching_kernel_from_the_cache(tmp_path):
    (tmp_path / "laws.py").write_text(
        "from edl6dof.kernels import kernel\nfrom edl6dof.config.base import Params\n"
        "from edl6dof.registry import Family, Member\n"
        "@kernel\ndef one(x):\n    return x\n@kernel\ndef two(x):\n    return 2.0 * x\n"
        "members = tuple(Member(f.__name__, Params, {'of': f}, 'none') for f in (one, two))\n"
        "pick = Family('function', members).switch('of', 'x')\n"
        "@kernel\ndef fly(index, x):\n    return pick(index, x)\n"
    )
    os.utime(tmp_path / "laws.py", (1e9, 1e9))  # older than the process: its code is kept
    code = "from laws import fly; print(fly(0, 7.0), fly(1, 7.0), sum(fly.called.stats.cache_hits.values()))"
    runs = [small_programs.run(code, cwd=tmp_path) for _ in range(2)]
    assert [run.stdout.split() for run in runs] == [["7.0", "14.0", "0"], ["7.0", "14.0", "1"]], runs[
        1
    ].stderr


class GentleParams(Params):
    """A gentle law."""

    gain: float = param(0.5, "gain", gt=0.0)


class FirmParams(Params):
    """A firm law."""

    angle_deg: float = param(90.0, "angle")


MEMORY = np.dtype([("sum", "f8")])
FAMILY = Family(
    "law",
    (
        Member("gentle", GentleParams, {"steer": square}, "nobody, 2020"),
        Member("firm", FirmParams, {"steer": cube}, "somebody, 2021", MEMORY),
    ),
)


class TestFamily:
    model: ClassVar = FAMILY.params_model("LawParams", "law", "gentle", "Choice of a law.")

    def test_the_name_in_yaml_becomes_the_index_that_switch_dispatches_on(self):
        steer = FAMILY.switch("steer", "x", "y")
        for name, expected in (("gentle", 9.0), ("firm", 27.0)):
            record = np.zeros(1, dtype_of(self.model)).view(np.recarray)[0]
            fill(record, self.model(law=name))
            assert steer(record.law, 3.0, 0.0) == expected

    def test_every_member_has_its_section_in_si_units(self):
        record = np.zeros(1, dtype_of(self.model)).view(np.recarray)[0]
        fill(record, self.model.model_validate({"law": "firm", "firm": {"angle_deg": 180.0}}))
        assert record.firm.angle == pytest.approx(np.pi) and record.gentle.gain == 0.5

    @pytest.mark.parametrize(
        "section", [{"law": "harsh"}, {"gentle": {"gain": -1.0}}, {"firm": {"gain": 1.0}}]
    )
    def test_unknown_members_and_foreign_parameters_are_errors(self, section):
        with pytest.raises(ValidationError):
            self.model.model_validate(section)

    def test_members_keep_their_memories_apart(self):
        memory = np.zeros(1, FAMILY.memory)[0]
        memory["firm"]["sum"] = 3.0
        assert memory["gentle"]["unused"] == 0.0 and memory["firm"]["sum"] == 3.0
