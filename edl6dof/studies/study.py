"""What a study is, and what it hands back: findings beside published figures, drawings, and a table with a
row for each run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Literal

import pyarrow as pa

from edl6dof.report.figure import Figure

#: Called with (runs done, runs in all).
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Finding:
    """One figure of a study.

    Attributes:
        label: what it is.
        unit: printed unit; empty for a pure number.
        computed: found by this run of the study; a mean where ``spread`` says so.
        published: printed by the source; ``None`` where it prints none.
        bound: how the computed figure must lie to the published one, which is a requirement; empty for a
            value, which is compared on both sides.
        note: what a reader must know to compare them.
        spread: standard deviation over the flights that ``computed`` is the mean of; ``None`` for a single
            number.
        within_pct: how far the computed figure may be from the published one, to either side, to count as
            reproduced; ``None`` where nothing is claimed.
        cause: why it is not reproduced, where it is known not to be: then it must not be.
        experiment: whose settings were flown, such as ``as printed`` or ``flown``; findings of one stand
            together.
    """

    label: str
    unit: str
    computed: float
    published: float | None = None
    bound: Literal["", "<=", ">="] = ""
    note: str = ""
    spread: float | None = None
    within_pct: float | None = None
    cause: str = ""
    experiment: str = ""

    @property
    def reproduced(self) -> bool | None:
        """Whether the published value comes out, too high or too low being the same; ``None`` where that is
        not claimed either way.
        """
        if self.within_pct is None or self.published is None:
            return None
        return bool(abs(self.computed - self.published) <= 0.01 * self.within_pct * abs(self.published))

    @property
    def ok(self) -> bool:
        """Whether what is said of it holds: the bound is kept, the value is reproduced or, with a cause, is
        not; a figure that could not be formed holds nothing.
        """
        if self.published is None:
            return True
        if self.reproduced is not None:
            return isfinite(self.computed) and self.reproduced != bool(self.cause)
        if not self.bound:
            return True
        return bool(
            self.computed <= self.published if self.bound == "<=" else self.computed >= self.published
        )


@dataclass(frozen=True)
class Grid:
    """A table of figures: a row for each law or case, the first entry of a row its name."""

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str | float, ...], ...]


@dataclass(frozen=True)
class Report:
    """What a study found.

    Attributes:
        findings: computed beside published.
        drawings: the source's figures, redrawn.
        table: a row for each run, columns named with unit suffixes.
        runs: how many flights were flown.
        remarks: sentences under the table.
        grids: tables that compare, printed before the findings.
    """

    findings: tuple[Finding, ...]
    drawings: tuple[Figure, ...]
    table: pa.Table
    runs: int
    remarks: tuple[str, ...] = ()
    grids: tuple[Grid, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every finding is as it is said to be."""
        return all(finding.ok for finding in self.findings)


@dataclass(frozen=True)
class Study:
    """One published experiment.

    Attributes:
        name: as typed on the command line.
        title: one line.
        source: the paper.
        run: flies it, given the number of runs and a progress callback.
        runs: how many runs the source publishes.
        quick_runs: how many ``--quick`` flies.
        counted: whether the number of runs can be chosen at all.
        parts: what ``--only`` may choose from, such as the laws that are compared; empty where it is whole.
        run_parts: flies the chosen parts, as ``run`` flies all.
    """

    name: str
    title: str
    source: str
    run: Callable[[int, Progress], Report]
    runs: int = 1
    quick_runs: int = 1
    counted: bool = field(default=False)
    parts: tuple[str, ...] = ()
    run_parts: Callable[[Sequence[str], int, Progress], Report] | None = None

    def as_dict(self, report: Report) -> dict[str, Any]:
        """Plain values for JSON."""
        findings = [
            {**vars(finding), "reproduced": finding.reproduced, "ok": finding.ok}
            for finding in report.findings
        ]
        head = {
            "study": self.name,
            "title": self.title,
            "source": self.source,
            "runs": report.runs,
            "ok": report.ok,
        }
        grids = [
            {"title": g.title, "rows": [dict(zip(g.heads, row, strict=True)) for row in g.rows]}
            for g in report.grids
        ]
        return {**head, "findings": findings, "grids": grids, "remarks": list(report.remarks)}
