"""A validated model as YAML text with every default, which flies again bit for bit; and plain values as the
JSON text of result files and ``--json``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from edl6dof.config.base import STATUS_MARKS, extra_of
from edl6dof.config.document.yamltree import write_flow, write_scalar


def json_text(value: Any) -> str:
    """Indented JSON, with null for a number that is not finite."""
    return json.dumps(_finite(value), indent=1, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


WIDTH = 110

_LETTERS: dict[str, str] = {status: letter for letter, status in STATUS_MARKS.items()}


def dump_resolved(
    instance: BaseModel | dict[str, Any],
    header_lines: Sequence[str] = (),
    status: Mapping[str, str] | None = None,
    sources: Mapping[str, str] | None = None,
) -> str:
    """YAML text of a model, in declaration order, that reads back as an equal model.

    Args:
        instance: validated model, or plain values by name.
        header_lines: comment lines at the top (package version, source hash, ...).
        status: dotted path to status name, as :class:`~edl6dof.config.document.source.Document` collects it
            from the file's marks.
        sources: dotted path to the text behind the mark.

    A value without a mark of its own has the mark of its declaration only if it is the declared default, for
    which alone the claim holds.
    """
    header = [f"# {line}".rstrip() for text in header_lines for line in (text.splitlines() or [""])]
    body = list(_Writer(status or {}, sources or {}).mapping(instance, "", 0))
    return "\n".join([*header, *body]) + "\n"


class _Writer:
    def __init__(self, status: Mapping[str, str], sources: Mapping[str, str]):
        self.status = status
        self.sources = sources

    def mapping(self, value: BaseModel | dict[str, Any], prefix: str, indent: int) -> Iterator[str]:
        """Lines of ``key: value`` pairs."""
        pad = " " * indent
        if not _has_entries(value):
            yield pad + "{}"
        for name, item, info in _pairs(value):
            path, start = f"{prefix}{name}", f"{pad}{write_scalar(name)}:"
            yield from self._entry(start, item, path, indent, self._mark(path, item, info))

    def _entry(self, start: str, value: Any, path: str, indent: int, mark: str) -> Iterator[str]:
        """Lines of one value after ``start``, which is ``key:`` or ``-``."""
        if _has_entries(value):
            yield start
            yield from self.mapping(value, path + ".", indent + 2)
        elif isinstance(value, list | tuple) and any(_has_entries(item) for item in value):
            yield start
            yield from self._mappings(value, path, indent + 2)
        else:
            yield from self._plain(start, to_jsonable_python(value), path, indent, mark)

    def _mappings(self, items: Sequence[Any], path: str, indent: int) -> Iterator[str]:
        for index, item in enumerate(items):
            if not _has_entries(item):
                yield f"{' ' * indent}- {write_flow(to_jsonable_python(item))}"
                continue
            lines = list(self.mapping(item, f"{path}.{index}.", indent + 2))
            yield f"{' ' * indent}- {lines[0].lstrip(' ')}"
            yield from lines[1:]

    def _plain(self, start: str, value: Any, path: str, indent: int, mark: str) -> Iterator[str]:
        """A scalar or a list of numbers: on one line, as a table of rows, or as a list wrapped over lines."""
        text = f"{start} {write_flow(value)}"
        if len(text) <= WIDTH or not isinstance(value, list):
            yield text + mark
        elif any(isinstance(item, list) for item in value):
            yield start + mark
            for index, item in enumerate(value):
                own = self._mark(f"{path}.{index}", item, None)
                yield from self._plain(f"{' ' * (indent + 2)}-", item, f"{path}.{index}", indent + 2, own)
        else:
            line, pad = f"{start} [", " " * (indent + 2)
            for position, item in enumerate(value):
                word = write_scalar(item) + ("]" if position == len(value) - 1 else ",")
                if len(line) + len(word) >= WIDTH:
                    yield line.rstrip(" ")
                    line = pad
                line += word + " "
            yield line.rstrip(" ") + mark

    def _mark(self, path: str, value: Any, info: FieldInfo | None) -> str:
        if path in self.status:
            status, source = self.status[path], self.sources.get(path, "")
        else:
            status, source = declared(value, info)
        letter = _LETTERS.get(status)
        return f"  # [{letter}] {source}".rstrip() if letter else ""


def _pairs(value: BaseModel | dict[str, Any]) -> list[tuple[str, Any, FieldInfo | None]]:
    if isinstance(value, BaseModel):
        return [(name, getattr(value, name), info) for name, info in type(value).model_fields.items()]
    return [(str(name), item, None) for name, item in value.items()]


def _has_entries(value: Any) -> bool:
    return isinstance(value, BaseModel | dict) and bool(_pairs(value))


def declared(value: Any, info: FieldInfo | None) -> tuple[str, str]:
    """Status and source of the declaration, if a value is the declared default or the printed number."""
    if info is None or not (extra := extra_of(info)):
        return "", ""
    source = str(extra.get("source", ""))
    if "printed" in extra and value == extra["printed"]:
        return "published", source
    if value != info.get_default(call_default_factory=True):
        return "", ""
    return str(extra.get("status", "")), "" if "printed" in extra else source
