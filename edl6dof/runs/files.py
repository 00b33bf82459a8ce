"""Files that appear complete or not at all, and take no other file's place unless told to."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from edl6dof.config.errors import refusal
from edl6dof.durable import put_in_place


@contextmanager
def atomic_file(target: Path, force: bool) -> Iterator[Path]:
    """Yield a hidden path beside ``target`` whose file takes its place when the block ends without an
    exception.

    Raises:
        ConfigError: ``target`` exists and ``force`` is not set, or it cannot be written.
    """
    refuse_existing_file(target, force)
    # keeps the suffix, by which writers choose a format
    partial = target.parent / f".{os.getpid()}.{target.name}"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        refuse_existing_file(target, force)  # another program may have finished meanwhile
        put_in_place(partial, target)
    except OSError as error:
        raise refusal(target, f"cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def refuse_existing_file(target: Path, force: bool) -> None:
    """Raise :class:`ConfigError` when ``target`` must not be written."""
    if target.is_dir():
        raise refusal(target, "is a folder; name a file")
    if target.exists() and not force:
        raise refusal(target, "exists; name another file, or replace it with --force")
