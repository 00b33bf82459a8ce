"""Declared ranges of the numbers of a record, and the walk over all its numbers.

Compiled code trusts a record: an index out of range would reach beyond its array.  Therefore every whole
number of a record that a file can bring back declares its range as metadata of its dtype, and so does a float
that need not be finite.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import prod
from typing import Any, NamedTuple

import numpy as np


def whole(low: int, high: int, of: str = "", kind: str = "i8") -> np.dtype:
    """Type of a whole number from ``low`` to ``high``, of eight bytes unless ``kind`` is given.

    ``of`` names the things that the number is an index of; a flight may have fewer than ``high`` allows.
    """
    return np.dtype(kind, metadata={"low": low, "high": high, "of": of})


def record(*fields: tuple[Any, ...]) -> np.dtype:
    """Layout of a record with these fields, each aligned as compiled code reads it.

    Args:
        fields: name, type and, for an array, shape of each.
    """
    return np.dtype(list(fields), align=True)


#: Types of a flag, of a count that may grow all through a flight, and of an event's time, NaN until then.
FLAG, COUNT, TIME_IF_EVER = whole(0, 1), whole(0, 2**31), np.dtype("f8", metadata={"if_ever": True})


class Numbers(NamedTuple):
    """One field of plain numbers of a record: dotted path, values, and declared ranges."""

    path: str
    values: np.ndarray
    declared: Mapping[str, Any]

    @property
    def is_whole(self) -> bool:
        """True for whole numbers."""
        return self.values.dtype.kind in "iu"

    def place(self, wrong: np.ndarray) -> str:
        """Path of the first ``wrong`` value (a mask), with its index in an array: ``debris.r_I[1, 2]``."""
        index = np.argwhere(wrong)[0].tolist()
        return f"{self.path}{index}" if index else self.path


def numbers(record: np.ndarray, path: str = "") -> Iterator[Numbers]:
    """Fields of plain numbers of a record (a structured array of length one), as views, in their order."""
    if record.dtype.names is None:
        yield Numbers(path, record[0, ...], dict(record.dtype.metadata or {}))
        return
    for name in record.dtype.names:
        yield from numbers(record[name], f"{path}.{name}" if path else name)


def offset(layout: np.dtype, field: str) -> int:
    """Bytes from the start of a record to one of its fields.

    Raises:
        KeyError: it has no field of this name.
    """
    if layout.fields is None:
        raise KeyError(field)
    return int(layout.fields[field][1])


def finite_words(layout: np.dtype, start: int = 0) -> list[tuple[int, int]]:
    """First word and end of each run of eight-byte words of a record that hold floats which should be finite.

    Args:
        layout: of the record, every float of eight bytes in a word of its own; shorter ones are left out.
        start: bytes before the record.
    """
    runs: list[tuple[int, int]] = []
    for first, end in _doubles(layout, start):
        before = runs.pop()[0] if runs and runs[-1][1] == first else first
        runs.append((before, end))
    return runs


def _doubles(layout: np.dtype, start: int) -> Iterator[tuple[int, int]]:
    """First word and end of each field of a record that holds floats which should be finite."""
    one, count = layout.base, prod(layout.shape)
    if one.names is not None:
        for k in range(count):
            for name in one.names:
                yield from _doubles(one[name], start + k * one.itemsize + offset(one, name))
    elif one == np.float64 and "if_ever" not in (one.metadata or {}):
        yield start // 8, start // 8 + count


def first_not_finite(record: np.ndarray) -> str | None:
    """Path of the first float of a record (length one) that is not finite and should be, or ``None``."""
    for field in numbers(record):
        if field.is_whole or "if_ever" in field.declared:
            continue
        if np.any(wrong := ~np.isfinite(field.values)):
            return field.place(wrong)
    return None


def require_finite(table: np.ndarray) -> None:
    """Raise ValueError for a table (a structured array of length one) with a float that is not finite."""
    if first_not_finite(table) is not None:
        raise ValueError("holds a number that is not finite, or one for which no table can be built")


def out_of_range(record: np.ndarray, sizes: Mapping[str, int]) -> Iterator[tuple[str, str]]:
    """Yield path and message of each whole number of a record (length one) outside its declared range.

    ``sizes``: number of the things of which some are indices, as far as it is known.  A number without a
    declaration, as in the memory of a plugin, may have any value.
    """
    for field in numbers(record):
        if not field.is_whole or "low" not in field.declared:
            continue
        low, high, of = (field.declared[key] for key in ("low", "high", "of"))
        if of in sizes:
            high = max(min(high, sizes[of] - 1), 0)
        if np.any(wrong := (field.values < low) | (field.values > high)):
            yield field.place(wrong), f"must be {low} .. {high} (got {field.values[wrong][0]})"
