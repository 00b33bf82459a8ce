"""Copies of folders of machine code: each process has its own, checked when it is taken and kept at the end.

numba's index is not made for several processes that save at once, it loads whatever lies on disk, and an
error while it saves ends the program.  Here it only sees a folder of links that nobody else writes to.  What
it adds is kept by exchanging the whole folder, with a checksum for each file.
"""

from __future__ import annotations

import atexit
import json
import os
import sys
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from shutil import copyfile, disk_usage, rmtree

from filelock import FileLock

#: Checksums of the files of a folder that is kept, by name.
_SUMS = "sums.json"
#: How the folders of processes for their copies begin.
COPIES = "edl6dof-process-"
#: Room (bytes) that a process needs for what it compiles; all code of the package takes a quarter.
NEEDED_B = 256 << 20
#: Time (s) to wait for another process that takes or keeps folders.
_PATIENCE_S = 20.0

#: Files by name, each with numbers that change when it is written anew.
_Files = dict[str, tuple[int, int]]
#: Copies of this process by folder, each with its files when it was last like the folder.
_copies: dict[Path, tuple[Path, _Files]] = {}


@cache
def own_copy(kept: Path) -> Path | None:
    """This process's copy of a folder; ``None`` where there is no room for any."""
    if (place := _place(kept.parent)) is None:
        return None
    own = place / kept.name
    own.mkdir()
    _take_alone(kept, own)
    _copies[kept] = own, _files(own)
    return own


def take() -> None:
    """Take what other processes have kept since, of functions that this one has no code of."""
    for kept, (own, before) in list(_copies.items()):
        added_to = _files(own) != before
        _take_alone(kept, own)
        if not added_to:
            _copies[kept] = own, _files(own)


def keep() -> None:
    """Keep what this process has compiled for the next ones."""
    for kept, (own, before) in list(_copies.items()):
        if _files(own) == before:
            continue
        try:
            with _alone(kept.parent):
                _take(kept, own)
                _exchange(kept, own)
        except OSError as error:
            say_once(f"machine code cannot be kept in {kept.parent}: {error}")
        _copies[kept] = own, _files(own)


@cache
def say_once(message: str) -> None:
    """One line on standard error, once in a process."""
    print(f"edl6dof: {message}", file=sys.stderr)


@cache
def _place(root: Path) -> Path | None:
    """Folder of this process for its copies; it goes when the process ends."""
    for place in (root, Path(tempfile.gettempdir())):
        with suppress(OSError), _alone(root):
            if disk_usage(place).free < NEEDED_B:
                continue
            _remove_left_behind(place)
            own = Path(tempfile.mkdtemp(prefix=COPIES, dir=place))
            in_use = FileLock(own / "in-use")
            in_use.acquire()
            atexit.register(_end, own, in_use, os.getpid())
            return own
    say_once(f"there is no room for machine code in {root}: it is compiled for this process alone")
    return None


def _end(own: Path, in_use: FileLock, process: int) -> None:
    if os.getpid() == process:  # a fork leaves the copies to whom they belong
        keep()
        in_use.release()
        rmtree(own, ignore_errors=True)


def _remove_left_behind(place: Path) -> None:
    """Remove the copies of processes that died."""
    for own in place.glob(f"{COPIES}*"):
        with suppress(OSError), FileLock(own / "in-use", timeout=0.0):
            rmtree(own, ignore_errors=True)


@contextmanager
def _alone(root: Path) -> Iterator[None]:
    with FileLock(root / "lock", timeout=_PATIENCE_S):
        yield


def _take_alone(kept: Path, own: Path) -> None:
    with suppress(OSError), _alone(kept.parent):
        _take(kept, own)


def _take(kept: Path, own: Path) -> None:
    """Link the files of functions that the copy lacks; none where one of them is damaged."""
    here = {_function(name) for name in _files(own)}
    try:
        sums = json.loads((kept / _SUMS).read_bytes())
        lacking = [name for name in sums if _function(name) not in here]
        damaged = [name for name in lacking if _sum(kept / name) != sums[name]]
    except FileNotFoundError:
        if not kept.exists():
            return
        damaged = [_SUMS]
    except (OSError, ValueError, TypeError, AttributeError):
        damaged = [_SUMS]
    if damaged:
        say_once(f"machine code in {kept} is damaged; it is compiled again")
        return
    for name in lacking:
        _link(kept / name, own / name)


def _exchange(kept: Path, own: Path) -> None:
    """Put the files of the copy in the place of the folder."""
    new = Path(tempfile.mkdtemp(prefix="new-", dir=kept.parent))
    try:
        names = _files(own)
        for name in names:
            _link(own / name, new / name)
        (new / _SUMS).write_text(json.dumps({name: _sum(new / name) for name in names}), encoding="utf-8")
        if kept.exists():
            kept.rename(new / "before")
        new.rename(kept)
        rmtree(kept / "before", ignore_errors=True)
    except OSError:
        rmtree(new, ignore_errors=True)
        raise


def _link(file: Path, name: Path) -> None:
    try:
        os.link(file, name)
    except OSError:  # another disk, or one without links
        copyfile(file, name)


def _function(name: str) -> str:
    """Function of a file of numba's: an index ``FUNCTION.py311.nbi``, or code ``FUNCTION.py311.1.nbc``."""
    stem, _, kind = name.rpartition(".")
    return stem.rpartition(".")[0] if kind == "nbc" else stem


def _files(folder: Path) -> _Files:
    """Files of machine code in a folder."""
    found = [one for one in os.scandir(folder) if ".tmp." not in one.name]
    return {one.name: (one.inode(), one.stat().st_mtime_ns) for one in found}


def _sum(file: Path) -> int:
    return zlib.crc32(file.read_bytes())
