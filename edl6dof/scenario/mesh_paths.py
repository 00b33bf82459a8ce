"""Files of meshes that a vehicle names: relative to the file that names them, and whole from then on, so that
a run folder finds them again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from edl6dof.config.document.source import Document

#: Where a scenario names them.
MESHES = ("vehicle", "appearance", "meshes")


def with_whole_paths(document: Document) -> Document:
    """The document, the files of its vehicle's meshes with their whole paths; what is of another form is left
    for the validation to refuse.
    """
    found: Any = document.data
    for key in MESHES:
        found = found.get(key) if isinstance(found, dict) else None
    for k, mesh in enumerate(found if isinstance(found, list) else ()):
        if isinstance(mesh, dict) and isinstance(name := mesh.get("file"), str) and name:
            named_in = Path(document.mark((*MESHES, k, "file")).file)
            folder = named_in.parent if named_in.is_file() else Path.cwd()
            mesh["file"] = str((folder / name).resolve())
    return document
