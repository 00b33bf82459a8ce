"""Machine code on disk: a file for each function, signature and state of the sources, that several processes
may write at once.

numba keeps an index beside numbered files; two processes that compile at once can each take a number for
something else, and an index that was cut short stops the program.  Here the name of a file says what is in
it, the file appears whole, and a checksum says whether
it still is: what is missing or damaged is compiled again.
"""

from __future__ import annotations

import os
import pickle
import sys
import zlib
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any
from uuid import uuid4

import numba
from numba.core.serialize import dumps

_CHECKSUM_BYTES = 4


class CodeFiles:
    """The files of one function; stands in the place of numba's ``IndexDataCacheFile``."""

    def __init__(self, folder: Path, name: str, stamp: str) -> None:
        """``name``: of the function, unique in the folder; ``stamp``: hash of the sources that its code
        follows from.
        """
        self._folder, self._name = folder, name
        self._fresh = f"{name}.{stamp[:16]}."

    def __bool__(self) -> bool:
        """Whether there is code for the present sources, of any signature."""
        return any(self._files(self._fresh))

    def load(self, key: Any) -> Any:
        """What was saved under a key (signature, processor, hashes); ``None`` when it is not there or
        damaged.
        """
        path = self._path(key)
        try:
            with path.open("rb") as file:
                owner, content = os.fstat(file.fileno()).st_uid, file.read()
        except OSError:
            return None
        if owner not in trusted_users():
            say_once(f"machine code in {self._folder} is another user's; it is not loaded")
            return None
        code = memoryview(content)[_CHECKSUM_BYTES:]
        try:
            if content[:_CHECKSUM_BYTES] != _checksum(code):
                raise ValueError("checksum")
            return pickle.loads(code)
        except Exception:  # whatever a damaged pickle raises
            say_once(f"machine code in {self._folder} is damaged; it is compiled again")
            return None

    def save(self, key: Any, data: Any) -> None:
        """Keep data under a key, and drop what other states of the sources left."""
        code = dumps(data)
        partial = self._folder / f"{self._name}.{uuid4().hex}.part"
        try:
            partial.write_bytes(_checksum(code) + code)
            os.replace(partial, self._path(key))
        except OSError as error:
            with suppress(OSError):
                partial.unlink(missing_ok=True)
            say_once(f"machine code cannot be kept in {self._folder}: {error.strerror or error}")
            return
        for path in self._files(f"{self._name}."):
            if not path.name.startswith(self._fresh):
                path.unlink(missing_ok=True)

    def flush(self) -> None:
        """Forget all code of the function."""
        for path in self._files(f"{self._name}."):
            path.unlink(missing_ok=True)

    def _path(self, key: Any) -> Path:
        return (
            self._folder
            / f"{self._fresh}{sha256(repr((numba.__version__, key)).encode()).hexdigest()[:32]}.nbc"
        )

    def _files(self, start: str) -> list[Path]:
        try:
            names = os.listdir(self._folder)
        except OSError:
            return []
        return [
            self._folder / name
            for name in names
            if name.startswith(start) and name.endswith((".nbc", ".nbi"))
        ]


@cache
def trusted_users() -> frozenset[int]:
    """Numbers of the users whose machine code is run: this one, the administrator, and whoever installed the
    package.  Windows has no such numbers, and says 0 for every file.
    """
    own = os.getuid() if hasattr(os, "getuid") else 0
    return frozenset((0, own, os.stat(__file__).st_uid))


@cache
def say_once(message: str) -> None:
    """One line on standard error, once in a process."""
    print(f"edl6dof: {message}", file=sys.stderr)


def _checksum(code: bytes | memoryview) -> bytes:
    return zlib.crc32(code).to_bytes(_CHECKSUM_BYTES, "big")
