"""numba with less memory and a quicker start, for a process that loads its kernels from the cache, and less to compile for one that
does not.

Imported by :mod:`edl6dof.jit` before any kernel is built.  What numba compiles works the same.  Little of this is stable API; the tests
of ``jit`` hold it.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from functools import cached_property, partial
from threading import Lock
from typing import Any

from llvmlite import binding as llvm
from numba.core import event, types
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


class _CalmCollector(event.Listener):
    """Collects garbage less often while numba compiles: almost all that it makes stays, and looking for more took 7 % of the time."""

    def __init__(self) -> None:
        self._depth, self._usual, self._lock = 0, gc.get_threshold(), Lock()

    def on_start(self, event: event.Event) -> None:
        """A kernel begins to compile, perhaps for another one."""
        with self._lock:
            if self._depth == 0:
                self._usual = gc.get_threshold()
                gc.set_threshold(20_000, 20, 20)
            self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """It has been compiled."""
        with self._lock:
            self._depth -= 1
            if self._depth == 0:
                gc.set_threshold(*self._usual)


def compiled_by_type(kernel: Any) -> Any:
    """Let ``kernel`` be compiled once for numbers of one type; numba compiles a call with a literal number for that number alone.

    That made a tenth of what there was to compile, some of it never called, and inlining brings literals into small kernels anyway.
    """
    resolve = getattr(kernel, "get_call_template", None)
    if resolve is not None:  # without numba's compiler (NUMBA_DISABLE_JIT) a kernel is a plain function
        kernel.get_call_template = lambda args, kws: resolve(
            tuple(map(types.unliteral, args)), {name: types.unliteral(kind) for name, kind in kws.items()}
        )
    return kernel


event.register("numba:compile", _CalmCollector())
_put_off_blas()
_put_off_runtime()
_put_off_bitcode()
