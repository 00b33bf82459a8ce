"""The ``@kernel`` decorators: compiled, cached, GIL-free functions whose cache is never stale.

The stamp of a function's machine code is that of :mod:`edl6dof.source_stamp`, so an edit recompiles exactly
what depends on it, and words recompile nothing.
"""

from __future__ import annotations

import hashlib
import os
import re
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache, cached_property
from os.path import isabs, join
from pathlib import Path
from stat import S_IMODE, S_ISDIR
from tempfile import gettempdir
from typing import Any

import numba
from numba.core import caching
from numba.core.dispatcher import Dispatcher
from numba.core.runtime import rtsys

from edl6dof.code_files import CodeFiles, say_once
from edl6dof.compile_time import compiled_by_type
from edl6dof.source_stamp import SourceTree
from edl6dof.stale_code import PREFIX, note_sources, remove_stale

#: numba's settings: a module whose names it makes when it is imported.
SETTINGS: Any = numba.config
# numba also takes settings, among them the folder whose machine code it runs, from a file of the current
# folder, which may be a received one: only the environment counts here
SETTINGS._config_fname = ""
SETTINGS.reload_config()
PACKAGE = Path(__file__).resolve().parent
TREE = SourceTree(PACKAGE, Path(SETTINGS.CACHE_DIR or PACKAGE / "__pycache__") / "sources.json")
#: Lag (s) of the clock that dates files behind that of programs: a tick of the system, 10 ms, with room.
_FILE_CLOCK_LAG_S = 0.1
#: When the first sources were imported, s since 1970, by the clock that dates files.
_STARTED = time.time() - _FILE_CLOCK_LAG_S
#: numba puts a function's first line into the name of its files; a line more above it changes no code.
_LINE = re.compile(r"-\d+(?=\.py\d+)")


def kernel(function: Callable[..., Any]) -> Any:
    """Compile ``function`` in numba's nopython mode: cached on disk, numpy division rules, no GIL, no
    fast-math.

    Fast-math stays off because it changes the last bits between machines; the run must be reproducible.
    """
    return _compiled(function, forceinline=False)


def inlined_kernel(function: Callable[..., Any]) -> Any:
    """A :func:`kernel` that is copied into each of its callers, whatever its size.

    For large kernels that the equations of motion call once a derivative: LLVM leaves them outside, and to
    hand on arrays and tuples through the stack took 6 % of the time of a flight.
    """
    return _compiled(function, forceinline=True)


#: What rounds in another way on another processor: of ``math`` and of numpy.
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


def _compiled(function: Callable[..., Any], *, forceinline: bool) -> Any:
    _require_same_bits(function)
    options: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
    compiled = numba.njit(**options, forceinline=forceinline)(function)
    # without numba's compiler (NUMBA_DISABLE_JIT) a kernel is a plain function
    if isinstance(compiled, Dispatcher):
        compiled._cache = KeptCode(function)  # private to numba
    return compiled_by_type(compiled)


class KeptCode:
    """Machine code of one kernel on disk; stands in the place of numba's cache.

    Folder and stamp are worked out when they are first needed, since a process needs the code of few kernels:
    for all of them that took a quarter of the time in which the package is imported.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The code for a signature; ``None`` where there is none.

        numba's own makes ready for compiling first, which takes longer than to load a whole flight.
        """
        if (kept := self._kept) is None:
            return None
        rtsys.initialize(target)  # code that handles arrays calls it
        return kept._load_overload(signature, target)

    def save_overload(self, signature: Any, code: Any) -> None:
        """Keep the code for a signature, if it can be kept."""
        if self._kept is not None:
            self._kept.save_overload(signature, code)

    def flush(self) -> None:
        """Forget all code of the kernel."""
        if self._kept is not None:
            self._kept.flush()

    @property
    def cache_path(self) -> str | None:
        """Folder of the code."""
        return None if self._kept is None else self._kept.cache_path

    def __bool__(self) -> bool:
        """Whether there is code for the present sources, of any signature."""
        return self._kept is not None and bool(self._kept._cache_file)

    @cached_property
    def _kept(self) -> Any:
        """numba's cache with files of our own, in the first folder that can be written to; ``None`` without
        any, and where a source was edited while this process runs: nobody knows which it has imported.
        """
        before = SETTINGS.CACHE_LOCATOR_CLASSES
        # The locator is chosen here; setting it only here leaves other users of numba in the process alone.
        SETTINGS.CACHE_LOCATOR_CLASSES = ",".join(f"{__name__}.{locator.__name__}" for locator in LOCATORS)
        try:
            kept: Any = caching.FunctionCache(self._function)
        except RuntimeError:
            words = "no folder for machine code can be written to: it is compiled for this process alone"
            say_once(f"{words} {_ADVICE}")
            return None
        finally:
            SETTINGS.CACHE_LOCATOR_CLASSES = before
        if _edited_since_start(self._function.__code__.co_filename):
            return None
        name = _LINE.sub("", kept._impl.filename_base)
        kept._cache_file = CodeFiles(Path(kept.cache_path), name, kept._impl.locator.get_source_stamp())
        return kept


#: Files outside the package whose kernels a family of this process calls (see :mod:`edl6dof.plugins`), each
#: with the file of the package that makes the family; set before any is built.
outside_sources: dict[str, str] = {}


def called_from(path: str) -> list[str]:
    """The files outside the package whose kernels may be called from ``path``: it imports their family."""
    if not outside_sources:
        return []
    reached = TREE.reached(path)
    return sorted(file for file, family in outside_sources.items() if family in reached)


#: Folders for machine code that could be written to.
_writable: set[str] = set()


class _TreeStamp:
    """Replaces numba's stamp (one file) by the hash of the file and of the package modules it imports."""

    _py_file: str

    def get_source_stamp(self) -> str:
        """Hash that changes when this function, or anything of the package it can call, is edited."""
        return tree_stamp(self._py_file)

    def ensure_cache_path(self) -> None:
        """Make the folder and try to write into it, once for all the functions that share it; folders of
        plugins that are gone go.
        """
        folder = self.get_cache_path()
        if folder in _writable:
            return
        super().ensure_cache_path()  # type: ignore[misc]  # of the locator that this is mixed into
        _writable.add(folder)
        called = called_from(str(Path(self._py_file).resolve()))
        if called:
            note_sources(Path(folder), called)
        remove_stale(Path(folder).parent if called else Path(folder))

    def get_cache_path(self) -> str:
        """numba's folder; below it one for each set of outside files, so that flights with and without them
        do not displace each other.
        """
        folder: str = super().get_cache_path()  # type: ignore[misc]  # of the locator that this is mixed into
        if not (called := called_from(str(Path(self._py_file).resolve()))):
            return folder
        return str(Path(folder) / f"{PREFIX}{hashlib.sha256(repr(called).encode()).hexdigest()[:12]}")


class ChosenTreeLocator(_TreeStamp, caching.UserProvidedCacheLocator):
    """Cache in the directory that ``NUMBA_CACHE_DIR`` names, when it is set."""


class TreeLocator(_TreeStamp, caching.InTreeCacheLocator):
    """Cache in ``__pycache__`` beside the source, for files of the package alone: machine code beside a file
    from somebody else is not loaded.
    """

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> TreeLocator | None:
        """The locator, or none for a file outside the package."""
        inside = Path(py_file).resolve().is_relative_to(PACKAGE)
        return super().from_function(py_func, py_file) if inside else None


class UserTreeLocator(_TreeStamp, caching.UserWideCacheLocator):
    """Cache in the user's cache directory, for a package installed read-only."""

    def ensure_cache_path(self) -> None:
        """Refuse a user without a home, whom numba would give a folder called ``~`` below the current one."""
        if not isabs(self.get_cache_path()):
            raise FileNotFoundError(self.get_cache_path())
        super().ensure_cache_path()


class TemporaryTreeLocator(_TreeStamp, caching.UserWideCacheLocator):
    """Cache in a folder for temporary files that is this user's alone, for a user without a home."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        super().__init__(py_func, py_file)
        self._root = join(gettempdir(), f"edl6dof-{_user()}")
        self._cache_path = join(self._root, self.get_suitable_cache_subpath(py_file))

    def ensure_cache_path(self) -> None:
        """Refuse a folder that somebody else has made or may write to: what lies in it is run."""
        with suppress(FileExistsError):
            os.mkdir(self._root, 0o700)
        found = os.lstat(self._root)
        if not S_ISDIR(found.st_mode) or found.st_uid != _user() or S_IMODE(found.st_mode) & 0o077:
            raise PermissionError(self._root)
        super().ensure_cache_path()
        say_once(f"machine code is kept in {self._root} {_ADVICE}")

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> TemporaryTreeLocator | None:
        """The locator, or none where there is no folder for temporary files."""
        try:
            return super().from_function(py_func, py_file)
        except OSError:
            return None


#: Where compiled code is kept: the first of these that can be written to.
LOCATORS = (ChosenTreeLocator, TreeLocator, UserTreeLocator, TemporaryTreeLocator)
_ADVICE = "(NUMBA_CACHE_DIR can name a better place)"


def _user() -> int:
    """Number of the user; Windows has none, and gives each user a folder for temporary files of his own."""
    return os.getuid() if hasattr(os, "getuid") else 0


@cache
def tree_stamp(file: str) -> str:
    """Stamp of ``file`` with all that it imports, and of the flags that change compiled code.

    What may call a member of a family also depends on the members from outside the package, and on all that
    these import.
    """
    path = str(Path(file).resolve())
    stamp = TREE.stamp([path, *called_from(path)])
    return hashlib.sha256(f"{stamp} boundscheck={SETTINGS.BOUNDSCHECK}".encode()).hexdigest()


def _edited_since_start(file: str) -> bool:
    """Whether ``file`` or anything of the package that it imports was written after this process began."""
    path = str(Path(file).resolve())
    written = TREE.changed_at([path, *called_from(path)])
    if written > time.time() + _FILE_CLOCK_LAG_S:
        words = "a source is dated in the future: its machine code is not kept, and compiled each time"
        say_once(f"{words} (correct the clock, or the date of {PACKAGE})")
    return written > _STARTED


def is_cached(compiled: Any) -> bool:
    """Whether machine code of ``compiled`` for the present sources lies in the cache (any signature)."""
    kept = getattr(compiled, "_cache", None)  # a plain function has none
    return kept is None or bool(kept)
