"""The ``@kernel`` decorators: compiled, cached functions that hold no GIL and round the same everywhere."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numba

from edl6dof.kernels.cache import BESIDE, in_own_folders, place_of


def kernel(function: Callable[..., Any]) -> Any:
    """Compile ``function`` in numba's nopython mode: cached on disk, numpy division rules, no GIL, no
    fast-math.

    Fast-math stays off because it changes the last bits between machines; the run must be reproducible.
    """
    return compiled(function, kept=BESIDE not in os.environ, no_cfunc_wrapper=True)


def inlined_kernel(function: Callable[..., Any]) -> Any:
    """A :func:`kernel` that is copied into each of its callers, whatever its size.

    For large kernels that the equations of motion call once a derivative: LLVM leaves them outside, and to
    hand on arrays and tuples through the stack took 6 % of the time of a flight.
    """
    return compiled(function, kept=BESIDE not in os.environ, no_cfunc_wrapper=True, forceinline=True)


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
        TypeError: it does.
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


def compiled(function: Callable[..., Any], *, kept: bool = True, **options: bool) -> Any:
    """A :func:`kernel` with further options of numba; ``kept``: whether its machine code is kept on disk."""
    _require_same_bits(function)
    kept = kept and place_of(function.__code__.co_filename) is not None
    with in_own_folders():
        return numba.njit(cache=kept, error_model="numpy", nogil=True, **options)(function)
