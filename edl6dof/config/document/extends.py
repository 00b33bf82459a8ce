"""A file that changes some values of a scenario and leaves the others: ``extends: tianwen1``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from edl6dof.config.document.yamltree import Path, dotted

if TYPE_CHECKING:
    from edl6dof.config.document.source import Document

EXTENDS = "extends"


def lay_over(base: Document, top: Document) -> None:
    """Put everything that ``top`` says into ``base``: mappings are merged, lists and single values replaced.

    A mapping over a list of named items changes the items that it names:
    ``parachutes: {main: {drag_coefficient: 0.7}}``.
    """
    _merge(base, top, (), ())
    base.marks[()] = top.mark(())
    base.files = (*top.files, *base.files)


def _merge(base: Document, top: Document, path: Path, above_path: Path) -> None:
    """Merge what ``top`` has at ``above_path`` into what ``base`` has at ``path``."""
    below, above = _value_at(base.data, path), _value_at(top.data, above_path)
    for key, value in above.items():
        place, source = (*path, _place(below, key)), (*above_path, key)
        if isinstance(value, dict) and _takes(_inside(below, place[-1]), value):
            _merge(base, top, place, source)
        else:
            base.forget(place)
            below[place[-1]] = value
            _copy_claims(base, top, place, source)


def _takes(below: Any, above: dict[str, Any]) -> bool:
    """Whether a mapping changes what stands below: another mapping, or a list that has items of its keys'
    names.
    """
    return (
        isinstance(below, dict)
        or isinstance(below, list)
        and bool(above)
        and above.keys() <= _named(below).keys()
    )


def _named(items: list[Any]) -> dict[Any, int]:
    """Index of each item of a list by its name."""
    return {item["name"]: k for k, item in enumerate(items) if isinstance(item, dict) and "name" in item}


def _place(below: Any, key: Any) -> Any:
    """Key or index at which ``below`` has what is called ``key``."""
    return _named(below)[key] if isinstance(below, list) else key


def _inside(below: Any, place: Any) -> Any:
    return below[place] if isinstance(below, list) else below.get(place)


def _copy_claims(base: Document, top: Document, path: Path, above_path: Path) -> None:
    """Places and provenance of a value that was taken over."""
    depth = len(above_path)
    base.marks.update(
        {(*path, *known[depth:]): mark for known, mark in top.marks.items() if known[:depth] == above_path}
    )
    inside = dotted(above_path) + "."
    for mine, theirs in ((base.status, top.status), (base.sources, top.sources)):
        mine.update(
            {
                f"{dotted(path)}.{known[len(inside) :]}".rstrip("."): claim
                for known, claim in theirs.items()
                if f"{known}.".startswith(inside)
            }
        )


def _value_at(data: Any, path: Path) -> Any:
    for key in path:
        data = data[key]
    return data
