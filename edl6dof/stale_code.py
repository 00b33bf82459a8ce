"""Folders of machine code that belong to plugins: each says of which files, and goes when one of them is
gone.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from shutil import rmtree

#: Names of the folders, and of the list in each.
PREFIX, LIST = "plugins-", "sources.txt"
#: Age (s) at which a folder without a list goes: 30 days.
OLDEST_S = 30.0 * 86400.0


def note_sources(folder: Path, files: Sequence[str]) -> None:
    """Write into a plugins' folder the files that its machine code is made of."""
    (folder / LIST).write_text("\n".join(files), encoding="utf-8")


def remove_stale(parent: Path) -> None:
    """Remove the plugins' folders in ``parent`` whose files are no longer all there."""
    for folder in parent.glob(f"{PREFIX}*"):
        if _is_stale(folder):
            rmtree(folder, ignore_errors=True)


def _is_stale(folder: Path) -> bool:
    try:
        files = (folder / LIST).read_text(encoding="utf-8").splitlines()
        return not all(Path(file).is_file() for file in files)
    except FileNotFoundError:
        return folder.is_dir() and time.time() - folder.stat().st_mtime > OLDEST_S
    except OSError:
        return False
