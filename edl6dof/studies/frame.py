"""The frame of a study: findings compared with published figures, tables, pictures, and the files that
contain them.

A study is one module that reads from top to bottom: the paper, the conditions, the figures of one flight, the
findings, the pictures, and at its end ``STUDY``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, isfinite
from pathlib import Path
from time import thread_time
from typing import Any, Literal, NamedTuple

import numpy as np
import pyarrow as pa

import edl6dof
from edl6dof.campaign.executor import Collect, Row, table_of
from edl6dof.config.dump import json_text
from edl6dof.config.units import split_unit


@dataclass(frozen=True)
class Finding:
    """One figure of a study.

    Attributes:
        label: name of the figure.
        unit: printed unit; empty for a pure number.
        computed: found by this run of the study; a mean if it has a ``spread``.
        published: printed by the source; ``None`` if it prints none.
        bound: relation of the computed figure to the published one, which is a requirement; empty for a
            value, which is compared on both sides.
        note: what a reader must know to compare them.
        spread: standard deviation over the flights that ``computed`` is the mean of; ``None`` for a single
            number.
        within: largest difference, as a share of the published value, at which it counts as reproduced;
            ``None`` for a value that is shown with the computed one but not judged.
        why: cause, which a run of the study shows, of a bound that is not met or a value that is not
            reproduced; it is an error as well if the figure holds after all.
        experiment: experiment whose settings were flown, such as ``as printed`` or ``flown``; its findings
            are listed together.
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
        """True if the bound is met or the value reproduced; ``None`` without a bound or a tolerance."""
        if self.published is None:
            return None
        if self.bound:
            higher = self.computed >= self.published
            return bool(higher if self.bound == ">=" else self.computed <= self.published)
        if self.within is None:
            return None
        return bool(abs(self.computed - self.published) <= self.within * abs(self.published))

    @property
    def ok(self) -> bool:
        """True if a finite figure holds without a ``why`` or fails with one, or is not judged."""
        return self.holds is None or (isfinite(self.computed) and self.holds != bool(self.why))

    @property
    def result(self) -> str:
        """Text: met or not, reproduced within how much or not; empty without a bound or a tolerance."""
        if self.holds is None or self.published is None:
            return ""
        if self.bound:
            return "met" if self.holds else "not met" if self.why else "violated"
        if not self.holds:
            return "not reproduced"
        return f"within {max(ceil(100.0 * abs(self.computed / self.published - 1.0)), 1)} %"


def under(experiment: str, findings: Iterable[Finding]) -> list[Finding]:
    """Findings with the name of their experiment set."""
    return [replace(finding, experiment=experiment) for finding in findings]


#: A row of a table: the name of a law or case, and its figures.
Line = tuple[Any, ...]


class Grid(NamedTuple):
    """A table of figures: a line for each law or case, which begins with its name."""

    title: str
    heads: tuple[str, ...]
    rows: Sequence[Line]


class Curve(NamedTuple):
    """Points of a picture: a ``line``, ``dots``, or a thin, dashed ``reference``."""

    x: np.ndarray | Sequence[Any]
    y: np.ndarray | Sequence[Any]
    label: str = ""
    kind: Literal["line", "reference", "dots"] = "line"

    @classmethod
    def distribution(cls, sample: np.ndarray, label: str) -> Curve:
        """Share (%) of the flights whose figure is at most a value; flights without it miss at the top."""
        ordered = np.sort(np.where(np.isnan(sample), inf, sample))
        share = np.arange(1, len(ordered) + 1) / max(len(ordered), 1) * 100.0
        known = np.isfinite(ordered)
        return cls(ordered[known], share[known], label)


class Panel(NamedTuple):
    """A pair of axes with its curves; ``options`` are properties of matplotlib's axes, such as ``xlim``."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    options: Mapping[str, Any] = {}


#: Options of a panel whose axes have one scale.
SQUARE = {"aspect": "equal"}


@dataclass(frozen=True)
class Report:
    """Findings of a study, and all that is shown with them.

    Attributes:
        rows: one for each run; names of columns end in their units.
        runs: number of flights.
        grids: tables, printed before the findings.
        remarks: sentences under the tables.
        pictures: panels side by side, by the name of their file.
    """

    findings: Sequence[Finding]
    rows: Sequence[Row]
    runs: int
    grids: Sequence[Grid] = ()
    remarks: Sequence[str] = ()
    pictures: Mapping[str, Sequence[Panel]] | None = None

    @property
    def ok(self) -> bool:
        """True if every finding is ``ok``."""
        return all(finding.ok for finding in self.findings)


class Session:
    """One run of a study.

    Attributes:
        flights: wanted number of flights, as the study counts them.
        parts: wanted parts of the study, such as laws.
        seed: seed of the draws, of a study with ``Study.seed``.
        total: number of flights in all, for the progress; set by the study.
    """

    def __init__(self, flights: int, parts: Sequence[str], seed: int, progress: Callable[[int, int], None]):
        self.flights, self.parts, self.seed, self.total = flights, parts, seed, 0
        self._progress, self._done = progress, 0

    def step(self, flights: int = 1) -> None:
        """Count flights as done."""
        self._done += flights
        self._progress(self._done, self.total)

    def fly(
        self, loaded: edl6dof.LoadedScenario, cases: Iterable[edl6dof.Case], collect: Collect | None = None
    ) -> list[Row]:
        """Fly cases of a scenario in threads; returns a row for each, with the columns of ``collect``."""
        return list(edl6dof.fly_rows(loaded, cases, collect=collect, progress=lambda done, row: self.step()))


def quickest_us(call: Callable[[], None], blocks: int) -> float:
    """Processor time (us) of the quickest of some calls; slower calls are disturbed by other work."""
    call()
    times = []
    for _ in range(blocks):
        start = thread_time()
        call()
        times.append(thread_time() - start)
    return 1e6 * min(times)


@dataclass(frozen=True)
class Study:
    """One published experiment.

    Attributes:
        source: the paper.
        runs: number of runs that the source publishes.
        quick_runs: number of runs with ``--quick``.
        parts: choices of ``--only``, such as the laws that are compared; empty if the study has no parts.
        seed: seed of its draws, which ``--seed`` changes; ``None`` if they cannot be changed.
    """

    name: str
    title: str
    source: str
    run: Callable[[Session], Report]
    runs: int = 1
    quick_runs: int = 1
    parts: tuple[str, ...] = ()
    seed: int | None = None

    @property
    def counted(self) -> bool:
        """True if the number of runs can be chosen: the quick study flies fewer."""
        return self.quick_runs < self.runs

    def fly(
        self,
        flights: int | None = None,
        only: Sequence[str] = (),
        progress: Callable[[int, int], None] = lambda done, total: None,
        seed: int | None = None,
    ) -> Report:
        """Run the study.

        Args:
            flights: number of flights; by default that of the source.
            only: some of ``parts``; all if empty.
            progress: called with the flights done and the flights in all.
            seed: seed of the draws; by default ``self.seed``.
        """
        parts = [part for part in self.parts if not only or part in only]
        chosen = (self.seed or 0) if seed is None else seed
        return self.run(Session(flights or self.runs, parts, chosen, progress))


def to_json(study: Study, report: Report) -> str:
    """Findings as JSON text; a figure that could not be computed is null."""
    grids = [
        {"title": title, "rows": [dict(zip(heads, row, strict=True)) for row in rows]}
        for title, heads, rows in report.grids
    ]
    head = {"study": study.name, "title": study.title, "source": study.source, "runs": report.runs}
    found = [{**vars(one), "ok": one.ok, "result": one.result} for one in report.findings]
    rest = {"remarks": list(report.remarks), "edl6dof_version": edl6dof.__version__}
    return json_text({**head, "ok": report.ok, "findings": found, "grids": grids, **rest})


def write_study(study: Study, report: Report, folder: Path) -> None:
    """Write findings as JSON, rows as Parquet and pictures as PNG into an existing folder."""
    import pyarrow.parquet as pq

    (folder / "summary.json").write_text(to_json(study, report), encoding="utf-8")
    table, about = table_of(report.rows), {"study": study.name, "source": study.source}
    units = (split_unit(one.name.rpartition(".")[2])[1].label for one in table.schema)
    fields = [one.with_metadata({"unit": unit}) for one, unit in zip(table.schema, units, strict=True)]
    schema = pa.schema(fields, {**about, "edl6dof_version": edl6dof.__version__})
    pq.write_table(table.cast(schema), folder / "runs.parquet", compression="zstd")
    for name, panels in (report.pictures or {}).items():
        _write_picture(panels, folder / f"{name}.png")


#: How matplotlib draws a curve of each kind.
_STYLES: dict[str, dict[str, Any]] = {
    "line": {"linewidth": 1.2},
    "dots": {"linestyle": "", "marker": "."},
    "reference": {"linestyle": "--", "color": "k", "linewidth": 1.0},
}


def _write_picture(panels: Sequence[Panel], path: Path) -> None:
    import matplotlib.style
    from matplotlib.figure import Figure

    with matplotlib.style.context("petroff10"):
        across = 2 if len(panels) == 4 else min(len(panels), 3)
        down = -(-len(panels) // across)
        figure = Figure(figsize=(6.0 * across, 4.0 * down), dpi=100, layout="constrained")
        for axes, panel in zip(figure.subplots(down, across, squeeze=False).flat, panels, strict=False):
            for curve in panel.curves:
                x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
                axes.plot(x, y, label=curve.label, **_STYLES[curve.kind])
            axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label, **panel.options)
            axes.grid(alpha=0.4)
            if any(curve.label for curve in panel.curves):
                axes.legend(fontsize="small")
        figure.savefig(path)
