"""The rows of a brief log that its figures are formed from: with these alone they are the same to the last
bit, in a hundredth of the memory.

They are the first rows and the last, those beside each event, those beside a change of phase or of the sign
of the commanded bank angle, the row of every extreme, and the last of the trim phase.  Rows may be dropped
again and again while a flight goes on: to which parts of it a row belongs is known when it is logged.

Figures of hazard detection need every row between ignition and touchdown (:mod:`edl6dof.metrics.drift`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import inf, isnan, nan

import numpy as np

from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.interface.roles import LIFT, TRIM, span
from edl6dof.jit import kernel
from edl6dof.metrics.evaluation import LIMIT_CYCLE_S, TRIM_ERRORS
from edl6dof.metrics.extremes import CALM, EXTREMES, SWINGS, Extreme, Part
from edl6dof.records import FLAG, offset, whole
from edl6dof.spatial.elementary import tan
from edl6dof.telemetry.channels import BRIEF
from edl6dof.telemetry.columns import words_of

#: Kinds of extremes, by number.
KINDS = ("largest", "longest", "nearest", "swing")
_LARGEST, _LONGEST, _NEAREST = range(3)
#: Extremes that are kept track of, and columns of one.
MAX_EXTREMES, MAX_COLUMNS = 40, 6
#: What a part of a flight may begin or end with beside an event by its number.
NOTHING, TOUCHDOWN = -1, -2

EXTREME = np.dtype(
    [
        ("kind", whole(0, len(KINDS) - 1)),
        ("columns", "i8", (MAX_COLUMNS,)),  # eight-byte words from the start of a row
        ("n_columns", "i8"),
        ("first", "f8"),  # phase, and the one after the last
        ("end", "f8"),
        ("since", "i8"),
        ("after", "f8"),  # s
        ("later", FLAG),  # whether a row that long after it does not count yet
        ("until", "i8"),
    ],
    align=True,
)

#: What the figures of a scenario need.
TELLING = np.dtype(
    [
        ("extremes", EXTREME, (MAX_EXTREMES,)),
        ("n_extremes", "i8"),
        ("n_events", whole(0, MAX_EVENTS)),
        ("banking", "f8", (2,)),  # first phase of lift control, and the one after the last
        ("late", EXTREME),  # of the end of the trim phase
    ],
    align=True,
)

_WIDTH = BRIEF.itemsize // 8
_PHASE, _BANK = words_of(BRIEF, ("guide.phase", "guide.bank_deg"))[0].tolist()
_T = offset(BRIEF, "t") // 8
_LATE = Extreme("largest", TRIM_ERRORS, Part(TRIM))
#: Rows kept before an event and from it on: what is read at the row before it is read on the straight line
#: from the one before that.
_BEFORE, _FROM = 2, 2


@lru_cache(maxsize=16)
def telling(kinds: tuple[str, ...], roles: tuple[str, ...]) -> np.ndarray | None:
    """What the figures of a mission need, ``TELLING`` of shape (1,), to which nobody writes; ``None`` where
    that is too much to keep track of.

    Args:
        kinds: milestone of each event (:func:`edl6dof.telemetry.timeline.milestone`).
        roles: role of each phase.
    """
    found = list(_extremes(kinds))
    if len(found) > MAX_EXTREMES:
        return None
    needs = np.zeros(1, TELLING)
    needs["n_extremes"], needs["n_events"] = len(found), len(kinds)
    for record, one in zip(needs["extremes"][0], found, strict=False):
        _fill(record, roles, *one)
    _fill(needs["late"][0], roles, _LATE, NOTHING, NOTHING)
    needs["banking"] = span(roles, LIFT)
    return needs


def _fill(record: np.void, roles: Sequence[str], one: Extreme, since: int, until: int) -> None:
    columns, part = words_of(BRIEF, one.columns)[0], one.part
    record["kind"], record["n_columns"] = KINDS.index(one.kind), len(columns)
    record["columns"][: len(columns)] = columns
    record["first"], record["end"] = span(roles, part.role) if part.role else (-inf, inf)
    record["since"], record["until"] = since, until
    record["after"], record["later"] = part.after_s, part.later


def _extremes(kinds: Sequence[str]) -> Iterator[tuple[Extreme, int, int]]:
    """Extremes, with the numbers of the events that their parts begin and end with: one for each event that
    may turn out to be the first of its kind.
    """
    swings = (Extreme("swing", columns, part) for part in CALM for columns in SWINGS)
    for one in (*EXTREMES.values(), *swings):
        for since in _numbers(one.part.since, kinds):
            for until in _numbers(one.part.until, kinds) or [NOTHING]:
                yield one, since, until


def _numbers(kind: str, kinds: Sequence[str]) -> list[int]:
    if kind in ("", "touchdown"):
        return [TOUCHDOWN if kind else NOTHING]
    return [number for number, other in enumerate(kinds) if other == kind]


@kernel
def keep_telling(needs, plant, log, count, keep):
    """Drop the rows that no figure needs from the first ``count`` of a log; returns how many are left.

    ``needs``: ``TELLING``; ``plant``: the vehicle at the last of the rows or later; ``log``: ``BRIEF`` rows,
    changed in place; ``keep``: a flag for each row, for scratch.
    """
    rows = log.view(np.float64)
    for i in range(count):
        keep[i] = 1 if i < _FROM or i >= count - _BEFORE - 1 else 0
    for number in range(needs.n_events):
        _keep_beside(rows, count, plant.done[number], keep)
    _keep_beside(rows, count, plant.touchdown_time, keep)
    _keep_changes(needs, rows, count, keep)
    _keep_late(needs.late, rows, count, keep)
    for number in range(needs.n_extremes):
        _keep_extreme(needs.extremes[number], plant, rows, count, keep)
    left = 0
    for i in range(count):
        if keep[i] != 0:
            if left != i:
                for k in range(_WIDTH):
                    rows[left * _WIDTH + k] = rows[i * _WIDTH + k]
            left += 1
    return left


@kernel
def _keep_beside(rows, count, t, keep):
    """Keep the rows beside a time (s), if it is one and has been reached."""
    if isnan(t) or count == 0 or t > rows[(count - 1) * _WIDTH + _T]:
        return
    low, high = 0, count - 1  # the first row that is not before it
    while low < high:
        middle = (low + high) // 2
        if rows[middle * _WIDTH + _T] < t:
            low = middle + 1
        else:
            high = middle
    for i in range(max(low - _BEFORE, 0), min(low + _FROM, count)):
        keep[i] = 1


@kernel
def _keep_changes(needs, rows, count, keep):
    """Keep both rows of each change of phase and, in lift control, of the sign of the bank angle."""
    for i in range(1, count):
        before, now = (i - 1) * _WIDTH, i * _WIDTH
        phase = rows[now + _PHASE]
        turned = _sign(rows[now + _BANK]) != _sign(rows[before + _BANK])
        if phase != rows[before + _PHASE] or (turned and needs.banking[0] <= phase < needs.banking[1]):
            keep[i - 1] = keep[i] = 1


@kernel
def _sign(value):
    return 1 if value > 0.0 else (-1 if value < 0.0 else 0)


@kernel
def _keep_late(one, rows, count, keep):
    """Keep the last rows of the trim phase: all while it lasts, and afterwards that of the largest error."""
    last = count - 1
    while last >= 0 and rows[last * _WIDTH + _PHASE] >= one.end:
        last -= 1
    if last < 0 or rows[last * _WIDTH + _PHASE] < one.first:
        return
    best, most, since = -1, nan, rows[last * _WIDTH + _T] - LIMIT_CYCLE_S
    for i in range(last, -1, -1):
        row = i * _WIDTH
        if rows[row + _PHASE] < one.first or rows[row + _T] <= since:
            break
        if last == count - 1:
            keep[i] = 1
        value = _value(one, rows, row)
        if best < 0 or _larger(value, most):
            best, most = i, value
    keep[best] = 1


@kernel
def _larger(value, most):
    """Whether a number is larger than another; what is none is larger than any."""
    return value > most or (isnan(value) and not isnan(most))


@kernel
def _keep_extreme(one, plant, rows, count, keep):
    """Keep the row of an extreme, among those of its part."""
    start, end = -inf, inf
    if one.since >= 0:
        start = plant.done[one.since] + one.after
    if one.until >= 0:
        end = plant.done[one.until]
    elif one.until == TOUCHDOWN:
        end = plant.touchdown_time
    if isnan(start):
        return
    best, most = -1, nan
    for i in range(count):
        row = i * _WIDTH
        t, phase = rows[row + _T], rows[row + _PHASE]
        if phase < one.first or phase >= one.end or t < start or t >= end:
            continue
        if one.later != 0 and t == start:
            continue
        value = _value(one, rows, row)
        if best < 0 or _larger(value, most):
            best, most = i, value
    if best >= 0:
        keep[best] = 1


@kernel
def _value(one, rows, row):
    """What is largest in the row of an extreme."""
    first = rows[row + one.columns[0]]
    if one.kind == _LARGEST:
        most = abs(first)
        for k in range(1, one.n_columns):
            value = abs(rows[row + one.columns[k]])
            most = value if _larger(value, most) else most
        return most
    square = 0.0
    if one.kind == _LONGEST:
        for k in range(one.n_columns):
            value = rows[row + one.columns[k]]
            square += value * value
        return square
    if one.kind == _NEAREST:
        for k in range(3):
            apart = rows[row + one.columns[k]] - rows[row + one.columns[3 + k]]
            square += apart * apart
        return -inf if isnan(square) else -square
    return abs(first - rows[row + one.columns[1]] * tan(rows[row + one.columns[2]]))
