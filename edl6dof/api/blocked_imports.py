"""Keep libraries from importing what is of no use here."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec

#: What pyarrow takes along where it is installed, without need: 28 MiB and a quarter of a second, and its
#: access to Amazon's storage.
_UNUSED_BY_ARROW = ("pandas", "pyarrow._s3fs")


class _NotInstalled(MetaPathFinder):
    """Finds some modules missing."""

    def __init__(self, modules: tuple[str, ...]) -> None:
        self._modules = modules

    def find_spec(self, fullname: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if fullname in self._modules:
            raise ModuleNotFoundError(f"{fullname} is not imported here", name=fullname)
        return None


@contextmanager
def blocked_imports(*modules: str) -> Iterator[None]:
    """Inside the block these modules are as if they were not installed, unless they have been imported
    before.
    """
    finder = _NotInstalled(modules)
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)


@contextmanager
def lean_arrow() -> Iterator[None]:
    """Inside the block pyarrow is imported without what is of no use here, and takes memory from the system:
    its own allocator keeps 9 MB of what it has freed.
    """
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
    with blocked_imports(*_UNUSED_BY_ARROW):
        yield
