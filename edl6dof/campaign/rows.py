"""One row of the results table for each case, and rows as an Arrow table."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import pyarrow as pa

from edl6dof.campaign.design.case import Case
from edl6dof.sim.flight import Flight

#: What a caller adds to a row from its flight, which must not be kept: the next case reuses its telemetry.
Collect = Callable[[Flight], Mapping[str, Any]]

Row = dict[str, Any]

#: Where the numbers of a message begin; a cause has none, so that cases with one cause count together.
_NUMBERS = re.compile(r"[\[(]|\b\d")


def flown_row(case: Case, changes: Mapping[str, Any], flight: Flight, collect: Collect | None) -> Row:
    """Row of a case that has flown: what was changed, how it ended, every figure of the flight, what the
    caller adds.
    """
    row: Row = {"case": case.index, **case.label, **{path: _plain(value) for path, value in changes.items()}}
    row.update(success=flight.success, cause=flight.cause, outcome=flight.outcome, end_s=flight.time_s)
    for more in (flight.metrics, collect(flight) if collect is not None else {}):
        if twice := row.keys() & more.keys():
            raise ValueError(f"column given twice: {', '.join(sorted(twice))}")
        row.update(more)
    return row


def _plain(value: Any) -> Any:
    """Numbers, texts and lists of numbers as they are; whole sections and lists of models, such as those of
    faults, as JSON text.

    Models leave out what they have at the default.
    """
    if type(value) is float:
        return value
    items = value if isinstance(value, list | tuple) and value else [value]
    if isinstance(value, str) or all(isinstance(item, int | float | None) for item in items):
        return value
    return json.dumps(value, default=lambda model: model.model_dump(mode="json", exclude_defaults=True))


def failed_row(case: Case, reason: str) -> Row:
    """Row of a case that could not fly."""
    changes = {f"truth.{path}": _plain(value) for path, value in case.truth.items()}
    changes |= {f"belief.{path}": _plain(value) for path, value in case.belief.items()}
    if case.profile is not None:
        changes["profile"] = case.profile
    words = f"could not fly: {reason.replace('Value error, ', '')}"
    cause = _NUMBERS.split(words)[0].rstrip(" :(")
    return {
        "case": case.index,
        **case.label,
        **changes,
        "success": False,
        "cause": cause,
        "outcome": words,
        "end_s": 0.0,
    }


def table_of(rows: Iterable[Row]) -> pa.Table:
    """Rows as a table; columns in the order in which rows bring them, null where a row has none."""
    rows = list(rows)
    names = list(dict.fromkeys(name for row in rows for name in row))
    return pa.table({name: _column([row.get(name) for row in rows]) for name in names})


def _column(values: list[Any]) -> pa.Array:
    """Whole and broken numbers in one column become floats; numbers beside text or lists become text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds == {int, float}:
        values = [None if value is None else float(value) for value in values]
    elif len(kinds) > 1:
        values = [None if value is None else str(value) for value in values]
    return pa.array(values)
