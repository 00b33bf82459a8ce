"""Files that a kill or a power cut leaves whole: the old one or the new one, never something between.

A file is written beside its place, forced to the disk, renamed, and the folder that now lists it is forced to
the disk too: without the last step a power cut can undo the rename, and with it the order in which files
appeared.
"""

from __future__ import annotations

import os
from pathlib import Path


def write_atomic(path: Path, content: bytes | memoryview) -> None:
    """Write a file; whatever ends the program meanwhile, ``path`` is as it was or holds all of ``content``.

    Raises:
        OSError: it cannot be written; ``path`` is as it was.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        partial.write_bytes(content)
        put_in_place(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def put_in_place(partial: Path, target: Path) -> None:
    """Give a finished file (or folder) of the same folder its name, durably, in place of what has that name
    now.
    """
    if partial.is_file():
        sync(partial)
    os.replace(partial, target)
    sync(target.parent)


def make_folder(path: Path) -> None:
    """Make a folder and those above it that are missing, durably; one that is there stays as it is."""
    for folder in reversed([path, *path.parents]):
        if not folder.is_dir():
            folder.mkdir()
            sync(folder.parent)


def sync(path: Path) -> None:
    """Force a file, or the list of names in a folder, to the disk."""
    if path.is_dir() and os.name == "nt":
        return  # Windows opens no folders, and writes their lists through
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
