"""What a study is, and what it hands back: findings beside published figures, drawings, and a table with a
row for each run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import ceil, isfinite
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
        within: largest difference, as a share of the published value, at which it counts as reproduced;
            ``None`` for a value that is set beside the computed one without a bound or a tolerance.
        why: cause, which a run of the study shows, of a bound that is not kept or a value that is not
            reproduced; it is an error as well if such a figure holds after all.
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
    within: float | None = None
    why: str = ""
    experiment: str = ""

    @property
    def holds(self) -> bool | None:
        """Whether the bound is kept or the value reproduced; ``None`` without a bound or a tolerance."""
        if self.published is None or not (self.bound or self.within is not None):
            return None
        if self.bound:
            return bool(
                self.computed <= self.published if self.bound == "<=" else self.computed >= self.published
            )
        return bool(abs(self.computed - self.published) <= (self.within or 0.0) * abs(self.published))

    @property
    def ok(self) -> bool:
        """Whether the figure is as the study says; one that could not be formed is not."""
        if self.holds is None:
            return True
        return isfinite(self.computed) and self.holds != bool(self.why)

    @property
    def result(self) -> str:
        """In words: kept or not, reproduced within how much or not; empty without a bound or a tolerance."""
        if self.holds is None or self.published is None:
            return ""
        if self.bound:
            return "kept" if self.holds else "not kept" if self.why else "broken"
        if not self.holds:
            return "not reproduced"
        return f"within {max(ceil(100.0 * abs(self.computed / self.published - 1.0)), 1)} %"


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
        """Whether every figure is as the study says."""
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
            {**vars(finding), "ok": finding.ok, "result": finding.result} for finding in report.findings
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
