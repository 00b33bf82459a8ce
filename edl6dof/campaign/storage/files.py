"""The files of a campaign's folder, read: each is whole and what it claims to be, or a message names it."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from edl6dof.config.errors import ConfigError, Problem
from edl6dof.durable import write_atomic


class StoreError(ConfigError):
    """The folder of a campaign, or a file in it, cannot be used; the text says why and what helps."""


class Sealed(BaseModel):
    """Content of a JSON file that carries its own hash."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Content = TypeVar("Content", bound=Sealed)

#: Key under which a sealed file holds the hash of all else in it.
_SEAL = "sha256"


def refused(path: Path, message: str) -> StoreError:
    """The error of a file or folder that cannot be used."""
    return StoreError([Problem(str(path), 0, 0, "", message)])


def sha256(content: bytes | memoryview) -> str:
    """SHA-256 as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def digest(data: Any) -> str:
    """SHA-256 of plain data; the order of keys does not count."""
    return sha256(json.dumps(data, sort_keys=True).encode())


def content(path: Path) -> bytes:
    """All bytes of a file.

    Raises:
        StoreError: it is missing, no file, or cannot be read.
    """
    _require_file(path)
    try:
        return path.read_bytes()
    except OSError as error:
        raise refused(path, f"cannot be read: {error.strerror or error}") from None


def file_sha256(path: Path) -> str:
    """SHA-256 of a file of any size.

    Raises:
        StoreError: it is missing, no file, or cannot be read.
    """
    _require_file(path)
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise refused(path, f"cannot be read: {error.strerror or error}") from None


def _require_file(path: Path) -> None:
    if not path.is_file():
        raise refused(
            path, "is not a file" if path.exists() else "no such file; name the folder of a campaign"
        )


def write_sealed(path: Path, data: Sealed) -> None:
    """Write a JSON file that carries its own hash, durably."""
    plain = data.model_dump(mode="json")
    write_atomic(path, (json.dumps({**plain, _SEAL: digest(plain)}, indent=1) + "\n").encode())


def read_sealed(path: Path, kind: type[Content]) -> Content:
    """Read what :func:`write_sealed` wrote.

    Raises:
        StoreError: it cannot be read, or is not as it was written.
    """
    try:
        plain = json.loads(content(path))
        intact = isinstance(plain, dict) and plain.pop(_SEAL, None) == digest(plain)
    except (ValueError, RecursionError):
        intact = False
    if not intact:
        raise refused(path, "is damaged: it is not as it was written")
    try:
        return kind.model_validate_json(json.dumps(plain))
    except ValidationError:
        raise refused(path, "was written by another version of edl6dof") from None
