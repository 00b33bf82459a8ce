"""Kernels that a flight chooses among: by an index compiled with the caller, or passed as functions.

A static choice is compiled whole with its caller: for the small kernels in the equations of motion.  The
members of other families are passed to the compiled loop as first-class functions of one signature (numba's
``types.FunctionType``), gathered in a :class:`Bundle`.  So a member is compiled when a flight first carries
it, its edit recompiles it alone, and one that comes after the loop was compiled flies in it.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import cache, cached_property
from hashlib import sha256
from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
from numba import types
from numba.experimental import structref
from numba.extending import overload

from edl6dof.kernels.cache import SETTINGS
from edl6dof.kernels.jit import compiled

#: What a kernel returns that is passed as a function: nothing, or a number.
NOTHING, NUMBER = types.none, types.float64

warnings.filterwarnings(
    "ignore", category=numba.NumbaExperimentalFeatureWarning, message="First-class function"
)


def numbers(*shape: int) -> types.Type:
    """Type of a tuple of so many numbers, or of so many such tuples."""
    return types.UniTuple(numbers(*shape[1:]), shape[0]) if shape else NUMBER


def kind_of(layout: np.dtype, *path: str) -> types.Type:
    """Type that compiled code gives a record of a layout, or a field of one."""
    kind = _record(layout)
    for name in path:
        kind = kind.typeof(name)
    return kind


_record = cache(numba.from_dtype)


def function_type(returns: types.Type, *arguments: types.Type) -> types.FunctionType:
    """Type of a function that is passed."""
    return types.FunctionType(returns(*arguments))


def static(
    kernels: Sequence[Callable[..., Any]], arguments: Sequence[str], passed: Sequence[Sequence[str]]
) -> Callable[..., Any]:
    """Function ``f(index, *arguments)`` that calls kernel ``index`` with the expressions ``passed[index]``,
    from Python and from kernels, which hold all of them; an index that no kernel has calls the first.
    """
    given, calls = ", ".join(arguments), [f"f{i}({', '.join(one)})" for i, one in enumerate(passed)]
    lines = [f"def chain(index, {given}):"]
    for i, call in enumerate(calls[1:], 1):
        lines += [f"    if index == {i}:", f"        return {call}"]
    lines.append(f"    return {calls[0]}")
    lines.append(f"def function(index, {given}): return chain(index, {given})")
    lines.append(f"def choose(index, {given}): return chain")
    scope: dict[str, Any] = {f"f{i}": one for i, one in enumerate(kernels)}
    exec("\n".join(lines), scope)
    overload(scope["function"])(scope["choose"])
    function: Callable[..., Any] = scope["function"]
    return function


def adapted(function: Any, name: str, arguments: Sequence[str], given: Sequence[str]) -> Any:
    """Function of ``arguments``, fit to be passed, that calls a kernel with the expressions ``given``; its
    code is kept with that of the kernel.
    """
    python = getattr(function, "py_func", function)
    scope = {"function": function, "__name__": python.__module__}
    text = f"def {name}({', '.join(arguments)}): return function({', '.join(given)})"
    exec(compile(text, python.__code__.co_filename, "exec"), scope)
    return compiled(scope[name])


@cache
def passed(function: Any) -> Any:
    """A kernel as a function that can be passed."""
    names = list(inspect.signature(getattr(function, "py_func", function)).parameters)
    return adapted(function, f"{function.__name__}_passed", names, names)


class _Functions(types.StructRef):
    """Type of a bundle as compiled code sees it; it goes by the hash of its fields."""

    def __init__(self, fields: Sequence[tuple[str, types.Type]]) -> None:
        super().__init__(fields)
        self.name = f"{type(self).__name__}[{sha256(repr(fields).encode()).hexdigest()[:16]}]"
        _known.setdefault(self.name, self)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str]]:
        """Its name stands for it on disk: the types of the functions take as much as all other code."""
        return _named, (self.name,)


#: Types of bundles of this process by name.
_known: dict[str, _Functions] = {}


def _named(name: str) -> _Functions:
    """The type of a bundle that goes by this name; where this process has none, one that nothing has."""
    return _known.get(name) or _Functions(((name, types.none),))


structref.register(_Functions)


class _Bundled(structref.StructRefProxy):
    """A bundle as Python sees it."""


structref.define_boxing(_Functions, _Bundled)


class Bundle:
    """Functions that are handed down through the compiled loop together.

    Attributes:
        type: what compiled code calls it.
    """

    def __init__(self, file: str, fields: Mapping[str, types.Type]) -> None:
        """
        Args:
            file: source file that makes the bundle; its machine code is kept with that of this file.
            fields: type of each: a ``FunctionType``, a ``UniTuple`` of them, or that of another bundle.
        """
        self._file, self._fields = file, dict(fields)
        self.type = _Functions(tuple(self._fields.items()))

    def __call__(self, **functions: Any) -> Any:
        """A bundle of these functions, of tuples the members in order; each is compiled if it was not."""
        if SETTINGS.DISABLE_JIT:
            return SimpleNamespace(**functions)
        given: list[Any] = []
        for name, kind in self._fields.items():
            part = functions[name] if isinstance(kind, types.UniTuple) else (functions[name],)
            if isinstance(_single(kind), types.FunctionType):
                _, hold = _holder(self._file, _single(kind))
                held = {one: hold(one) for one in set(part)}
                part = [held[one] for one in part]
            given += part
        return self._make(*given)

    @cached_property
    def _make(self) -> Any:
        """Kernel that makes a bundle of what :func:`_holder` holds."""
        kinds, lines = list[types.Type](), list[str]()
        for name, kind in self._fields.items():
            first, single = len(kinds), _single(kind)
            is_function = isinstance(single, types.FunctionType)
            kinds += [_holder(self._file, single)[0] if is_function else single] * getattr(kind, "count", 1)
            values = [f"f{i}.function" if is_function else f"f{i}" for i in range(first, len(kinds))]
            lines.append(f"made.{name} = ({', '.join(values)},)" + ("" if hasattr(kind, "count") else "[0]"))
        return _compiled_in(self._file, "make", self.type, kinds, lines)


def _single(kind: types.Type) -> types.Type:
    """Type of the members of a tuple, or what is none."""
    return kind.dtype if isinstance(kind, types.UniTuple) else kind


@cache
def _holder(file: str, kind: types.FunctionType) -> tuple[_Functions, Any]:
    """Type that holds one function, and the kernel that makes it.  Symbols of machine code contain the types
    of all arguments; that of a function is a hundred thousand letters long, and this one's is short.
    """
    held = _Functions((("function", kind),))
    return held, _compiled_in(file, "hold", held, [kind], ["made.function = f0"])


def _compiled_in(
    file: str, name: str, made: _Functions, kinds: Sequence[types.Type], lines: Sequence[str]
) -> Any:
    """Kernel that makes a bundle of arguments ``f0, f1, ...``, compiled for these types alone and kept with
    the machine code of a file.
    """
    name = f"{name}_{made.name.partition('[')[2][:-1]}"
    head = f"def {name}({', '.join(f'f{i}' for i in range(len(kinds)))}):"
    text = "\n    ".join([head, "made = new(bundle)", *lines, "return made"])
    scope = {"new": structref.new, "bundle": made, "__name__": __name__}
    exec(compile(text, file, "exec"), scope)
    make = compiled(scope[name], no_cfunc_wrapper=True)
    make.compile(made(*kinds))
    make.disable_compile()
    return make
