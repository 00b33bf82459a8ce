"""A run folder that appears complete or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class FolderExists(Exception):
    """The run folder is there already and may not be replaced."""


@contextmanager
def atomic_folder(target: Path, force: bool) -> Iterator[Path]:
    """Yield a hidden folder beside ``target`` that takes its place when the block ends without an exception.

    A kill leaves at most the hidden folder; the next run into the same target removes it.

    Raises:
        FolderExists: ``target`` exists and ``force`` is not set.
    """
    refuse_existing(target, force)
    target.parent.mkdir(parents=True, exist_ok=True)
    _sweep(target)
    partial = target.parent / f".{target.name}.{os.getpid()}.part"
    partial.mkdir()
    try:
        yield partial
        if target.exists():
            old = target.parent / f".{target.name}.{os.getpid()}.old"
            target.rename(old)
            partial.rename(target)
            shutil.rmtree(old)
        else:
            partial.rename(target)
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def refuse_existing(target: Path, force: bool) -> None:
    """Raise :class:`FolderExists` when ``target`` must not be replaced; a file in its place is never replaced."""
    if target.is_dir() and not force and any(target.iterdir()):
        raise FolderExists(f"{target} exists; choose another folder with --out, or replace it with --force")
    if target.exists() and not target.is_dir():
        raise FolderExists(f"{target} is a file, not a folder; choose another folder with --out")
    if force and target.is_dir() and any(target.iterdir()) and not (target / "summary.json").is_file():
        raise FolderExists(f"{target} is not a run folder (no summary.json); it is not replaced even with --force")


def _sweep(target: Path) -> None:
    """Remove what killed runs into the same target left behind; a folder whose process still lives is kept."""
    for left in target.parent.glob(f".{target.name}.*.part"):
        pid = left.name.split(".")[-2]
        if pid.isdigit() and not _alive(int(pid)):
            shutil.rmtree(left, ignore_errors=True)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
