"""The manifest of a result folder: the kind of result, and the SHA-256 of every file written with it.

It shows that a folder is a result of this program, which may be replaced, and that no file that is read has
changed since it was written::

    {"written_by": "edl6dof 0.1.0", "kind": "flight", "files": {"summary.json": "5f1c"}, "sha256": "02ab"}

The last key is the hash of the rest, as in the JSON files of a campaign.
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

#: Name of the list of files made from the result later, which can be made again (:mod:`edl6dof.runs.files`).
MADE = "made.json"
#: Kind of result.
Kind = Literal["flight", "study", "validation", "calibration"]

#: Files that commands write later into the folder of a flight.
_LATER = (
    *(MADE, "report.html", "report.pdf", "report/*.png"),
    *("plots/*.html", "plots/*.png", "plots/*.pdf", "plots/*.svg", "compared-with-*.html"),
    *("telemetry.csv", "telemetry.mat", "telemetry.nc", "orbit.oem", "attitude.aem", "nesc.csv"),
)


class Sealed(BaseModel):
    """Content of a JSON file that carries its own hash."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Content = TypeVar("Content", bound=Sealed)
#: Key of the hash of the rest of a sealed file.
_SEAL = "sha256"


def digest(data: Any) -> str:
    """SHA-256 of plain data in any order of keys."""
    return sha256(json.dumps(data, sort_keys=True).encode())


def write_sealed(path: Path, data: Sealed) -> None:
    """Write a JSON file that carries its own hash, durably."""
    plain = data.model_dump(mode="json")
    write_atomic(path, (json.dumps({**plain, _SEAL: digest(plain)}, indent=1) + "\n").encode())


def read_sealed(path: Path, kind: type[Content]) -> Content:
    """Read a file of :func:`write_sealed`.

    Raises:
        ConfigError: the file cannot be read, or has changed since it was written.
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
    """Manifest of a folder: kind of result, and SHA-256 (hexadecimal) of each file by its name."""

    folder: Path
    kind: Kind
    files: dict[str, str]

    @classmethod
    def of(cls, folder: Path) -> Manifest:
        """Read the manifest of a folder.

        Raises:
            ConfigError: the folder has no manifest, or a damaged one.
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
            words = f"has changed since it was written (its SHA-256 is not the one in {MANIFEST})"
            raise refusal(path, f"{words}; it is not used")
        return content

    def stranger(self) -> str | None:
        """A file in the folder that this program did not write, or that has changed since; or ``None``."""
        for name in sorted(_names(self.folder)):
            path, later = self.folder / name, self.kind == "flight" and _is_later(name)
            if path.is_symlink() or not (later or name in (MANIFEST, *self.files)):
                return f"{name}, which edl6dof did not write"
            if name in self.files and hash_of(path) != self.files[name]:
                return f"{name}, which has changed since edl6dof wrote it"
        return None


def listed(folder: Path) -> str:
    """Names of the files in a folder, for messages."""
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
        ConfigError: the file is missing, not regular, or cannot be read.
    """
    with _opened(path) as file:
        return file.read()


@contextmanager
def _opened(path: Path) -> Iterator[BufferedReader]:
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
    """SHA-256 of a file, hexadecimal, read in parts.

    Raises:
        ConfigError: the file cannot be read.
    """
    with _opened(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
