"""``edl6dof study``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import floor, isfinite, isinf, isnan, log10
from pathlib import Path
from statistics import median
from textwrap import wrap

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.app.counting import count_runs
from edl6dof.app.exit_status import refuse
from edl6dof.config.wording import counted, nearest
from edl6dof.manifest import listed
from edl6dof.report.numbers import significant
from edl6dof.report.terminal import open_table
from edl6dof.runs.folder import atomic_folder, default_folder
from edl6dof.studies.registry import STUDIES
from edl6dof.studies.study import Finding, Grid, Progress, Report, Study
from edl6dof.studies.write import to_json, write_study

#: More flights than any study needs to settle a mean.
MOST_RUNS = 1_000_000
#: Letters of a line of a table's title.
_WIDE = 80


#: A smaller spread, as a share of the value, is rounding: flights that do not differ in it.
ROUNDING = 1e-6


@dataclass(frozen=True)
class StudyOptions:
    """Options of ``edl6dof study``."""

    name: str | None
    runs: int | None
    only: tuple[str, ...]
    out: Path | None
    force: bool
    quick: bool
    as_json: bool


def run_study(options: StudyOptions) -> int:
    """Fly a study, write its folder, show what it found; returns the exit status.  Without a name, list the
    studies.
    """
    if options.name is None:
        return _list()
    study = STUDIES.get(options.name)
    if study is None:
        near = nearest(options.name, list(STUDIES))
        hint = f"; did you mean {near!r}?" if near else ""
        return refuse(f"{options.name}: no such study{hint} (studies: {', '.join(STUDIES)})")
    if options.runs is not None and (not 1 <= options.runs <= MOST_RUNS or not study.counted):
        reason = f"must be 1 to {MOST_RUNS}" if study.counted else f"{study.name} is a fixed set of flights"
        return refuse(f"-n {options.runs}: {reason}")
    if unknown := sorted(set(options.only) - set(study.parts)):
        allowed = f"one of {', '.join(study.parts)}" if study.parts else "left out: this study is one whole"
        return refuse(f"--only {', '.join(unknown)}: must be {allowed}")
    target = options.out or default_folder(f"study-{study.name}", options.force)
    runs = options.runs or (study.quick_runs if options.quick else study.runs)
    with atomic_folder(target, "study", options.force) as folder:
        with count_runs(study.name, quiet=options.as_json) as progress:
            report = _flown(study, options.only, runs, progress)
        write_study(study, report, folder)
    if options.as_json:
        print(to_json(study, report), end="")
    else:
        _show(study, report, target)
    return 0 if report.ok else 1


def _flown(study: Study, only: tuple[str, ...], runs: int, progress: Progress) -> Report:
    if only and study.run_parts is not None:
        return study.run_parts([part for part in study.parts if part in only], runs, progress)
    return study.run(runs, progress)


def _list() -> int:
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    for name, study in STUDIES.items():
        table.add_row(name, f"{study.title} ({study.source})")
    Console(highlight=False).print(table)
    return 0


def _show(study: Study, report: Report, target: Path) -> None:
    console = Console(highlight=False, soft_wrap=True)
    for grid in report.grids:
        console.print(_grid(grid))
        console.print()
    count = f", {counted(report.runs, 'run')}" if study.counted else ""
    console.print(Text(f"{study.title}{count}", style="bold"))
    for experiment, findings in groupby(report.findings, key=lambda finding: finding.experiment):
        console.print(_table(experiment, findings))
    for remark in (*_causes(report), *report.remarks):
        console.print(remark, markup=False, soft_wrap=False)
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(f"{study.name}: {_outcome(report)}", style="bold green" if report.ok else "bold red"))


def _table(experiment: str, findings: Iterable[Finding]) -> Table:
    """The findings of one experiment, under its name."""
    table = open_table(experiment, "figure", "unit", "computed>", "published>", "difference>", "", "note")
    for finding in findings:
        table.add_row(
            finding.label,
            finding.unit,
            *_numbers(finding),
            _difference(finding),
            _mark(finding),
            finding.note,
        )
    return table


def _causes(report: Report) -> list[str]:
    """A sentence for each cause why published figures do not hold."""
    causes: dict[str, dict[str, None]] = {}
    for finding in report.findings:
        if finding.why:
            causes.setdefault(finding.why, {})[finding.label] = None
    return [f"Does not hold ({'; '.join(labels)}): {why}." for why, labels in causes.items()]


def _outcome(report: Report) -> str:
    """What stands under the table: figures that are not as the study says, else how many hold."""
    if missed := [finding.label for finding in report.findings if not finding.ok]:
        return f"broken: {', '.join(missed)}"
    explained = sum(bool(finding.why) for finding in report.findings)
    values = [finding for finding in report.findings if finding.within is not None]
    reproduced = f"; {sum(bool(f.holds) for f in values)} of {len(values)} published values reproduced"
    return (
        "every requirement is kept" if not explained else "every figure that does not hold is explained"
    ) + (reproduced if values else "")


def _grid(grid: Grid) -> Table:
    """A table of many columns in 80 characters: narrow gaps, the words of a heading below each other, numbers
    never cut.
    """
    table = Table(
        title="\n".join(wrap(grid.title, _WIDE)),
        title_justify="left",
        title_style="bold",
        box=None,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    names, *columns = zip(*grid.rows, strict=True)
    cells = [names, *(_decimals(column, like) for column, like in zip(columns, _alike(grid), strict=True))]
    for index, (head, column) in enumerate(zip(grid.heads, cells, strict=True)):
        width = max(map(len, (*column, *head.split())))
        heading = "\n".join(wrap(head, width))
        table.add_column(
            heading,
            justify="right" if index else "left",
            header_style="dim",
            vertical="bottom",
            no_wrap=True,
            min_width=width,
        )
    for row in zip(*cells, strict=True):
        table.add_row(*row)
    return table


def _alike(grid: Grid) -> Iterator[list[float]]:
    """For each column of numbers those that have its decimals: its own, and those of its bounds."""
    of = [head.removesuffix(" from").removesuffix(" to") for head in grid.heads]
    for name in of[1:]:
        yield [float(row[k]) for row in grid.rows for k in range(1, len(of)) if of[k] == name]


def _decimals(column: Sequence[float], like: Sequence[float]) -> list[str]:
    """Numbers of a column with as many decimals as give the middle one of those ``like`` it three digits, two
    at most; an infinite one is that of a flight that failed.
    """
    sizes = [abs(value) for value in like if isfinite(value) and value]
    digits = min(max(2 - floor(log10(median(sizes))), 0), 2) if sizes else 0
    return [
        f"{value:.{digits}f}" if isfinite(value) else "fails" if isinf(value) else "-" for value in column
    ]


def _numbers(finding: Finding) -> tuple[str, str]:
    published = (
        "" if finding.published is None else f"{finding.bound} {significant(finding.published)}".strip()
    )
    computed = "-" if isnan(finding.computed) else significant(finding.computed)
    if finding.spread is None:
        return computed, published
    spread = finding.spread if finding.spread > ROUNDING * abs(finding.computed) else 0.0
    return f"{computed} +- {significant(spread, 2)}", published


def _difference(finding: Finding) -> str:
    """Computed less published, where that is a flown value."""
    if finding.bound or finding.published is None:
        return ""
    difference = finding.computed - finding.published
    return f"{'' if difference < 0.0 else '+'}{significant(difference, 2)}"


def _mark(finding: Finding) -> Text:
    style = "bold red" if not finding.ok else "yellow" if finding.why else "green"
    return Text(finding.result, style=style)
