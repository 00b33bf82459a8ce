"""Members that a flight passes to the loop as functions: which are compiled, and what goes wrong."""

import numpy as np
import pytest
import small_programs
from numba import NumbaError, types

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.kernels.functions import Bundle, function_type, kind_of, numbers, passed
from edl6dof.registry import Family, Member, Place

SMALL, LARGE = np.dtype([("gain", "f8")]), np.dtype([("sum", "f8"), ("gain", "f8")])


@kernel
def doubled(params, memory, x):
    memory.gain = x
    return params.gain * x, 2.0 * x


@kernel
def summed(params, memory, x):
    if x < 0.0:
        raise ValueError("nothing to add")
    memory.sum += x
    return memory.sum, params.gain


@kernel
def broken(params, memory, x):
    return params.nothing, x


@kernel
def too_short(params, memory, x):
    return x


FAMILY = Family(
    "passed law",
    tuple(
        Member(one.__name__, Params, {"steer": one}, "none", memory=memory)
        for one, memory in ((doubled, SMALL), (summed, LARGE), (broken, SMALL), (too_short, SMALL))
    ),
)
PARAMS = np.dtype([(name, SMALL) for name in FAMILY.names], align=True)
LAW = function_type(numbers(2), kind_of(PARAMS), kind_of(FAMILY.memory), types.float64)
ONE = Place(FAMILY.role("steer", "params", "memory", "x"), LAW, ("law",))
SEVERAL = Place(ONE.role, types.UniTuple(LAW, 4))
BUNDLE = Bundle(__file__, {"law": LAW, "laws": SEVERAL.type})


@kernel
def fly(functions, index, params, memory, x):
    a = functions.law(params, memory, x)
    b = functions.laws[index](params, memory, x)
    return a, b


def carrying(law, laws=()):
    return BUNDLE(law=ONE.functions({law}), laws=SEVERAL.functions(set(laws)))


@pytest.fixture
def records():
    """Parameters and memory of each member."""
    params = np.zeros(1, PARAMS)
    for k, name in enumerate(FAMILY.names):
        params[name]["gain"] = 3.0 + k
    return params[0], np.zeros(1, FAMILY.memory)[0]


def test_members_get_their_own_sections_and_others_are_not_compiled(records):
    params, memory = records
    assert fly(carrying(0, {1}), 1, params, memory, 5.0) == ((15.0, 10.0), (5.0, 4.0))
    assert (memory["doubled"]["gain"], memory["summed"]["sum"]) == (5.0, 5.0)
    assert ONE.role(0, params, memory, 5.0) == (15.0, 10.0), "from Python"
    assert broken.signatures == too_short.signatures == []


def test_a_member_that_comes_later_flies_in_the_loop_as_it_was_compiled(records):
    params, memory = records
    fly(carrying(0, {1}), 1, params, memory, 5.0)
    known = list(fly.signatures)
    first = fly(carrying(1, {0}), 0, params, memory, 5.0)

    @kernel
    def negative(params, memory, x):
        return -params.doubled.gain, x

    assert first[1] == (15.0, 10.0)
    assert fly(BUNDLE(law=passed(negative), laws=SEVERAL.functions({0})), 0, params, memory, 5.0)[0] == (
        -3.0,
        5.0,
    )
    assert fly.signatures == known


def test_an_error_in_a_member_is_that_of_the_flight(records):
    with pytest.raises(ValueError, match="nothing to add"):
        fly(carrying(1, {0}), 0, *records, -5.0)


@pytest.mark.parametrize("law, complaint", [(2, "nothing"), (3, "No conversion from float64")])
def test_a_member_that_cannot_be_passed_is_an_error_and_no_other_is(records, law, complaint):
    for _ in range(2):
        with pytest.raises((KeyError, TypeError, NumbaError), match=complaint):
            carrying(law)
    assert fly(carrying(0), 0, *records, 5.0)[0] == (15.0, 10.0)


def test_more_members_than_there_are_places_are_refused():
    with pytest.raises(ValueError, match="2 members of passed law at most"):
        Place(ONE.role, types.UniTuple(LAW, 2)).functions({2})


def test_members_are_compiled_ahead_by_name():
    ONE.compile({"summed", "nobody"})
    SEVERAL.compile({"summed"})
    assert [len(ONE.role.function(index).signatures) for index in (1, 3)] == [1, 0]


LAWS = """
from numba import float64
from edl6dof.kernels import kernel
from edl6dof.kernels.functions import Bundle, function_type, passed
@kernel
def one(x):
    return x
@kernel
def two(x):
    return 2.0 * x
BUNDLE = Bundle(__file__, {"law": function_type(float64, float64)})
@kernel
def fly(functions, x):
    return functions.law(x)
"""


def test_a_second_process_finds_loop_and_member_in_the_cache_and_adds_nothing(tmp_path):
    (tmp_path / "laws.py").write_text(LAWS)
    code = (
        "from laws import BUNDLE, fly, one, passed, two; print(fly(BUNDLE(law=passed(two)), 7.0), "
        "*(sum(k.stats.cache_hits.values()) for k in (fly, passed(two))), len(one.signatures))"
    )
    cache = tmp_path / "cache"
    runs = [small_programs.run(code, cwd=tmp_path, NUMBA_CACHE_DIR=str(cache)) for _ in range(2)]
    assert [run.stdout.split() for run in runs] == [["14.0", "0", "0", "0"], ["14.0", "1", "1", "0"]], runs[
        1
    ].stderr
    kept = len(list(cache.rglob("*.nbc")))
    small_programs.run(code, cwd=tmp_path, NUMBA_CACHE_DIR=str(cache))
    assert len(list(cache.rglob("*.nbc"))) == kept


def test_bundles_of_two_files_may_hold_functions_of_one_type(tmp_path):
    (tmp_path / "laws.py").write_text(LAWS)
    (tmp_path / "more.py").write_text(
        LAWS.replace('"law"', '"other"').replace("functions.law", "functions.other")
    )
    code = (
        "import laws, more; first = laws.fly(laws.BUNDLE(law=laws.passed(laws.two)), 7.0); "
        "print(first, more.fly(more.BUNDLE(other=more.passed(more.one)), 7.0))"
    )
    for _ in range(2):
        ran = small_programs.run(code, cwd=tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
        assert ran.stdout.split() == ["14.0", "7.0"], ran.stderr
