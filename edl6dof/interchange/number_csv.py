"""Tables of numbers in csv: a heading above rows of numbers; lines that begin with # are remarks."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from math import inf, isfinite, nan
from typing import NamedTuple

import numpy as np

from edl6dof.config.errors import Problem

#: Largest number of mistakes that the text of the error has; its ``problems`` have all.
_NAMED = 5
#: From the headings of a file to the name of each column, empty for one that is not read, and what is wrong.
Naming = Callable[[Sequence[str]], tuple[Sequence[str], Sequence[str]]]


class NumberTable(NamedTuple):
    """A csv of numbers.

    Attributes:
        remarks: text of the remarks, without their #.
        lines: line of each row in the file, shape (rows,).
        columns: numbers of each column that is read, by its name, each shape (rows,).
    """

    remarks: tuple[str, ...]
    lines: np.ndarray
    columns: dict[str, np.ndarray]


class BadTable(ValueError):
    """A csv that cannot be used; ``problems`` has every mistake."""

    def __init__(self, problems: Sequence[Problem]):
        more = f"; and {len(problems) - _NAMED} more" if len(problems) > _NAMED else ""
        super().__init__("; ".join(map(str, problems[:_NAMED])) + more)
        self.problems = tuple(problems)


def read_number_csv(file: str, content: bytes, naming: Naming, rising: str = "") -> NumberTable:
    """Read a csv of numbers.

    Args:
        file: its name in messages.
        content: of the file.
        naming: names the columns.
        rising: name of the column whose numbers must rise, if any.

    Raises:
        BadTable: every wrong heading, row and cell with line and column.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadTable([Problem(file, 0, 0, "", "is not a text file")]) from None
    numbered = [(line, raw) for line, raw in enumerate(text.splitlines(), 1) if raw.strip()]
    remarks = [raw.strip("# \t") for _, raw in numbered if raw.lstrip().startswith("#")]
    rows = [(line, raw, _cells(raw)) for line, raw in numbered if not raw.lstrip().startswith("#")]
    if not rows:
        raise BadTable([Problem(file, 0, 0, "", "is empty")])
    (place, _, heading), *rows = rows
    if all(isfinite(_number(word)) for word in heading):
        lacking = ("needs a heading above its rows", *naming([])[1])
        raise BadTable([Problem(file, place, 1, "", words) for words in lacking])
    names, wrong = naming(heading)
    problems = [Problem(file, place, 1, "", words) for words in wrong]
    if not rows:
        problems.append(Problem(file, place, 1, "", "has a heading and no row"))
    last = -inf
    for line, raw, cells in rows:
        if len(cells) != len(heading):
            words = f"has {len(cells)} entries, its heading {len(heading)}"
            problems.append(Problem(file, line, 1, "", words))
            continue
        for k, (name, cell) in enumerate(zip(names, cells, strict=True)):
            number, words = _number(cell), ""
            if name and not isfinite(number):
                words = f"must be a finite number (got {cell[:30]!r})"
            elif name and name == rising:
                words = "" if number > last else f"must rise (got {cell[:30]} after {last:g})"
                last = number
            if words:
                column = len(",".join(raw.split(",")[:k])) + (2 if k else 1)
                problems.append(Problem(file, line, column, name, words))
    if problems:
        raise BadTable(problems)
    columns = {
        name: np.array([_number(cells[k]) for _, _, cells in rows]) for k, name in enumerate(names) if name
    }
    return NumberTable(tuple(remarks), np.array([line for line, _, _ in rows]), columns)


def _cells(raw: str) -> list[str]:
    return [word.strip() for word in next(csv.reader([raw]))]


def _number(cell: str) -> float:
    """Number in a cell; NaN if there is none."""
    try:
        return float(cell)
    except ValueError:
        return nan
