"""The manifest of a result folder: what kind of result it is, and the SHA-256 of every file that was written
with it.

By the manifest a folder is known again as one of this program's, so that nothing else is ever replaced, and a
file that has changed since it was written is noticed before anything is read out of it::

    {"written_by": "edl6dof 0.1.0", "kind": "flight", "files": {"summary.json": "5f1c..."}}
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

from edl6dof import __version__
from edl6dof.config.errors import refusal
from edl6dof.durable import sync, write_atomic

MANIFEST = "manifest.json"

#: What was made from the result later, and may be made again (:mod:`edl6dof.runs.files`).
MADE = "made.json"

#: What commands write later into a folder of each kind; a user's own files never look like these.
LATER = {
    "flight": (
        *(
            MADE,
            "report.html",
            "report.pdf",
            "report/*.png",
            "plots/*.html",
            "plots/*.png",
            "plots/*.pdf",
            "plots/*.svg",
        ),
        *(
            "compared-with-*.html",
            "telemetry.csv",
            "telemetry.mat",
            "telemetry.nc",
            "orbit.oem",
            "attitude.aem",
            "nesc.csv",
        ),
    ),
    "study": (),
    "validation": (),
}


def seal(folder: Path, kind: str) -> None:
    """Write the manifest of a finished folder, and force all of it to the disk."""
    names = sorted(_names(folder))
    for name in names:
        sync(folder / name)
    content = {
        "written_by": f"edl6dof {__version__}",
        "kind": kind,
        "files": {name: hash_of(folder / name) for name in names},
    }
    write_atomic(folder / MANIFEST, (json.dumps(content, indent=1) + "\n").encode())


@dataclass(frozen=True)
class Manifest:
    """What a folder's manifest says.

    Attributes:
        folder: the folder.
        kind: ``flight``, ``study`` or ``validation``.
        files: SHA-256 (hexadecimal) of each file by its name.
    """

    folder: Path
    kind: str
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
        damaged = "is damaged: it is no manifest"
        try:
            content = json.loads(read_file(path))
            kind, files = content["kind"], content["files"]
        except (ValueError, KeyError, TypeError, RecursionError):
            raise refusal(path, damaged) from None
        if (
            kind not in LATER
            or not isinstance(files, dict)
            or not all(isinstance(text, str) for text in files.values())
        ):
            raise refusal(path, damaged)
        return cls(folder, kind, files)

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
            path = self.folder / name
            if path.is_symlink() or not (name in (MANIFEST, *self.files) or _is_later(name, self.kind)):
                return f"{name}, which edl6dof did not write"
            if name in self.files and hash_of(path) != self.files[name]:
                return f"{name}, which has changed since edl6dof wrote it"
        return None


def listed(folder: Path) -> str:
    """Names of the files in a folder as they are told to the user, who has no use for those about files."""
    return ", ".join(sorted(path.name for path in folder.iterdir() if path.name not in (MANIFEST, MADE)))


def _is_later(name: str, kind: str) -> bool:
    return any(
        name.count("/") == pattern.count("/") and fnmatchcase(name, pattern) for pattern in LATER[kind]
    )


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
