"""Folders of machine code, each named by a hash of all sources that the code in it can follow from.

numba stamps a cache entry with the file of the compiled function only; when a helper in another file is
edited, its callers keep running the old machine code (numba issues 1833 and 8851).  Here another source is
another folder, so no entry is ever stale.  A group of rooms shares a folder; a member of a family that
flights receive as a function has its own, since nothing else contains its code.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from stat import S_IMODE, S_ISDIR
from tempfile import TemporaryFile, gettempdir
from typing import Any

import numba
from platformdirs import user_cache_path

from edl6dof.kernels.store import COPIES, own_copy, say_once

#: numba's settings: a module whose names it makes when it is imported.
SETTINGS: Any = numba.config
# numba also takes settings, among them the folder whose machine code it runs, from a file of the current
# folder, which may be a received one: only the environment counts here
SETTINGS._config_fname = ""
SETTINGS.reload_config()
PACKAGE = Path(__file__).resolve().parents[1]

_SHARED = (
    *("config/units.py", "interface", "kernels/functions.py", "kernels/jit.py", "spatial"),
    *("records.py", "registry.py"),
)
_WORLD = ("environment", "vehicle", "sensors", "telemetry")
#: Rooms and files whose sources the kernels of a room can follow from; members of families only for ``rest``.
_GROUPS = {
    "shared": _SHARED,
    "software": (*_SHARED, "fsw"),
    "plant": (*_SHARED, *_WORLD, "sim/finiteness.py", "sim/functions.py", "sim/loop.py", "sim/outcome.py"),
    "ground": (*_SHARED, *_WORLD, "fsw", "metrics"),
    "rest": (*_SHARED, *_WORLD, "fsw"),
}
#: Rooms whose kernels run beside flights, each file in a folder of its own.
_GROUND = ("metrics/", "scenario/")
#: Families whose members flights receive as functions lie in these.
_WITH_MEMBERS = ("fsw/", "sensors/", "vehicle/faults/")
#: numba's settings that change machine code and are not in its own key.
_FLAGS = ("BOUNDSCHECK", "DEBUGINFO_DEFAULT", "LOOP_VECTORIZE", "OPT", "SLP_VECTORIZE")
#: Age (s) at which a folder that was not used goes: 30 days.
OLDEST_S = 30.0 * 86400.0
#: Set in a process that compiles beside another one: it keeps nothing but functions that are passed.
BESIDE = "EDL6DOF_COMPILES_BESIDE"

#: Content of the plugins of this process by absolute path: the bytes that run.
received: dict[str, bytes] = {}
#: Those of them that are compiled with the loop, not passed to it.
_in_loop: list[bytes] = []


def receive(path: Path, content: bytes, *, in_loop: bool) -> None:
    """Take ``content`` for that of the plugin ``path``; ``in_loop``: it is compiled with the loop."""
    received[str(path)] = content
    if in_loop:
        _in_loop.append(content)
        for known in (folder_of, _base):  # nothing that calls its family exists yet
            known.cache_clear()


@cache
def folder_of(file: str) -> Path | None:
    """Folder for the machine code of the kernels in ``file``; ``None`` where it cannot be kept."""
    group, stamp = _group_of(file)
    place = root()
    if not stamp or place is None:
        return None
    folder = place / f"{group}-{stamp[:32]}"
    with suppress(OSError):
        os.utime(folder)
    return folder


def place_of(file: str) -> Path | None:
    """This process's copy of :func:`folder_of`; ``None`` where there is none."""
    folder = folder_of(file)
    return None if folder is None else own_copy(folder)


def flight_mark() -> Path | None:
    """File that says that loop and flight software of the present sources have been compiled."""
    loop, software = (place_of(str(PACKAGE / name)) for name in ("sim/loop.py", "fsw/cycle.py"))
    return None if loop is None or software is None else loop / f"with-{software.name}.mark"


def _group_of(file: str) -> tuple[str, str]:
    """Name of the group of a file, and the hash of all that its machine code can follow from; the hash is
    empty where the source is not known.
    """
    path = os.path.realpath(file)
    if path.startswith(f"{PACKAGE}{os.sep}"):
        name = path[len(str(PACKAGE)) + 1 :].replace(os.sep, "/")
        for group in ("shared", "software", "plant"):
            if name.startswith(_GROUPS[group]):
                if name in _members():
                    return Path(name).stem, _hash(_base(group), _sources()[name])
                return group, _base(group)
        group = "ground" if name.startswith(_GROUND) else "rest"
        return group, _hash(_base(group), name.encode(), Path(path).read_bytes())
    if file in received:
        content = received[file]
    else:
        try:
            content = Path(path).read_bytes()
        except OSError:
            return "", ""
    return Path(path).stem, _hash(_base("rest"), path.encode(), content)


@cache
def _base(group: str) -> str:
    """Hash of what the machine code of a group follows from: sources, numba, Python and flags."""
    flags = [str(getattr(SETTINGS, name, None)) for name in _FLAGS]
    said = repr((numba.__version__, sys.version, flags))
    own = [
        part
        for name, content in _sources().items()
        if name.startswith(_GROUPS[group]) and (group == "rest" or name not in _members())
        for part in (name.encode(), content)
    ]
    return _hash(said, *own, *(_in_loop if group in ("plant", "ground", "rest") else ()))


def _hash(*parts: str | bytes) -> str:
    found = sha256()
    for part in parts:
        content = part.encode() if isinstance(part, str) else part
        found.update(len(content).to_bytes(8, "big") + content)
    return found.hexdigest()


@cache
def _sources() -> dict[str, bytes]:
    """Sources of all groups by path below the package."""
    names = {name for group in _GROUPS.values() for name in group}
    files = [file for name in names for file in _files(PACKAGE / name)]
    return {file.relative_to(PACKAGE).as_posix(): file.read_bytes() for file in sorted(files)}


def _files(place: Path) -> Iterator[Path]:
    return place.rglob("*.py") if place.is_dir() else iter([place])


@cache
def _members() -> frozenset[str]:
    """Files that define members which flights receive as functions."""
    return frozenset(
        name
        for name, content in _sources().items()
        if name.startswith(_WITH_MEMBERS) and b"\nMEMBER" in content
    )


@cache
def root() -> Path | None:
    """Folder for the machine code of this user; ``None`` where none can be written to."""
    if SETTINGS.CACHE_DIR:
        places = [Path(SETTINGS.CACHE_DIR) / "edl6dof"]
    else:
        places = [user_cache_path("edl6dof") / "kernels", Path(gettempdir()) / f"edl6dof-{_user()}"]
    found = next(filter(_can_be_written, places), None)
    if found is None:
        say_once(
            f"no folder for machine code can be written to: it is compiled for this process alone {_ADVICE}"
        )
    elif found != places[0]:
        say_once(f"machine code is kept in {found} {_ADVICE}")
    if found is not None:
        _remove_unused(found)
    return found


_ADVICE = "(NUMBA_CACHE_DIR can name a better place)"


def _can_be_written(folder: Path) -> bool:
    """Whether it is a folder that this user can write to, and nobody else: what lies in it is run."""
    if not folder.is_absolute():  # a user without a home
        return False
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = os.lstat(folder)
        open_to_others = S_IMODE(found.st_mode) & 0o022 and os.name != "nt"
        if not S_ISDIR(found.st_mode) or found.st_uid != _user() or open_to_others:
            return False
        TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def _user() -> int:
    """Number of the user; Windows has none, and gives each user a folder for temporary files of his own."""
    return os.getuid() if hasattr(os, "getuid") else 0


def _remove_unused(place: Path) -> None:
    with suppress(OSError):
        for one in os.scandir(place):
            in_use = one.name.startswith(COPIES) or not one.is_dir(follow_symlinks=False)
            if not in_use and time.time() - one.stat().st_mtime > OLDEST_S:
                rmtree(one, ignore_errors=True)


class Locator:
    """Tells numba where the machine code of a kernel is kept (``NUMBA_CACHE_LOCATOR_CLASSES``)."""

    def __init__(self, function: Callable[..., Any], file: str, folder: Path) -> None:
        within = file.startswith(str(PACKAGE))
        self._name = file[len(str(PACKAGE)) + 1 : -3].replace(os.sep, ".") if within else ""
        self._folder = folder
        self._line = function.__code__.co_firstlineno
        self._py_file = file  #: numba's warnings name it

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Locator | None:
        """The locator of a function in a file; ``None`` where its code cannot be kept."""
        folder = place_of(file)
        return None if folder is None else cls(function, file, folder)

    def ensure_cache_path(self) -> None:
        """Nothing: the folder is there."""

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Nothing: another source has another folder."""
        return ""

    def get_disambiguator(self) -> str:
        """File and line, since functions in different files of a group may have the same name."""
        return f"{self._name}-{self._line}"


@contextmanager
def in_own_folders() -> Iterator[None]:
    """Let numba ask :class:`Locator` where the functions compiled in the block are kept, and those of other
    users of numba where it always does.
    """
    before = SETTINGS.CACHE_LOCATOR_CLASSES
    SETTINGS.CACHE_LOCATOR_CLASSES = f"{__name__}.{Locator.__name__}"
    try:
        yield
    finally:
        SETTINGS.CACHE_LOCATOR_CLASSES = before
