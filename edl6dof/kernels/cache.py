"""Machine code on disk: numba's own files, named by a hash of all sources that their code depends on.

numba stamps a cache entry with the file of the compiled function only; when a helper in another file is
edited, its callers keep running the old machine code (numba issues 1833 and 8851).  Here the name of a file
contains a hash of the function's source and of those it imports, so that no entry is ever stale.  Files
are sealed with a hash of their content, which ``pickle`` does not read: a flipped bit is found.
"""

from __future__ import annotations

import os
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from pickle import UnpicklingError
from shutil import disk_usage, rmtree
from stat import S_IMODE, S_ISDIR
from tempfile import TemporaryFile, gettempdir
from typing import Any

import numba
from filelock import FileLock, Timeout
from platformdirs import user_cache_path

from edl6dof.kernels.shipped import ARCHIVE, TARGET, is_usable, unpack

#: numba's settings: a module whose attributes are created when it is imported.
SETTINGS: Any = numba.config
# numba also takes settings, among them the folder whose machine code it runs, from a file of the current
# folder, which may be a received one: only the environment counts here
SETTINGS._config_fname = ""
SETTINGS.reload_config()
if SHIPPED := SETTINGS.CPU_NAME is None and is_usable():  # all code is for the same processors then
    SETTINGS.CPU_NAME, SETTINGS.CPU_FEATURES = TARGET, ""
PACKAGE = Path(__file__).resolve().parents[1]

#: Members of families here are passed to flights as functions: no other machine code depends on them.
_WITH_MEMBERS = tuple(str(PACKAGE / room) for room in ("fsw", "sensors", "vehicle/faults"))
#: numba's settings that change machine code and are not in its own key.
_FLAGS = ("BOUNDSCHECK", "DEBUGINFO_DEFAULT", "LOOP_VECTORIZE", "OPT", "SLP_VECTORIZE")
#: Age (s) since the last use at which a folder is removed: 30 days.
OLDEST_S = 30.0 * 86400.0
#: Room (bytes) that must be free on the disk: all code of the package takes half.
NEEDED_B = 256 << 20
#: When this process began, s since 1970, by the clock that dates files, which may lag by 0.1 s.
_STARTED = time.time() - 0.1
#: Time (s) to wait for another process that writes.
_PATIENCE_S = 20.0
_IMPORT = re.compile(rb"^from edl6dof\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)
#: Exceptions of Python's ``pickle``, which no kernel raises.
_UNREADABLE = (AttributeError, EOFError, ImportError, UnpicklingError)
_ADVICE = "(NUMBA_CACHE_DIR can name a better place)"

#: Files that numba changed and that are to be sealed: folder and begin of their names.
_changed: set[tuple[Path, str]] = set()

#: Content of the plugins of this process by absolute path: the bytes that run.
received: dict[str, bytes] = {}
#: Content of the plugins that are compiled with the loop, not passed to it.
_in_loop: list[bytes] = []


def receive(path: Path, content: bytes, *, in_loop: bool) -> None:
    """Register the ``content`` of the plugin ``path``; ``in_loop``: the plugin is compiled with the loop."""
    received[str(path)] = content
    if in_loop:
        _in_loop.append(content)
        folder.cache_clear()  # nothing that calls its family exists yet


@cache
def stamp(file: str) -> str:
    """Hash of a source file, its path, and the sources of the package that it imports.  Empty if a source
    cannot be read, or was written after this process began: the process may have imported another version.
    """
    try:
        if file not in received and os.stat(file).st_mtime > _STARTED:
            return ""
        content = received[file] if file in received else Path(file).read_bytes()
    except OSError:
        return ""
    found = [stamp(one) for one in _imported(content)]
    return hash_of(_inside(file), content, *found) if all(found) else ""


def _inside(file: str) -> str:
    """Path of a file, the same wherever the package is installed."""
    return file.removeprefix(str(PACKAGE))


def _imported(content: bytes) -> list[str]:
    """Files of the package that a source imports, except members of families that flights receive."""
    found = set()
    for module, names in _IMPORT.findall(content):
        place = str(PACKAGE.joinpath(*module.decode().split(".")))
        for name in re.findall(r"\w+", names.decode()):
            files = f"{place}/{name}.py", f"{place}.py", f"{place}/{name}/__init__.py", f"{place}/__init__.py"
            found.add(next(filter(os.path.isfile, files)))
    return sorted(one for one in found if not _is_member(one))


@cache
def _is_member(file: str) -> bool:
    return file.startswith(_WITH_MEMBERS) and b"\nMEMBER" in Path(file).read_bytes()


def hash_of(*parts: str | bytes) -> str:
    """Hash of some parts and of the boundaries between them."""
    found = sha256()
    for part in parts:
        content = part.encode() if isinstance(part, str) else part
        found.update(len(content).to_bytes(8, "big") + content)
    return found.hexdigest()


@cache
def folder() -> Path | None:
    """Folder for the machine code of this installation; ``None`` where it cannot be kept."""
    if (root := _root()) is None:
        return None
    flags = [str(getattr(SETTINGS, name, None)) for name in _FLAGS]
    code = ARCHIVE.stat().st_mtime_ns if SHIPPED else 0
    place = root / hash_of(repr((str(PACKAGE), numba.__version__, sys.version, flags, code)), *_in_loop)[:16]
    if SHIPPED and not place.exists():
        try:
            unpack(place)
        except OSError as error:
            say_once(f"machine code of {ARCHIVE} is not used: {error}")
    place.mkdir(exist_ok=True)
    with suppress(OSError):
        os.utime(place)
        for one in os.scandir(root):
            if one.is_dir(follow_symlinks=False) and time.time() - one.stat().st_mtime > OLDEST_S:
                rmtree(one, ignore_errors=True)
    return place


def _root() -> Path | None:
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
    return found


def _can_be_written(place: Path) -> bool:
    """Return True if this user, and no other, can write to the folder, since its files are executed."""
    if not place.is_absolute():  # a user without a home
        return False
    try:
        place.mkdir(mode=0o700, parents=True, exist_ok=True)
        found = os.lstat(place)
        open_to_others = S_IMODE(found.st_mode) & 0o022 and os.name != "nt"
        if not S_ISDIR(found.st_mode) or found.st_uid != _user() or open_to_others:
            return False
        TemporaryFile(dir=place).close()
    except OSError:
        return False
    return disk_usage(place).free >= NEEDED_B


def _user() -> int:
    """Number of the user, 0 on Windows, where each user has a folder for temporary files."""
    return os.getuid() if hasattr(os, "getuid") else 0


@cache
def say_once(message: str) -> None:
    """Print a line on standard error, once in a process."""
    print(f"edl6dof: {message}", file=sys.stderr)


def _drop_all() -> None:
    """Remove all machine code: a file of it is damaged, or contains types that no longer exist."""
    if (place := folder()) is not None:
        for file in place.iterdir():
            _drop(file)


def _drop(file: Path) -> None:
    say_once(f"machine code in {file.parent} is damaged; it is compiled again")
    file.unlink(missing_ok=True)


def _is_sound(file: Path) -> bool:
    """Return True if the content of a file fits its seal, or the file has no seal and ends like a pickle."""
    try:
        content = file.read_bytes()
    except OSError:  # another process has removed it
        return True
    return content.endswith(b".") or content[-64:] == hash_of(content[:-64]).encode()


def _seal(place: Path, name: str) -> None:
    for file in place.glob(f"{name}*.nb[ci]"):
        if (content := file.read_bytes()).endswith(b"."):
            with file.open("ab") as to:
                to.write(hash_of(content).encode())


@contextmanager
def experimental() -> Iterator[None]:
    """Ignore numba's warning that functions as arguments are an experimental feature."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", numba.NumbaExperimentalFeatureWarning)
        yield


def compiled(call: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """Result of a call that may compile; the call is repeated if machine code cannot be read or written."""
    with experimental():
        try:
            return call(*given, **named)
        except _UNREADABLE:
            _drop_all()
            return call(*given, **named)
        except OSError as error:  # no kernel raises it
            say_once(f"machine code is not kept: {error.strerror}: {folder()} {_ADVICE}")
            return call(*given, **named)
        finally:
            written()


@cache
def _writing(place: Path) -> FileLock:
    return FileLock(f"{place}.lock")


def written() -> None:
    """Seal what numba has written, and let other processes write machine code again."""
    if (place := folder()) is not None and (lock := _writing(place)).is_locked:
        while _changed:
            with suppress(OSError):  # the disk is full: without a seal
                _seal(*_changed.pop())
        lock.release()


class Locator:
    """Place of the machine code of a kernel, for numba (``NUMBA_CACHE_LOCATOR_CLASSES``)."""

    def __init__(self, function: Any, file: str, place: Path) -> None:
        self._py_file = file  #: numba's warnings name it
        self._folder = place
        self._of, self._stamp = hash_of(_inside(file))[:8], hash_of(*_stamps(function))[:24]
        self._name = f"{Path(file).stem}.{function.__qualname__}-{self._of}".replace("<", "").replace(">", "")

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> Locator | None:
        """Locator of a variant of a kernel; ``None`` where no machine code can be stored."""
        place = folder()
        return None if place is None else cls(function, file, place)._examined()

    def _examined(self) -> Locator:
        """Remove damaged files of the function; print a line if it has no files and must be compiled."""
        own = [name for name in _left_behind(self._folder).get(self._name, ()) if self._stamp in name]
        for name in own:
            if not _is_sound(self._folder / name):
                _drop(self._folder / name)
        if not own and sys.stderr.isatty():
            say_once(
                "compiling, which takes a minute where nothing is compiled yet; it is kept for later ..."
            )
        return self

    def ensure_cache_path(self) -> None:
        """Lock the folder until :func:`written`, since numba reads, changes and writes an index now, and
        remove the code of other sources.
        """
        with suppress(Timeout):
            _writing(self._folder).acquire(timeout=_PATIENCE_S)
        _changed.add((self._folder, f"{self._name}-{self._stamp}"))
        for name in _left_behind(self._folder).pop(self._name, ()):
            if self._stamp not in name:
                (self._folder / name).unlink(missing_ok=True)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return no stamp: the files of another source have other names."""
        return ""

    def get_disambiguator(self) -> str:
        """Hashes of path and sources, for the names of files."""
        return f"{self._of}-{self._stamp}"


def _stamps(function: Any) -> list[str]:
    return list(map(stamp, (function.__code__.co_filename, *function.follows)))


@cache
def _left_behind(place: Path) -> dict[str, list[str]]:
    """Names of the files in the folder when this process first lists it, by function."""
    found: dict[str, list[str]] = {}
    for name in os.listdir(place):
        found.setdefault(name.rpartition("-")[0], []).append(name)
    return found


@contextmanager
def in_own_folder(function: Any) -> Iterator[bool]:
    """Make numba ask :class:`Locator` for the place of a variant of a kernel, without effect on other users
    of numba; yield True if the machine code can be stored.
    """
    before = SETTINGS.CACHE_LOCATOR_CLASSES
    SETTINGS.CACHE_LOCATOR_CLASSES = f"{__name__}.{Locator.__name__}"
    try:
        yield folder() is not None and all(_stamps(function))
    finally:
        SETTINGS.CACHE_LOCATOR_CLASSES = before
