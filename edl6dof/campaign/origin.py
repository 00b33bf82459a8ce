"""Which program made a row: the hash of its sources."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import edl6dof
from edl6dof.config.plugin_scan import VARIABLE
from edl6dof.jit import outside_sources


@cache
def source_hash() -> str:
    """Hash of every source file of the package and of the plugins: the same sources and the same plan give the same table."""
    digest = hashlib.sha256()
    folder = Path(edl6dof.__file__).parent
    for file in sorted(folder.rglob("*.py")):
        digest.update(file.relative_to(folder).as_posix().encode() + b"\0" + file.read_bytes())
    for name in sorted(outside_sources):
        digest.update(Path(name).read_bytes())
    return digest.hexdigest()


def plugin_hashes() -> dict[str, str]:
    """Hash of each plugin of this process by its path."""
    return {name: _hash(name) for name in outside_sources}


def plugin_complaint(recorded: Mapping[str, str]) -> str:
    """What keeps the plugins of :func:`plugin_hashes` from flying again in this process; empty when nothing does."""
    for name, digest in recorded.items():
        if not Path(name).is_file():
            return f"with the plugin {name}, which is gone"
        if _hash(name) != digest:
            return f"with the plugin {name}, which has changed since"
        if name not in outside_sources:
            return f"with the plugin {name}, which this process has not loaded: set {VARIABLE} to it"
    more = [name for name in outside_sources if name not in recorded]
    return f"without the plugin {more[0]}" if more else ""


def _hash(name: str) -> str:
    return hashlib.sha256(Path(name).read_bytes()).hexdigest()
