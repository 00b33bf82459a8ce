"""Plugins whose code the user has accepted (``edl6dof trust``): it may run until it changes.

They stand in a text file of the user's own, a line ``SHA-256  path`` for each, which may be edited or deleted
at will.  The hash alone counts: an accepted plugin may move, and another one in its place is not accepted.
Paths are escaped, since one with a line break in it could accept another content.
"""

from __future__ import annotations

from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from platformdirs import user_config_path

from edl6dof.durable import write_atomic


def accepted_file() -> Path:
    """Where the accepted plugins are listed."""
    return user_config_path("edl6dof") / "accepted-plugins.txt"


def is_accepted(content: bytes) -> bool:
    """Return whether the user has accepted a plugin with this content."""
    return sha256(content).hexdigest() in (line.split(" ", 1)[0] for line in _lines())


def accept(path: Path, content: bytes) -> None:
    """Remember that the user accepts this content.

    Raises:
        OSError: the list cannot be written.
    """
    place = str(path.resolve()).encode("unicode_escape").decode()
    lines = {*_lines(), f"{sha256(content).hexdigest()}  {place}"}
    accepted_file().parent.mkdir(parents=True, exist_ok=True)
    write_atomic(accepted_file(), "".join(f"{line}\n" for line in sorted(lines)).encode())


def _lines() -> list[str]:
    with suppress(OSError, UnicodeDecodeError):
        return accepted_file().read_text(encoding="utf-8").splitlines()
    return []
