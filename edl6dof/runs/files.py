"""Files that appear complete or not at all, and replace no other file unless forced or nothing is lost by it.

The folder of a result remembers the SHA-256 of every file that was made from it: report, plots, pages,
pictures, films, exports, wherever they were written.  A file that still is one of these, byte for byte, can
be made from the result again; any other file is the user's.

Every command imports this before it knows which plugins to load: it must import no family.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from edl6dof.config.errors import UnknownName, refusal
from edl6dof.durable import put_in_place, write_atomic
from edl6dof.manifest import MADE, hash_of

#: Most files remembered; the oldest are forgotten first, and then kept as the user's.
MOST = 1000


@contextmanager
def atomic_file(target: Path, force: bool, made_from: Path | None = None) -> Iterator[Path]:
    """Yield a hidden path beside ``target`` whose file takes its place when the block ends without an
    exception.

    Args:
        target: the file wanted.
        force: whether any file there may be replaced.
        made_from: folder of the result that the file is made from: what was made from it before may be
            replaced.

    Raises:
        ConfigError: ``target`` exists and must not be replaced, or it cannot be written.
    """
    refuse_existing_file(target, force, made_from)
    # keeps the suffix, by which writers choose a format
    partial = target.parent / f".{os.getpid()}.{target.name}"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        refuse_existing_file(target, force, made_from)  # another program may have finished meanwhile
        if made_from is not None:
            remember(made_from, partial)
        put_in_place(partial, target)
    except OSError as error:
        raise refusal(target, f"cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def refuse_existing_file(target: Path, force: bool, made_from: Path | None = None) -> None:
    """Raise :class:`ConfigError` when ``target`` must not be written; see :func:`atomic_file`."""
    if target.is_dir():
        raise refusal(target, "is a folder; name a file")
    if force or not os.path.lexists(target):
        return
    if made_from is None:
        raise refusal(target, "exists; name another file, or replace it with --force")
    if not is_made_from(made_from, target):
        words = "exists, and is not, byte for byte, what was made of this result before"
        raise refusal(target, f"{words}; name another file, or replace it with --force")


def is_made_from(result: Path, file: Path) -> bool:
    """Return whether ``file`` is, byte for byte, what was made from the result in a folder.

    Raises:
        ConfigError: it cannot be read.
    """
    known = _remembered(result)
    return bool(known) and file.is_file() and not file.is_symlink() and hash_of(file) in known


def remember(result: Path, file: Path) -> None:
    """Remember that ``file`` was made from the result in a folder.

    Where that is no folder, or cannot be written to, the file is not made again without asking.
    """
    if not result.is_dir():
        return
    digest = hash_of(file)
    known = [one for one in _remembered(result) if one != digest]
    with suppress(OSError):
        write_atomic(result / MADE, (json.dumps([*known, digest][-MOST:], indent=0) + "\n").encode())


def _remembered(result: Path) -> list[str]:
    """Digests of what was made from a result, the oldest first; none where the list is missing or damaged."""
    path = result / MADE
    try:
        found = json.loads(path.read_bytes()) if path.stat().st_size < 100 * MOST else []
    except (OSError, ValueError, RecursionError):
        return []
    return [one for one in found if isinstance(one, str)] if isinstance(found, list) else []


@contextmanager
def needing_channels(*folders: Path) -> Iterator[None]:
    """Turn a channel that the runs in the folders lack into one line.

    Raises:
        ConfigError: the runs lack a channel.
    """
    try:
        yield
    except UnknownName as error:
        words = f"no {error.kind} {error.name!r}, which is needed here; plot and export show what there is"
        raise refusal(", ".join(map(str, folders)), words) from None
