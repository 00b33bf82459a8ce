"""The manifest of a result folder: what kind of result it is, and the SHA-256 of every file that was written
with it.

By the manifest a folder is known again as one of this program's, so that nothing else is ever replaced, and a
file that has changed since it was written is noticed before anything is read out of it::

    {"written_by": "edl6dof 0.1.0", "kind": "flight", "files": {"summary.json": "5f1c"}, "sha256": "02ab"}

The last key is the hash of all else in it, as in the JSON files of a campaign.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatchcase
from io import BufferedReader
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from edl6dof import __version__
from edl6dof.config.errors import refusal
from edl6dof.durable import sync, write_atomic

MANIFEST = "manifest.json"

#: What was made from the result later, and may be made again (:mod:`edl6dof.runs.files`).
MADE = "made.json"

#: What a folder may be the result of.
Kind = Literal["flight", "study", "validation", "calibration"]

#: Files that commands write later into the folder of a flight; a user's own files never look like these.
_LATER = (
    *(MADE, "report.html", "report.pdf", "report/*.png"),
    *("plots/*.html", "plots/*.png", "plots/*.pdf", "plots/*.svg", "compared-with-*.html"),
    *("telemetry.csv", "telemetry.mat", "telemetry.nc", "orbit.oem", "attitude.aem", "nesc.csv"),
)


class Sealed(BaseModel):
    """Content of a JSON file that carries its own hash."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Content = TypeVar("Content", bound=Sealed)

#: Key under which a sealed file holds the hash of all else in it.
_SEAL = "sha256"


def digest(data: Any) -> str:
    """SHA-256 of plain data; the order of keys does not count."""
    return sha256(json.dumps(data, sort_keys=True).encode())


def write_sealed(path: Path, data: Sealed) -> None:
    """Write a JSON file that carries its own hash, durably."""
    plain = data.model_dump(mode="json")
    write_atomic(path, (json.dumps({**plain, _SEAL: digest(plain)}, indent=1) + "\n").encode())


def read_sealed(path: Path, kind: type[Content]) -> Content:
    """Read what :func:`write_sealed` wrote.

    Raises:
        ConfigError: it cannot be read, or is not as it was written.
    """
    try:
        plain = json.loads(read_file(path))
        intact = isinstance(plain, dict) and plain.pop(_SEAL, None) == digest(plain)
    except (ValueError, RecursionError):
        intact = False
    if not intact:
        raise refusal(path, "is damaged: it is not as it was written")
    try:
        return kind.model_validate_json(json.dumps(plain))
    except ValidationError:
        raise refusal(path, "was written by another version of edl6dof") from None


class _Content(Sealed):
    """Content of a manifest."""

    written_by: str
    kind: Kind
    files: dict[str, str]


def seal(folder: Path, kind: Kind) -> None:
    """Write the manifest of a finished folder, and force all of it to the disk."""
    names = sorted(_names(folder))
    for name in names:
        sync(folder / name)
    files = {name: hash_of(folder / name) for name in names}
    write_sealed(folder / MANIFEST, _Content(written_by=f"edl6dof {__version__}", kind=kind, files=files))


@dataclass(frozen=True)
class Manifest:
    """Manifest of a folder.

    Attributes:
        folder: the folder.
        kind: of result.
        files: SHA-256 (hexadecimal) of each file by its name.
    """

    folder: Path
    kind: Kind
    files: dict[str, str]

    @classmethod
    def of(cls, folder: Path) -> Manifest:
        """Read the manifest of a folder.

        Raises:
            ConfigError: there is none, or it is damaged.
        """
        path = folder / MANIFEST
        if not path.is_file():
            raise refusal(folder, f"is no result of edl6dof: it has no {MANIFEST}")
        found = read_sealed(path, _Content)
        return cls(folder, found.kind, found.files)

    def read(self, name: str) -> bytes:
        """Content of a file of the folder, as it was written.

        Raises:
            ConfigError: the file is missing, cannot be read, or has changed since.
        """
        path = self.folder / name
        if name not in self.files:
            raise refusal(path, f"no such file, says {MANIFEST}")
        content = read_file(path)
        if sha256(content) != self.files[name]:
            raise refusal(
                path,
                (
                    f"has changed since it was written (its SHA-256 is not the one in {MANIFEST}); it is not "
                    "used"
                ),
            )
        return content

    def stranger(self) -> str | None:
        """A file in the folder that this program did not write, or that has changed since; ``None`` where
        there is none.
        """
        for name in sorted(_names(self.folder)):
            path, later = self.folder / name, self.kind == "flight" and _is_later(name)
            if path.is_symlink() or not (later or name in (MANIFEST, *self.files)):
                return f"{name}, which edl6dof did not write"
            if name in self.files and hash_of(path) != self.files[name]:
                return f"{name}, which has changed since edl6dof wrote it"
        return None


def listed(folder: Path) -> str:
    """Names of the files in a folder as they are told to the user, who has no use for those about files."""
    return ", ".join(sorted(path.name for path in folder.iterdir() if path.name not in (MANIFEST, MADE)))


def _is_later(name: str) -> bool:
    return any(name.count("/") == pattern.count("/") and fnmatchcase(name, pattern) for pattern in _LATER)


def _names(folder: Path) -> Iterator[str]:
    """Files below a folder, and folders in it that are empty or links, relative to it."""
    for path in folder.rglob("*"):
        if path.is_symlink() or not path.is_dir() or not any(path.iterdir()):
            yield path.relative_to(folder).as_posix()


def read_file(path: Path) -> bytes:
    """Read all bytes of a file.

    Raises:
        ConfigError: it is missing, no regular file, or cannot be read.
    """
    with _opened(path) as file:
        return file.read()


@contextmanager
def _opened(path: Path) -> Iterator[BufferedReader]:
    """A file to be read.

    Raises:
        ConfigError: it cannot be.
    """
    if not path.is_file():
        raise refusal(path, "no such file" if not path.exists() else "is not a regular file")
    try:
        with path.open("rb") as file:
            yield file
    except OSError as error:
        raise refusal(path, f"cannot be read: {error.strerror or error}") from None


def sha256(content: bytes | memoryview) -> str:
    """Return the SHA-256 of some bytes as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def hash_of(path: Path) -> str:
    """SHA-256 of a file, hexadecimal; a part of it at a time is held.

    Raises:
        ConfigError: it cannot be read.
    """
    with _opened(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
