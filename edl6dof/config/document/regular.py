"""Read files of unknown origin: regular files of bounded size, so that no read blocks or fills memory."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

#: Size, in bytes, of the largest table of numbers that is read.
LARGEST_TABLE = 10_000_000

_NO_WAIT = getattr(os, "O_NONBLOCK", 0)


def read_regular(path: Path, largest: int = LARGEST_TABLE) -> bytes:
    """Content of a regular file of at most ``largest`` bytes.

    Raises:
        OSError: the file is missing, a folder, a device, a pipe or a socket, or too large (see ``strerror``).
    """
    found = os.stat(path)  # before it is opened: opening some devices does something
    if not stat.S_ISREG(found.st_mode) and not stat.S_ISDIR(found.st_mode):
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | _NO_WAIT)) as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise OSError(
            errno.EFBIG,
            f"it has {max(found.st_size, len(content))} bytes; at most {largest} are allowed",
            str(path),
        )
    return content


def read_regular_text(path: Path, largest: int = LARGEST_TABLE, encoding: str = "utf-8") -> str:
    """Text of a regular file of at most ``largest`` bytes.

    Raises:
        OSError: as :func:`read_regular`.
        UnicodeDecodeError: the file is not text in that encoding.
    """
    return read_regular(path, largest).decode(encoding)
