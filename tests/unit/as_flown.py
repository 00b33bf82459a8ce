"""Kernels called from Python with fields of records, as flights call them.

To numba a field of a record is something else than an array with the same numbers: a kernel that is called
with one is compiled for it, with all that it calls.
"""

from collections.abc import Callable
from functools import cache, update_wrapper
from typing import Any

from numba import njit, types
from numba.core.typing import Signature

from edl6dof.dispatch import NOTHING, on_its_own


def as_flown(kernel: Any, given: str, call: str, returns: types.Type = NOTHING) -> Callable[..., Any]:
    """Function of ``given`` (names) that calls a kernel with ``call``: expressions of these, of types that
    a flight has, and so with the machine code of flights.
    """
    scope = {"kernel": apart(kernel, returns)}
    exec(f"def function({given}):\n    return kernel({call})", scope)
    return njit(scope["function"])


@cache
def apart(kernel: Any, returns: types.Type = NOTHING) -> Callable[..., Any]:
    """A kernel of which kernels of tests that call it hold no copy, which they would have to compile."""
    return on_its_own(returns)(_Kept(kernel))


class _Kept:
    """A kernel that is taken from the cache where flights call it directly: its code is kept there by the
    types of its arguments, not by what it must return besides.
    """

    def __init__(self, kernel: Any) -> None:
        self._kernel = kernel
        update_wrapper(self, kernel.py_func)

    def __call__(self, *given: Any) -> Any:
        return self._kernel(*given)

    def get_compile_result(self, signature: Signature) -> Any:
        self._kernel.compile(tuple(signature.args))
        return self._kernel.get_compile_result(signature)
