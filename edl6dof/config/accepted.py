"""Plugins that the user has accepted before: their code may run without being asked for again, as long as it
does not change.

They stand in a text file of the user's own, a line ``SHA-256  path`` for each, which may be edited or deleted
at will.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from platformdirs import user_config_path

from edl6dof.durable import write_atomic


def accepted_file() -> Path:
    """Where the accepted plugins are listed."""
    return user_config_path("edl6dof") / "accepted-plugins.txt"


def is_accepted(plugin: Path) -> bool:
    """Whether the user has accepted this file with its present content."""
    return _line(plugin) in _lines()


def accept(plugins: Iterable[Path]) -> None:
    """Remember plugins with their present content; where nothing can be written, they are asked for again the
    next time.
    """
    before = _lines()
    after = before | {_line(plugin) for plugin in plugins if plugin.is_file()}
    if after == before:
        return
    with suppress(OSError):
        accepted_file().parent.mkdir(parents=True, exist_ok=True)
        write_atomic(accepted_file(), "".join(f"{line}\n" for line in sorted(after)).encode())


def _lines() -> set[str]:
    try:
        return set(accepted_file().read_text(encoding="utf-8").splitlines())
    except (OSError, UnicodeDecodeError):
        return set()


def _line(plugin: Path) -> str:
    try:
        return f"{hashlib.sha256(plugin.read_bytes()).hexdigest()}  {plugin.resolve()}"
    except OSError:
        return ""  # no line of the file is empty, so what cannot be read is never accepted
