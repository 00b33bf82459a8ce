"""Files that appear complete or not at all, and take no other file's place unless told to, or where nothing
is lost by it.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from edl6dof.config.errors import refusal
from edl6dof.durable import put_in_place
from edl6dof.runs.made import is_made_from, remember


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
    """Raise :class:`ConfigError` when ``target`` must not be written; the arguments are those of
    :func:`atomic_file`.
    """
    if target.is_dir():
        raise refusal(target, "is a folder; name a file")
    if force or not os.path.lexists(target):
        return
    if made_from is None:
        raise refusal(target, "exists; name another file, or replace it with --force")
    if not is_made_from(made_from, target):
        words = f"exists, and is not what was made from {made_from}, unchanged"
        raise refusal(target, f"{words}; name another file, or replace it with --force")
