"""A file that changes some values of a scenario and leaves the others: ``extends: tianwen1``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from edl6dof.config.document.yamltree import Path, dotted

if TYPE_CHECKING:
    from edl6dof.config.document.source import Document

EXTENDS = "extends"


def lay_over(base: Document, top: Document) -> None:
    """Put everything that ``top`` says into ``base``: mappings are merged, lists and single values
    replaced.
    """
    _merge(base, top, ())
    base.marks[()] = top.mark(())
    base.files = (*top.files, *base.files)


def _merge(base: Document, top: Document, path: Path) -> None:
    below, above = _value_at(base.data, path), _value_at(top.data, path)
    for key, value in above.items():
        here = (*path, key)
        if isinstance(value, dict) and isinstance(below.get(key), dict):
            _merge(base, top, here)
        else:
            base.forget(here)
            below[key] = value
            _copy_claims(base, top, here)


def _copy_claims(base: Document, top: Document, path: Path) -> None:
    """Places and provenance of a value that was taken over."""
    base.marks.update({known: mark for known, mark in top.marks.items() if known[: len(path)] == path})
    inside = dotted(path) + "."
    for mine, theirs in ((base.status, top.status), (base.sources, top.sources)):
        mine.update({known: claim for known, claim in theirs.items() if f"{known}.".startswith(inside)})


def _value_at(data: Any, path: Path) -> Any:
    for key in path:
        data = data[key]
    return data
