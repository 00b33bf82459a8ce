"""Fault matrices: requirements, shares and times of each kind of fault, and maps of components by moments."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.design.dispersions import AND
from edl6dof.campaign.executor import Row
from edl6dof.campaign.faults import EFFECTS, can_be_known, fault_figures, is_right
from edl6dof.config.wording import counted
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import Block, Cell, Mood, Table, Text
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace, legend_entry
from edl6dof.report.palette import BLACK, GREEN, ORANGE, PURPLE, SEQUENTIAL, SKY, UNKNOWN

#: What became of a fault, from the best to the worst; a cell of several flights shows the worst of them.
_BECAME = (
    ("never used after it: cannot be known", UNKNOWN),
    ("right name and kind", GREEN),
    ("not named, or not all", SKY),
    ("named with a wrong kind", ORANGE),
    ("a healthy one named", PURPLE),
)
_CANNOT_BE_KNOWN, _RIGHT, _NOT_NAMED, _WRONG_KIND, _SOUND = range(len(_BECAME))
_LOST = "not within limits"
#: Top of the colour scale of times, s; longer times have the colour of the top.  A white cell was not
#: isolated; the scale itself contains no white.
_LONGEST_S = 15.0
_SCALE = SEQUENTIAL[1:]
#: Names along an axis that is too short for all names, most names that fit, and most rows of a table.
_NAMED, _BESIDE, _LINES = 9, 14, 200
_ROW_PX = 15
#: Columns that identify a fault in a list.
_WHERE = ("component", "kind", "size", "moment", "regime")


def headline(results: Results) -> tuple[str, Mood]:
    """Return the numbers of flights within limits and of faults named rightly in words, and their mood."""
    figures = fault_figures(results.table.to_pylist())
    every, met = figures["all"], [one["met"] for one in figures["acceptance"]]
    kept = f"{every['within_limits']:,} of {counted(every['flights'], 'flight')} within limits"
    named = f"{every['kind_right']:,} of {counted(every['can_be_known'], 'fault')} that can be known"
    good = all(met) and (bool(met) or every["within_limits"] == every["flights"])
    return f"{kept}; {named} rightly named", "good" if good else "warn"


def blocks(results: Results) -> Iterator[Block]:
    """Show the tables and maps of a fault matrix."""
    rows = results.table.to_pylist()
    figures = fault_figures(rows)
    if figures["acceptance"]:
        yield _required(figures["acceptance"])
    yield _groups(figures["groups"])
    yield Text(
        "Regime: at the first use, or leak, after the fault; without any, at the fault.  Known: a fault "
        "whose component is used or leaks before touchdown; shares of right isolations are of these.  Kind: "
        "right component and right kind of fault.  Times (s) from the first use to the right isolation."
    )
    if figures["undetected"]:
        yield _undetected(figures["undetected"])
    for kind in dict.fromkeys(row["kind"] for row in rows):
        some = [row for row in rows if row["kind"] == kind]
        yield from _pairs(kind, some) if AND in some[0]["component"] else [_over_time(kind, some)]
    if lost := [row for row in rows if not row["success"]]:
        yield _listed("Not within limits", "outcome", lost)
    if wrong := [row for row in rows if row.get("wrongly_named")]:
        yield _listed("Wrong isolations", "wrongly_named", wrong)
    if missed := [row for row in rows if can_be_known(row) and not row["name_right"]]:
        yield _listed("In use, and not named", "used_s", missed)


def became(row: Row) -> int:
    """Return the outcome of a fault, an index into ``_BECAME``."""
    if row.get("wrongly_named"):
        return _SOUND if row.get("sound_named") else _WRONG_KIND
    if is_right(row):
        return _RIGHT
    return _NOT_NAMED if can_be_known(row) else _CANNOT_BE_KNOWN


def _required(acceptance: Sequence[dict[str, Any]]) -> Table:
    rows = []
    for one in acceptance:
        flown = Cell(f"{one['value']:.2f} {one['unit']}", "good" if one["met"] else "bad")
        rows.append((one["meaning"], flown, one["limit"]))
    return Table(("", "flown>", "required>"), rows, "What is required")


def _groups(groups: Sequence[dict[str, Any]]) -> Table:
    columns = ("fault", "regime", "flights>", "within limits>", "known>", "name>", "kind>", "wrong>",
               "median>", "95 %>", "longest>")  # fmt: skip
    rows = []
    for group in groups:
        known, times = group["can_be_known"], group["from_use_s"] or {}
        flights = str(group["flights"]), _share(group["within_limits"], group["flights"])
        named = (_share(group[part], known) for part in ("name_right", "kind_right"))
        longest = (f"{times[name]:.2f}" if times else "" for name in ("median", "p95", "worst"))
        head, wrong = (group["kind"].replace("_", " "), group["regime"]), str(group["with_wrong_isolations"])
        rows.append((*head, *flights, str(known), *named, wrong, *longest))
    return Table(columns, rows, "Each kind of fault")


def _undetected(swept: Sequence[dict[str, Any]]) -> Table:
    columns = ("fault", "parameter", "flights>", "not named>", "not within limits>", "largest size>",
               "velocity, m/s>", "height, m>", "vertical, deg>")  # fmt: skip
    rows = []
    for one in swept:
        counts = (str(one[name]) for name in ("flights", "undetected", "not_within_limits"))
        values = ("" if one[name] is None else f"{one[name]:.3g}" for name in ("largest", *EFFECTS))
        rows.append((one["kind"].replace("_", " "), one["parameter"], *counts, *values))
    words = "Faults in use that were not named: their largest size, and largest errors at touchdown"
    return Table(columns, rows, words)


def _share(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f} %" if whole else ""


def _over_time(kind: str, rows: Sequence[Row]) -> Figure:
    """A map of components by moments."""
    across = list(dict.fromkeys(row["moment"] for row in rows))
    down = list(dict.fromkeys(row["component"] for row in rows))[::-1]
    places = [(down.index(row["component"]), across.index(row["moment"])) for row in rows]
    return _figure(f"faults_{kind}", kind, rows, places, across, down, "moment of the fault")


def _pairs(kind: str, rows: Sequence[Row]) -> Iterator[Figure]:
    """A map of one component by the other, for each moment."""
    names = list(dict.fromkeys(name for row in rows for name in row["component"].split(AND)))
    for number, moment in enumerate(dict.fromkeys(row["moment"] for row in rows)):
        some = [row for row in rows if row["moment"] == moment]
        places = [tuple(names.index(name) for name in row["component"].split(AND)[::-1]) for row in some]
        title = f"{kind}, pairs at {moment}"
        yield _figure(f"faults_{kind}_{number}", title, some, places, names, names, "fails with")


def _figure(
    key: str,
    title: str,
    rows: Sequence[Row],
    places: Sequence[Sequence[int]],
    across: Sequence[str],
    down: Sequence[str],
    along: str,
) -> Figure:
    """Map outcome and time (s) to the right isolation of faults; ``places``: row and column of each."""
    shape = len(down), len(across)
    cells: dict[tuple[int, int], list[Row]] = {}
    for (i, j), row in zip(places, rows, strict=True):
        cells.setdefault((i, j), []).append(row)
    what, times = np.full(shape, np.nan), np.full(shape, np.nan)
    labels = [["" for _ in across] for _ in down]
    for (i, j), some in cells.items():
        what[i, j] = max(map(became, some))
        found = [row["isolation_from_use_s"] for row in some if is_right(row)]
        times[i, j] = np.median(found) if found else np.nan
        labels[i][j] = _words(some)
    lost = [place for place, some in cells.items() if not all(row["success"] for row in some)]
    down_lost, across_lost = np.array(lost, float).reshape(-1, 2).T
    crosses = [Trace(across_lost, down_lost, _LOST, "points", BLACK, symbol="x", width=1.2)] * bool(lost)
    used = [one for number, one in enumerate(_BECAME) if (what == number).any()]
    legend = [legend_entry(name, colour) for name, colour in used]
    x, y = np.arange(len(across)), np.arange(len(down))
    kinds = Heat(x, y, what, "", 0, len(_BECAME) - 1, [colour for _, colour in _BECAME], labels)
    taken = Heat(x, y, times, "time (s)", 0.0, _LONGEST_S, _SCALE, labels)
    axes = Axis(along, names=_thinned(across)), Axis("", names=down)
    panels = [
        Panel(*axes, [*legend, *crosses], heat=kinds, title="Result of fault isolation"),
        Panel(*axes, crosses, heat=taken, title="Time from first use to the right isolation (s)"),
    ]
    caption = f"{counted(len(rows), 'flight')}.  A cell with several flights shows the worst of them, and"
    caption += " the median of the times.  Point at a cell for its cases; edl6dof refly flies one again."
    height = 90 + _ROW_PX * len(down)
    return Figure(key, title.replace("_", " "), panels, caption, share_x=True, height=height)


def _thinned(names: Sequence[str]) -> list[str]:
    """Return every nth name, and empty texts between them, so that the names fit along an axis."""
    step = -(-len(names) // _NAMED) if len(names) > _BESIDE else 1
    return [name if k % step == 0 else "" for k, name in enumerate(names)]


def _words(rows: Sequence[Row]) -> str:
    """Text shown when a reader points at a cell: the fault, and the outcome of at most eight flights."""
    head = f"{rows[0]['component']} {rows[0]['kind']} at {rows[0]['moment']}"
    lines = []
    for row in rows[:8]:
        after = row.get("isolation_from_use_s")
        late = f", {after:.2f} s after first use" if after else ""
        lines.append(f"case {row['case']}: {row['outcome']}; {row.get('named') or 'nobody'} named{late}")
    return "<br>".join([head, *lines])


def _listed(title: str, column: str, rows: Sequence[Row]) -> Table:
    columns = ("case>", *_WHERE, column.replace("_", " "))
    words = title if len(rows) <= _LINES else f"{title}: the first {_LINES} of {len(rows)}"
    texts = []
    for row in rows[:_LINES]:
        value = row[column]
        shown = f"{value:.2f}" if isinstance(value, float) else str(value)
        texts.append((str(row["case"]), *(row.get(name) or "" for name in _WHERE), shown))
    return Table(columns, texts, words)
