"""Kernels called from Python with fields of records, as flights call them.

To numba a field of a record is something else than an array with the same numbers: a kernel that is called
with one is compiled for it, with all that it calls.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from numba import njit, types

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
    return on_its_own(returns)(kernel)
