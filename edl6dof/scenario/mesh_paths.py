"""Files of meshes that a vehicle names: relative to the file that names them, and whole from then on, so that
a run folder finds them again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from edl6dof.config.document.source import Document

#: Where a scenario names them, and the file of a body of any shape.
MESHES = ("vehicle", "appearance", "meshes")
BODY = ("vehicle", "aero", "body")


def with_whole_paths(document: Document) -> Document:
    """The document, the files of its vehicle's meshes and of its body with their whole paths; what is of
    another form is left for the validation to refuse.
    """
    found = _at(document, MESHES)
    for k, mesh in enumerate(found if isinstance(found, list) else ()):
        _make_whole(document, (*MESHES, k), mesh)
    _make_whole(document, BODY, _at(document, BODY))
    return document


def _at(document: Document, keys: tuple[str, ...]) -> Any:
    found: Any = document.data
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def _make_whole(document: Document, keys: tuple[str | int, ...], named: Any) -> None:
    """Make whole the path of the ``file`` of ``named``, which stands at ``keys``."""
    if isinstance(named, dict) and isinstance(name := named.get("file"), str) and name:
        named_in = Path(document.mark((*keys, "file")).file)
        folder = named_in.parent if named_in.is_file() else Path.cwd()
        named["file"] = str((folder / name).resolve())
