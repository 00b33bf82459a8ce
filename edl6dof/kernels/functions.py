"""Kernels that a flight chooses among: by an index compiled with the caller, or passed as functions.

A static choice is compiled whole with its caller, for the small kernels in the equations of motion.  The
members of other families that a flight carries are compiled into one function, which is passed to the loop as
a first-class function (numba's ``types.FunctionType``).  So the loop is compiled once, a member when a flight
first carries it, and a member that is made after the loop flies in it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from hashlib import sha256
from inspect import Parameter, Signature
from typing import Any

import numba
import numpy as np
from numba import types
from numba.experimental.function_type import FunctionModel, unbox_function_type
from numba.extending import NativeValue, register_model, typeof_impl, unbox

from edl6dof.kernels.cache import compiled, experimental
from edl6dof.kernels.jit import Kernel, kernel

#: Types of the results of passed kernels: nothing, or a number.
NOTHING, NUMBER = types.none, types.float64


def numbers(*shape: int) -> types.Type:
    """Type of a tuple of so many numbers, or of so many such tuples."""
    return types.UniTuple(numbers(*shape[1:]), shape[0]) if shape else NUMBER


@experimental()
def together(*kinds: types.Type) -> types.Type:
    """Type of a tuple of functions that are passed."""
    return types.Tuple(kinds)


def kind_of(layout: np.dtype, *path: str) -> types.Type:
    """Type that compiled code gives a record of a layout, or a field of one."""
    kind = _record(layout)
    for name in path:
        kind = kind.typeof(name)
    return kind


_record = cache(numba.from_dtype)


class _Signature(type(NOTHING())):  # type: ignore[misc]  # numba's class, which has no public name
    """Signature of a function that is passed: numba writes it into the machine code of each call."""

    __slots__ = ("title",)

    def __eq__(self, other: object) -> bool:
        """Compare by title: signatures that another process wrote into an index have no arguments here."""
        return self.title == other.title if isinstance(other, _Signature) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.title)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str]]:
        """Pickle as the name of the function's type."""
        return _signature_of, (self.title,)

    def __unliteral__(self) -> _Signature:
        """Return itself: numba's own method would lose the names of the arguments."""
        return self


class Passed(types.FunctionType):
    """Type of a function that is passed, with a short name: numba writes the names of types into those of
    functions, and its own name of the type has a hundred thousand letters.
    """

    def __init__(self, title: str, names: Iterable[str], returns: types.Type, *arguments: types.Type) -> None:
        super().__init__(returns(*arguments))
        self.title = title
        parameters = [Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in names]
        self.signature: Any = _Signature(returns, arguments, None, pysig=Signature(parameters))
        self.signature.title = title
        _known[title] = self

    def get_call_type(self, context: Any, args: Sequence[types.Type], kws: dict[str, types.Type]) -> Any:
        """Signature of a call; arguments may be named, unlike those of numba's own type."""
        return super().get_call_type(context, self.signature.pysig.bind(*args, **kws).args, {})

    @property
    def key(self) -> str:
        """Name of the type, by which numba identifies it."""
        return self.title

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str]]:
        """Pickle as the name of the type."""
        return _named, (self.title,)


#: Types of functions of this process by name.
_known: dict[str, Passed] = {}


@experimental()
def function_type(title: str, names: Iterable[str], returns: types.Type, *arguments: types.Type) -> Passed:
    """Type of a function that is passed, whose arguments have these names."""
    key = types.FunctionType(returns(*arguments)).key
    return Passed(f"{title}_{sha256(key.encode()).hexdigest()[:16]}", names, returns, *arguments)


def _named(title: str) -> Passed:
    """Type of this name.  A type of another process, whose records have other layouts, is made with its name
    only, which numba writes back into its index.
    """
    return _known.get(title) or Passed(title, (), NOTHING)


def _signature_of(title: str) -> Any:
    return _named(title).signature


register_model(Passed)(FunctionModel)


class Given:
    """A kernel that is passed to the loop as a value of a function type; for the kernel itself numba would
    compile another loop.

    Args:
        kernel: the kernel.
        type: type of the function.

    Attributes:
        address: address of the machine code in memory; 0 until the function is first passed.
    """

    def __init__(self, kernel: Any, type: Passed) -> None:
        self.kernel, self.type = kernel, type
        self.address = 0

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Call the kernel, as the loop does without numba's compiler."""
        return self.kernel(*given, **named)

    def compile(self) -> None:
        """Compile the kernel."""
        compiled(self.kernel.passed.compile, self.type.signature)


@typeof_impl.register(Given)
def _(given: Given, _: Any) -> types.Type:
    return given.type


@unbox(Passed)
def _(kind: Passed, given: Any, context: Any) -> Any:
    """Take the address of the function from ``Given.address``, and store it there the first time: numba looks
    it up in 25 us, which a flight that is flown cycle by cycle would pay for each function in each cycle.
    """
    python, builder, model = context.pyapi, context.builder, context.context.data_model_manager[kind]
    kept = python.object_getattr_string(given, "address")
    address = python.long_as_voidptr(kept)
    python.decref(kept)
    known = model.set(builder, context.context.get_constant_null(kind), address, "jit_addr")
    is_new = builder.icmp_unsigned("==", address, address.type(None))
    before = builder.basic_block
    with builder.if_then(is_new):
        kernel = python.object_getattr_string(given, "kernel")
        passed = python.object_getattr_string(kernel, "passed")
        found = unbox_function_type(kind, passed, context).value
        number = builder.ptrtoint(
            model.get(builder, found, "jit_addr"), context.context.get_value_type(types.uintp)
        )
        boxed = python.long_from_unsigned_int(number)
        python.object_setattr_string(given, "address", boxed)
        python.decref(boxed)
        python.decref(passed)
        python.decref(kernel)
        last = builder.basic_block
    value = builder.phi(found.type)
    value.add_incoming(known, before)
    value.add_incoming(found, last)
    return NativeValue(value)


def choice(
    name: str, kernels: Mapping[int, Any], arguments: Sequence[str], passed: Mapping[int, Sequence[str]]
) -> Any:
    """Kernel ``name(index, *arguments)`` that calls kernel ``index`` with the expressions ``passed[index]``,
    or the first kernel for an unknown index.

    numba cannot index functions of different types, so the calls are written out.
    """
    first, *others = kernels
    calls = {index: f"return f{index}({', '.join(passed[index])})" for index in kernels}
    lines = [f"def {name}(index, {', '.join(arguments)}):"]
    lines += [f"    if index == {index}: {calls[index]}" for index in others]
    scope: dict[str, Any] = {"__name__": __name__, **{f"f{index}": one for index, one in kernels.items()}}
    exec(compile("\n".join([*lines, f"    {calls[first]}"]), __file__, "exec"), scope)
    files = [one.py_func.__code__.co_filename for one in kernels.values() if isinstance(one, Kernel)]
    return kernel(scope[name], files)
