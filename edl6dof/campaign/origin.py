"""Which program made a row: the hash of its sources."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import edl6dof
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
