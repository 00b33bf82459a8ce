"""Files that are whole after a kill or a power cut: the old one or the new one.

A file is written next to its place, forced to the disk and renamed, and the folder is forced to the disk too:
without that a power cut can undo the rename, and with it the order in which files appeared.
"""

from __future__ import annotations

import os
from pathlib import Path


def write_atomic(path: Path, content: bytes | memoryview) -> None:
    """Write a file; if the program is killed meanwhile, ``path`` is unchanged or has all of ``content``.

    Raises:
        OSError: the file cannot be written; ``path`` is unchanged.
    """
    partial = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        partial.write_bytes(content)
        put_in_place(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def put_in_place(partial: Path, target: Path) -> None:
    """Rename a finished file or folder, durably, to ``target`` of the same folder, which is replaced."""
    if partial.is_file():
        sync(partial)
    os.replace(partial, target)
    sync(target.parent)


def make_folder(path: Path) -> None:
    """Make a folder and its missing parents, durably."""
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
