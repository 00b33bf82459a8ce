"""Kernels that are compiled when they are first called: which are, with what, and what goes wrong."""

import numpy as np
import pytest
import small_programs
from numba.core.errors import NumbaError

from edl6dof.config.base import Params
from edl6dof.dispatch import NUMBER, Choice, lazy, numbers, on_its_own
from edl6dof.jit import kernel
from edl6dof.lazy_calls import compile_named, names
from edl6dof.registry import Family, Member

SMALL, LARGE = np.dtype([("gain", "f8")]), np.dtype([("sum", "f8"), ("gain", "f8")])


@kernel
def doubled(params, memory, x):
    memory.gain = x
    return params.gain * x, 2.0 * x


@kernel
def summed(params, memory, x):
    memory.sum += x
    return memory.sum, params.gain


@kernel
def broken(params, memory, x):
    return params.nothing, x


FAMILY = Family(
    "lazily tried law",
    tuple(
        Member(one.__name__, Params, {"steer": one}, "none", memory=memory)
        for one, memory in ((doubled, SMALL), (summed, LARGE), (broken, SMALL))
    ),
)
steer = FAMILY.switch("steer", "params", "memory", "x", returns=numbers(2))


@kernel
def fly(index, params, memory, x):
    return steer(index, params, memory, x)


@pytest.fixture
def records():
    """Parameters and memory of each member."""
    params = np.zeros(1, [(name, SMALL) for name in FAMILY.names])
    for k, name in enumerate(FAMILY.names):
        params[name]["gain"] = 3.0 + k
    return params[0], np.zeros(1, FAMILY.memory)[0]


def test_a_member_is_compiled_when_it_is_first_called_and_gets_its_own_sections(records):
    params, memory = records
    assert fly(0, params, memory, 5.0) == (15.0, 10.0)
    assert (len(doubled.signatures), len(summed.signatures)) == (1, 0)
    assert [fly(1, params, memory, 5.0) for _ in range(2)] == [(5.0, 4.0), (10.0, 4.0)]
    assert (memory["doubled"]["gain"], memory["summed"]["sum"]) == (5.0, 10.0)
    assert steer(0, params, memory, 5.0) == (15.0, 10.0), "from Python"


@pytest.mark.parametrize("index", [-1, 3, 2**40])
def test_an_index_that_no_member_has_calls_the_first(records, index):
    assert fly(index, *records, 5.0) == fly(0, *records, 5.0)


def test_a_member_that_cannot_be_compiled_is_an_error_of_the_flight_and_of_no_other(records):
    for _ in range(2):
        with pytest.raises((NumbaError, KeyError), match="nothing"):
            fly(2, *records, 5.0)
    assert fly(0, *records, 5.0) == (15.0, 10.0)


def test_a_name_stands_for_one_call():
    with pytest.raises(ValueError, match="lazily tried law: steer"):
        FAMILY.switch("steer", "params", "memory", "x", returns=numbers(2))


@on_its_own(NUMBER)
@kernel
def rarely(x):
    """A rare thing."""
    return x + 1


@kernel
def seldom(x):
    return rarely(x) if x > 0.0 else 0.0


def test_a_kernel_on_its_own_is_compiled_when_it_is_first_called():
    assert seldom(-1.0) == 0.0 and rarely.__wrapped__.signatures == []
    assert seldom(1.0) == 2.0 and len(rarely.__wrapped__.signatures) == 1
    assert rarely(1.0) == 2.0 and rarely.__doc__ == "A rare thing."


@kernel
def inner(x):
    return 2.0 * x


@kernel
def other(x):
    return -x


def test_what_is_chosen_is_compiled_ahead_and_with_it_what_that_calls():
    within = lazy(Choice("within", (other, inner), ("x",), sections=("other", "inner")), NUMBER)

    @kernel
    def outer(x):
        return within(1, x)

    chosen = lazy(Choice("chosen", (other, outer), ("x",), sections=("unchosen", "outer")), NUMBER)

    @kernel
    def loop(k, x):
        return chosen(k, x)

    loop.compile("float64(int64, float64)")
    assert {"outer", "inner", "unchosen"} <= names()
    compile_named(["inner", "outer"])
    assert [len(one.signatures) for one in (outer, inner, other)] == [1, 1, 0]
    made = inner.stats
    assert loop(1, 4.0) == 8.0 and sum((made.cache_misses + made.cache_hits).values()) == 1


def test_a_second_process_finds_caller_and_member_in_the_cache(tmp_path):
    (tmp_path / "laws.py").write_text(
        "from edl6dof.dispatch import NUMBER, Choice, lazy\nfrom edl6dof.jit import kernel\n"
        "@kernel\ndef one(x):\n    return x\n@kernel\ndef two(x):\n    return 2.0 * x\n"
        "pick = lazy(Choice('pick', (one, two), ('x',)), NUMBER)\n"
        "@kernel\ndef fly(index, x):\n    return pick(index, x)\n"
    )
    code = (
        "from laws import fly, one, two; print(fly(1, 7.0), "
        "*(sum(k.stats.cache_hits.values()) for k in (fly, two)), len(one.signatures))"
    )
    runs = [small_programs.run(code, cwd=tmp_path) for _ in range(2)]
    assert [run.stdout.split() for run in runs] == [["14.0", "0", "0", "0"], ["14.0", "1", "1", "0"]], runs[
        1
    ].stderr
