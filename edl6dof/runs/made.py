"""What was made from a result, and may therefore be made again without asking.

The folder of a result remembers the SHA-256 of every file that was made from it: report, plots, pages,
pictures, films, exports, wherever they were written.  A file that still is one of these, byte for byte, can
be made from the result again, so nothing is lost where it is replaced.  Any other file is the user's.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from edl6dof.durable import write_atomic
from edl6dof.manifest import MADE, hash_of

#: Most files remembered; the oldest are forgotten first, and then kept as the user's.
MOST = 1000


def is_made_from(result: Path, file: Path) -> bool:
    """Whether ``file`` is, byte for byte, what was made from the result in a folder.

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
