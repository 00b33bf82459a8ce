"""numba with less memory and a quicker start, for a process that loads its kernels from the cache.

Imported by :mod:`edl6dof.jit` before any kernel is built.  Each change puts off work until it is needed, so that what numba compiles,
and when it works at all, stays the same.  None of this is stable API; the tests of ``jit`` hold all three.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

from llvmlite import binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.runtime import nrtdynmod


class WhenUsed:
    """Stands for what ``make`` returns, which is made when something of it is first asked for."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    def __getattr__(self, name: str) -> Any:
        return getattr(self._made, name)

    @cached_property
    def _made(self) -> Any:
        return self._make()


def _put_off_blas() -> None:
    """Load numba's array library without scipy's BLAS: that saves a fifth of the memory and time that starting numba takes.

    numba looks for BLAS when this module is imported and keeps the answer for ``np.cov`` alone; products and ``np.linalg`` look
    again when a kernel uses them.
    """
    blas = "scipy.linalg.cython_blas"
    if blas in sys.modules:
        return
    sys.modules[blas] = None  # type: ignore[assignment]  # makes its import fail
    try:
        import numba.np.arraymath  # noqa: F401
    finally:
        del sys.modules[blas]


def _put_off_runtime() -> None:
    """Compile numba's own runtime library with the first kernel that is compiled, not with the first that is loaded from the cache.

    Only compilation links to it, cached code carries what it needs of it; and a process in which LLVM compiles nothing touches 20 MB
    less of LLVM.
    """
    compile_now = nrtdynmod.compile_nrt_functions
    nrtdynmod.compile_nrt_functions = lambda context: WhenUsed(partial(compile_now, context))


def _put_off_bitcode() -> None:
    """Keep no parsed bitcode of a kernel loaded from the cache, 8 MB for the flight loop; a new kernel that calls it parses it again."""
    load = JITCodeLibrary._unserialize.__func__

    def unserialize(cls: type, codegen: Any, state: tuple[str, str, Any]) -> Any:
        library = load(cls, codegen, state)
        if state[1] == "object":  # machine code, beside the bitcode that others may inline
            library._shared_module = WhenUsed(partial(llvm.parse_bitcode, state[2][1]))
        return library

    JITCodeLibrary._unserialize = classmethod(unserialize)


_put_off_blas()
_put_off_runtime()
_put_off_bitcode()
