"""Members that a flight passes to the loop as functions: which are compiled, and what goes wrong."""

import os
import pickle
import warnings

import numpy as np
import pytest
import small_programs
from numba import NumbaError, types

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.kernels.functions import Given, function_type, kind_of, numbers
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
LAW = function_type(
    "law",
    ("index", "params", "memory", "x"),
    numbers(2),
    types.int64,
    kind_of(PARAMS),
    kind_of(FAMILY.memory),
    types.float64,
)
ONE = Place(FAMILY.role("steer", "params", "memory", "x", own=("params", "memory")), LAW, ("law",))
SEVERAL = Place(ONE.role, LAW)


@kernel
def fly(functions, index, params, memory, x):
    one, several = functions
    return one(0, params, memory, x), several(index, params, memory, x=x)


def carrying(law, laws=()):
    return ONE.function({law}), SEVERAL.function(set(laws))


@pytest.fixture
def records():
    """Parameters and memory of each member."""
    params = np.zeros(1, PARAMS)
    for k, name in enumerate(FAMILY.names):
        params[name]["gain"] = 3.0 + k
    return params[0], np.zeros(1, FAMILY.memory)[0]


def test_members_get_their_own_sections_and_others_are_not_compiled(records):
    params, memory = records
    assert fly(carrying(0, {0, 1}), 1, params, memory, 5.0) == ((15.0, 10.0), (5.0, 4.0))
    assert (memory["doubled"]["gain"], memory["summed"]["sum"]) == (5.0, 5.0)
    assert ONE.role(0, params, memory, 5.0) == (15.0, 10.0), "from Python"
    assert broken.inside.signatures == too_short.inside.signatures == []


def test_a_member_that_comes_later_flies_in_the_loop_as_it_was_compiled(records):
    params, memory = records
    fly(carrying(0, {1}), 1, params, memory, 5.0)
    known = list(fly.called.signatures)

    @kernel
    def negative(index, params, memory, x):
        return -params.doubled.gain, x

    assert fly(carrying(1, {0}), 0, params, memory, 5.0)[1] == (15.0, 10.0)
    late = Given(negative, LAW), SEVERAL.function({0})
    assert fly(late, 0, params, memory, 5.0)[0] == (-3.0, 5.0)
    assert fly.called.signatures == known and len(known) == 1


def test_a_caller_that_takes_warnings_for_errors_can_compile_a_loop(records):
    params, memory = records

    @kernel
    def once(functions, params, memory):
        return functions[0](0, params, memory, 5.0)

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert once(carrying(0), params, memory) == (15.0, 10.0)


def test_an_error_in_a_member_is_that_of_the_flight(records):
    with pytest.raises(ValueError, match="nothing to add"):
        fly(carrying(1, {0}), 0, *records, -5.0)


@pytest.mark.parametrize("law", [2, 3])
def test_a_member_that_cannot_be_passed_is_an_error_and_no_other_is(records, law):
    for _ in range(2):
        with pytest.raises((KeyError, TypeError, NumbaError)):
            fly(carrying(law), 0, *records, 5.0)
    assert fly(carrying(0, {0}), 0, *records, 5.0)[0] == (15.0, 10.0)


def test_members_are_compiled_ahead_by_name():
    ONE.compile({"summed", "nobody"})
    assert [len(ONE.function({index}).kernel.passed.signatures) for index in (1, 3)] == [1, 0]
    SEVERAL.compile({"summed", "doubled"})
    assert len(SEVERAL.function({0, 1}).kernel.passed.signatures) == 1


LAWS = """
from numba import float64, int64
from edl6dof.kernels import kernel
from edl6dof.kernels.functions import Given, function_type
@kernel
def one(x):
    return x
@kernel
def two(x):
    return 2.0 * one(x)
LAW = function_type("law", ('x',), float64, float64)
@kernel
def fly(law, x):
    return law(x)
"""


def test_a_second_process_finds_loop_and_member_in_the_cache_and_adds_nothing(tmp_path):
    (tmp_path / "laws.py").write_text(LAWS)
    os.utime(tmp_path / "laws.py", (1e9, 1e9))
    code = (
        "from laws import LAW, Given, fly, one, two; print(fly(Given(two, LAW), 7.0), "
        "*(sum(k.stats.cache_hits.values()) for k in (fly.called, two.passed)), len(one.inside.signatures))"
    )
    cache = tmp_path / "cache"
    runs = [small_programs.run(code, cwd=tmp_path, NUMBA_CACHE_DIR=str(cache)) for _ in range(2)]
    assert [run.stdout.split() for run in runs] == [["14.0", "0", "0", "1"], ["14.0", "1", "1", "0"]], runs[
        1
    ].stderr
    assert len(list(cache.rglob("*.nbc"))) == 3, "nothing is compiled for Python that it does not call"


def test_a_call_with_a_literal_number_compiles_nothing_of_its_own():
    @kernel
    def column(x, k):
        return x + k

    @kernel
    def several(x):
        return column(x, 1) + column(x, 2) + column(x, k=3)

    assert several(1.0) == 9.0 and len(column.inside.signatures) == 1


def test_a_name_that_this_process_does_not_know_stays_what_it_is():
    """numba reads an index whole and writes it whole, with types of processes that have other layouts."""
    unknown = pickle.loads(pickle.dumps(LAW).replace(LAW.title.encode(), b"x" * len(LAW.title)))
    assert unknown != LAW and unknown.title == "x" * len(LAW.title)
    assert pickle.loads(pickle.dumps(unknown)) is unknown and pickle.loads(pickle.dumps(LAW)) is LAW


def test_functions_that_other_processes_know_stay_apart_in_an_index():
    """Were their signatures equal, a third process would merge the code of two plugins' records."""
    kinds = [function_type("steered", ("x",), types.float64, numbers(size)) for size in (7, 8)]
    written = pickle.dumps([kind.signature for kind in kinds])
    program = f"import pickle; from edl6dof.kernels import functions; read = pickle.loads({written!r}); "
    program += "print(len(set(read)), pickle.dumps(read) == " + f"{written!r})"
    done = small_programs.run(program, cwd=small_programs.ROOT)
    assert done.stdout.split() == ["2", "True"], done.stderr
    assert pickle.loads(written) == [kind.signature for kind in kinds]
