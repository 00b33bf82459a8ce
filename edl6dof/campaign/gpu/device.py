"""The GPU of this machine, and the entry compiled for it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

from edl6dof.config.errors import refusal


def require() -> str:
    """Name of the GPU that flies, with what compiles for it: rows of two of them may differ.

    Raises:
        ConfigError: numba-cuda is not installed, or there is no GPU that it can use.
    """
    if find_spec("numba_cuda") is None:
        raise refusal("--engine", "numba-cuda is not installed; try: pip install 'edl6dof[gpu]'")
    from numba import cuda

    if not cuda.is_available():
        reason = " ".join(str(cuda.cuda_error() or "none is there").split())
        raise refusal("--engine", f"there is no GPU that CUDA can use: {reason}")
    name = cuda.get_current_device().name
    called = name.decode() if isinstance(name, bytes) else name
    return f"{called}, numba-cuda {version('numba-cuda')}"


@cache
def entry() -> Any:
    """The compiled entry, :func:`~edl6dof.campaign.gpu.entry.fly_flights`.

    Its machine code is kept beside that of the processor, and is as fresh: numba-cuda would not see that a
    kernel has changed which the entry calls.
    """
    from numba.cuda.core.caching import IndexDataCacheFile
    from numba.cuda.dispatcher import CUDACache

    from edl6dof.campaign.gpu import entry as module
    from edl6dof.jit import tree_stamp

    kernel, stamp = module.fly_flights, tree_stamp(str(module.__file__))
    kept = CUDACache(kernel.py_func)
    kept._cache_file = IndexDataCacheFile(kept.cache_path, f"{module.__name__}.gpu", stamp)
    kernel._cache = kept
    return kernel


@contextmanager
def as_written() -> Iterator[None]:
    """Compile every multiplication and addition as one that rounds, as the processor does them.

    NVVM fuses them unless it is told not to, and numba-cuda has no option that tells it.
    """
    from numba.cuda.cudadrv import nvvm

    before = nvvm.compile_ir

    def unfused(*code: Any, **options: Any) -> Any:
        return before(*code, **options, fma=False)

    nvvm.compile_ir = unfused
    try:
        yield
    finally:
        nvvm.compile_ir = before
