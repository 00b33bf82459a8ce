"""The ``@kernel`` decorators: compiled, cached functions that release the GIL and give the same bits on every
machine.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, update_wrapper
from types import FunctionType
from typing import Any

import numba
from numba import types
from numba.extending import models, register_model, typeof_impl

from edl6dof.kernels.cache import SETTINGS, compiled, in_own_folder


class Kernel:
    """A function that other kernels and Python call compiled.

    numba's wrapper for calls from Python is a fifth of the compilation, and Python calls few kernels: that
    variant of a kernel is compiled when Python first calls it.  ``py_func`` is the function itself.
    """

    __name__: str

    def __init__(self, function: Callable[..., Any], follows: Sequence[str] = (), **options: bool) -> None:
        """
        Args:
            function: as written in Python.
            follows: other source files that its machine code depends on, with their imports.
            options: further options of numba for calls from kernels.
        """
        _require_same_bits(function)
        update_wrapper(self, function)
        self.py_func, self._follows, self._options = function, follows, options

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Call the function from Python, compiled."""
        return compiled(self.called, *given, **named)

    @cached_property
    def called(self) -> Any:
        """The function as Python calls it."""
        return self._variant("called", no_cfunc_wrapper=True)

    @cached_property
    def inside(self) -> Any:
        """The function as kernels call it."""
        return self._variant("inside", no_cpython_wrapper=True, no_cfunc_wrapper=True, **self._options)

    @cached_property
    def passed(self) -> Any:
        """The function as it is passed to a kernel that calls it by its address."""
        return self._variant("passed", no_cpython_wrapper=True)

    def _variant(self, name: str, **options: bool) -> Any:
        """A dispatcher with its own function, without which numba would confuse the code of two variants."""
        one = self.py_func
        own: Any = FunctionType(
            one.__code__, one.__globals__, one.__name__, one.__defaults__, one.__closure__
        )
        own.__module__, own.__qualname__ = one.__module__, f"{one.__qualname__}.{name}"
        own.follows = self._follows
        with in_own_folder(own) as kept:
            return numba.njit(cache=kept, error_model="numpy", nogil=True, **options)(own)


class _KernelType(types.Dispatcher):
    """Type of a kernel, which is compiled once for numbers of a type, where numba would compile a call with a
    literal number for that number alone.
    """

    def get_call_type(self, context: Any, args: Sequence[types.Type], kws: dict[str, types.Type]) -> Any:
        """Signature of a call with arguments of these types."""
        named = {name: types.unliteral(kind) for name, kind in kws.items()}
        return compiled(super().get_call_type, context, tuple(map(types.unliteral, args)), named)


register_model(_KernelType)(models.OpaqueModel)


@typeof_impl.register(Kernel)
def _(one: Kernel, _: Any) -> types.Type:
    return _KernelType(one.inside)


def kernel(function: Callable[..., Any], follows: Sequence[str] = (), **options: bool) -> Any:
    """Compile ``function`` in numba's nopython mode: cached on disk, numpy division rules, no GIL, no
    fast-math.

    Fast-math stays off because it changes the last bits between machines; the run must be reproducible.
    """
    # without numba's compiler (NUMBA_DISABLE_JIT) a kernel is a plain function
    return function if SETTINGS.DISABLE_JIT else Kernel(function, follows, **options)


def inlined_kernel(function: Callable[..., Any]) -> Any:
    """Compile a :func:`kernel` that is copied into each of its callers, whatever its size.

    For large kernels that the equations of motion call once a derivative: LLVM does not inline them, and
    arrays and tuples on the stack took 6 % of the time of a flight.
    """
    return kernel(function, forceinline=True)


#: Functions of ``math`` and of numpy that round in another way on another processor.
_INEXACT = frozenset(
    (
        *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "arcsin", "arccos", "arctan", "arctan2"),
        *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "arcsinh", "arccosh", "arctanh", "hypot"),
        *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "pow", "power", "erf", "erfc", "cbrt"),
        *("dot", "vdot", "linalg", "interp"),
    )
)


def _require_same_bits(function: Callable[..., Any]) -> None:
    """Refuse a kernel that names a function of the C library, of numpy or of BLAS.

    Raises:
        TypeError: the kernel names one.
    """
    used, known = function.__code__.co_names, function.__globals__
    libraries = {"math", "numpy"} & {getattr(known.get(name), "__name__", "") for name in used}
    for name in used:
        of_math = getattr(known.get(name), "__module__", "") in ("math", "numpy")
        if name in _INEXACT and (of_math or (libraries and name not in known)):
            raise TypeError(
                f"kernel {function.__name__}: {name} rounds differently on another processor; "
                "take it from edl6dof.spatial.elementary"
            )
