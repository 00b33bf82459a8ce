"""Kernels that stay functions of their own on a GPU."""

from __future__ import annotations

from collections.abc import Callable

from numba.extending import overload


def stay_apart() -> None:
    """Said first in a kernel: a compiler for a GPU does not copy it into its callers.

    It would copy everything, the equations of motion seven times, and the assembler could not bear the
    whole.  The compiler for the processor decides for itself: to it, this is nothing.
    """


@overload(stay_apart, target="cpu")
def _nothing() -> Callable[[], None]:
    return lambda: None
