"""What does as the name of a folder on every system: names of scenarios become names of run folders."""

from __future__ import annotations

import re

_FOLDER_NAME = re.compile(r"[\w+-]([\w .+-]*[\w+-])?")
#: A file system keeps 255 bytes of a name, and programs add to it: the number of a case, the ending, a mark
#: of what is unfinished.
_LONGEST_NAME = 150


def why_no_folder(name: str) -> str | None:
    """Why a name does not do as that of a folder; ``None`` when it does."""
    if not _FOLDER_NAME.fullmatch(name):
        return (
            "must do as a folder name: letters, digits, blanks and . _ + -, no dot or blank at the "
            f"ends (got {name!r})"
        )
    if (length := len(name.encode())) > _LONGEST_NAME:
        return f"must do as a folder name: at most {_LONGEST_NAME} bytes (got {length})"
    return None
