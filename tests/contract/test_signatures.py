"""Signatures that a reader can check: a call of a kernel with many arguments names them."""

import ast

import pytest
from source_rules import breaches, is_kernel, modules, nodes

#: Arguments that a call in a kernel may give by position.
MOST_BY_POSITION = 5


def long_calls_by_position(_, source):
    """``line: function calls name`` of calls in kernels that give more arguments by position than are
    easily counted; an unpacked sequence counts as many, unless it stands alone.

    Numba checks no types: two numbers in the wrong order compile, and fly.  Functions that are passed as
    arguments, the fields of a record of them, have no names of arguments in compiled code.
    """
    return [
        f"{call.lineno}: {function.name} calls {ast.unparse(call.func)}"
        for function in nodes(source)
        if isinstance(function, ast.FunctionDef) and is_kernel(function)
        for call in ast.walk(function)
        if isinstance(call, ast.Call)
        and isinstance(call.func, ast.Name)
        and _by_position(call) > MOST_BY_POSITION
    ]


def _by_position(call):
    unpacked = any(isinstance(argument, ast.Starred) for argument in call.args)
    return MOST_BY_POSITION + 1 if unpacked and len(call.args) > 1 else len(call.args)


def test_calls_in_kernels_name_all_arguments_but_the_first_five():
    assert breaches(long_calls_by_position, modules()) == {}


@pytest.mark.parametrize("call", ["step(a, b, c, d, e, f)", "step(a, b, c, d, e, f, g=1)", "step(a, *b)"])
def test_planted_long_call_is_found(call):
    source = f"@kernel\ndef f(a, b):\n    return {call}\n"
    assert long_calls_by_position("", source) == [f"3: f calls {call.split('(')[0]}"]


@pytest.mark.parametrize("call", ["step(a, b, c, d, e, f=f)", "step(*a)"])
def test_call_with_named_arguments_passes(call):
    assert long_calls_by_position("", f"@kernel\ndef f(a, b):\n    return {call}\n") == []
