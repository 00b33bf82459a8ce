"""The GPU of this machine, and the entry compiled for it."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from shutil import rmtree
from typing import Any

from platformdirs import user_cache_dir

from edl6dof.config.errors import refusal
from edl6dof.jit import SETTINGS, tree_stamp


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

    Its machine code is kept in a folder of the present sources: numba-cuda would not see that a kernel has
    changed which the entry calls.
    """
    from numba import cuda
    from numba.cuda.core import config

    from edl6dof.campaign.gpu import entry as module

    folder = Path(SETTINGS.CACHE_DIR or user_cache_dir("edl6dof")) / "gpu"
    present = folder / tree_stamp(str(module.__file__))
    for old in folder.glob("*"):
        if old != present:
            rmtree(old, ignore_errors=True)
    before, config.CACHE_DIR = config.CACHE_DIR, str(present)
    try:
        return cuda.jit(cache=True)(module.fly_flights.py_func)
    finally:
        config.CACHE_DIR = before
