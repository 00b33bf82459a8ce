"""``edl6dof study``: repeat a paper's experiment and compare computed with published values."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from math import floor, isfinite, isinf, isnan, log10
from pathlib import Path
from statistics import median
from textwrap import wrap

from rich.console import Console, Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from edl6dof.api.progress import count_runs
from edl6dof.cli.group import refuse
from edl6dof.config.wording import counted, unknown
from edl6dof.manifest import listed
from edl6dof.report.document import significant
from edl6dof.report.terminal import open_table
from edl6dof.runs.files import atomic_folder, default_folder
from edl6dof.studies import STUDIES
from edl6dof.studies.frame import Finding, Grid, Report, Study, to_json, write_study

#: Flights of a study at most, and letters of a line of a table.
MOST_RUNS, _WIDE = 1_000_000, 80
#: A number and the space between it and its unit, or a percent sign.
_UNIT, _PERCENT = (re.compile(rf"(?<!\S)([+-]?\d[\d.,]*) (?={after})") for after in ("[%a-zA-Z]", "%"))
#: Spread, as a share of the value, up to which flights count as equal.
ROUNDING = 1e-6


def run_study(
    name: str,
    *,
    runs: int | None = None,
    seed: int | None = None,
    only: Sequence[str] = (),
    out: Path | None = None,
    force: bool = False,
    quick: bool = False,
    as_json: bool = False,
) -> int:
    """Fly a study, write its folder and print its result; return the exit status."""
    study = STUDIES.get(name)
    if study is None:
        return refuse(unknown("study", name, STUDIES))
    if runs is not None and (not 1 <= runs <= MOST_RUNS or not study.counted):
        reason = f"must be 1 to {MOST_RUNS}" if study.counted else f"{study.name} is a fixed set of flights"
        return refuse(f"-n {runs}: {reason}")
    if seed is not None and study.seed is None:
        return refuse(f"--seed {seed}: the draws of {study.name} are fixed")
    if others := sorted(set(only) - set(study.parts)):
        allowed = f"one of {', '.join(study.parts)}" if study.parts else "left out: this study is one whole"
        return refuse(f"--only {', '.join(others)}: must be {allowed}")
    target = out or default_folder(f"study-{study.name}", force)
    count = runs or (study.quick_runs if quick else study.runs)
    with atomic_folder(target, "study", force) as folder:
        with count_runs(study.name, quiet=as_json) as progress:
            report = study.fly(count, only, progress, seed)
        write_study(study, report, folder)
    if as_json:
        print(to_json(study, report), end="")
    else:
        _show(study, report, target)
    return 0 if report.ok else 1


def list_studies() -> int:
    """Print the studies and their papers; return the exit status."""
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
    print(f"{target}: {listed(target)}")
    console.print(Text(f"{study.name}: {_outcome(report)}", style="bold green" if report.ok else "bold red"))


def _table(experiment: str, findings: Iterable[Finding]) -> Table:
    """Tabulate the findings of one experiment without empty columns."""
    rows = [(finding, (finding.unit, *_numbers(finding), *_compared(finding))) for finding in findings]
    heads = ("unit", "computed>", "published>", "difference>", ">")
    filled = [k for k in range(len(heads)) if any(cells[k] for _, cells in rows)]
    table = open_table(experiment, "figure", *(heads[k] for k in filled))
    figure = table.columns[0]
    figure.min_width = max(len(word) for finding, _ in rows for word in finding.label.split())
    figure.max_width = _WIDE
    for finding, cells in rows:
        note = [Padding(Text(finding.note, style="dim"), (0, 0, 0, 2))] if finding.note else []
        table.add_row(Group(Text(finding.label), *note), *(cells[k] for k in filled))
    return table


def _causes(report: Report) -> list[str]:
    """A sentence for each cause for which published figures are not reproduced."""
    causes: dict[str, dict[str, None]] = {}
    for finding in report.findings:
        if finding.why:
            causes.setdefault(finding.why, {})[finding.label] = None
    return [f"Does not hold ({'; '.join(labels)}): {why}." for why, labels in causes.items()]


def _outcome(report: Report) -> str:
    """Text of the violated figures of a study, or of the number of reproduced ones."""
    if missed := [finding.label for finding in report.findings if not finding.ok]:
        return f"violated: {', '.join(missed)}"
    explained = sum(bool(finding.why) for finding in report.findings)
    values = [finding for finding in report.findings if finding.within is not None]
    reproduced = f"; {sum(bool(f.holds) for f in values)} of {len(values)} published values reproduced"
    kept = "every figure that does not hold is explained" if explained else "every requirement is met"
    return kept + (reproduced if values else "")


def _grid(grid: Grid) -> Table:
    """A table of many columns in 80 characters: narrow gaps, broken headings, whole numbers."""
    table = Table(
        title=_below_each_other(_bound(grid.title, _PERCENT), _WIDE),
        title_justify="left",
        title_style="bold",
        box=None,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    names, *columns = zip(*grid.rows, strict=True)
    cells = [names, *(_decimals(column, like) for column, like in zip(columns, _alike(grid), strict=True))]
    heads, widths = _headings(grid.heads, [max(map(len, column)) for column in cells])
    for index, (head, width) in enumerate(zip(heads, widths, strict=True)):
        table.add_column(
            _below_each_other(head, width),
            justify="right" if index else "left",
            header_style="dim",
            vertical="bottom",
            no_wrap=True,
            min_width=width,
        )
    for row in zip(*cells, strict=True):
        table.add_row(*row)
    return table


def _headings(heads: Sequence[str], least: Sequence[int]) -> tuple[list[str], list[int]]:
    """Headings and widths of their columns; numbers stay with their units where there is room for it."""
    for together in (_UNIT, _PERCENT):
        bound = [_bound(head, together) for head in heads]
        widths = [max(most, *map(len, head.split(" "))) for head, most in zip(bound, least, strict=True)]
        if sum(widths) + len(widths) - 1 <= _WIDE:
            break
    return bound, widths


def _bound(text: str, together: re.Pattern[str]) -> str:
    """A text with no-break spaces between numbers and their units."""
    return together.sub("\\1\u00a0", text)


def _below_each_other(text: str, width: int) -> str:
    """A text broken into lines at its spaces, not at its no-break spaces, which become plain."""
    return "\n".join(wrap(text, width)).replace("\u00a0", " ")


def _alike(grid: Grid) -> Iterator[list[float]]:
    """Yield for each column the numbers that determine its decimals: its own, and those of its bounds."""
    of = [head.removesuffix(" from").removesuffix(" to") for head in grid.heads]
    for name in of[1:]:
        yield [float(row[k]) for row in grid.rows for k in range(1, len(of)) if of[k] == name]


def _decimals(column: Sequence[float], like: Sequence[float]) -> list[str]:
    """Format numbers with 0 to 2 decimals, so that the median of ``like`` has three significant digits where
    possible; whole numbers get none.  Infinite becomes 'fails', NaN '-'.
    """
    sizes = [abs(value) for value in like if isfinite(value) and value]
    whole = all(size.is_integer() for size in sizes)
    digits = 0 if whole else min(max(2 - floor(log10(median(sizes))), 0), 2)
    return [f"{one:.{digits}f}" if isfinite(one) else "fails" if isinf(one) else "-" for one in column]


def _numbers(finding: Finding) -> tuple[str, str]:
    number = finding.published
    published = "" if number is None else f"{finding.bound} {significant(number)}".strip()
    computed = "-" if isnan(finding.computed) else significant(finding.computed)
    if finding.spread is None:
        return computed, published
    spread = finding.spread if finding.spread > ROUNDING * abs(finding.computed) else 0.0
    return f"{computed} +- {significant(spread, 2)}", published


def _compared(finding: Finding) -> tuple[str | Text, str | Text]:
    """Return two cells: of a requirement the result and nothing; of a flown value difference and result."""
    style = "bold red" if not finding.ok else "yellow" if finding.why else "green"
    result = Text(finding.result, style=style)
    if finding.bound or finding.published is None:
        return result, ""
    difference = finding.computed - finding.published
    return f"{'' if difference < 0.0 else '+'}{significant(difference, 2)}", result
