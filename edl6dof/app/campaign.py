"""``edl6dof campaign`` and ``edl6dof refly``."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from edl6dof.app.compiling import announce_compiling
from edl6dof.app.ending import INTERRUPTED, refuse
from edl6dof.campaign import run
from edl6dof.campaign.engines import Engine, Threads, dask_engine
from edl6dof.campaign.plan import Plan, load_plan
from edl6dof.campaign.statistics import Proportion, Until
from edl6dof.campaign.store import Store, StoreError
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.post.folder import atomic_folder
from edl6dof.post.numbers import significant

if TYPE_CHECKING:
    from edl6dof.campaign.compare import Comparison


@dataclass(frozen=True)
class CampaignOptions:
    """Options of ``edl6dof campaign``."""

    scenario: str | None
    sets: tuple[str, ...]
    cases: int | None
    seed: int | None
    engine: str
    cluster: str | None
    workers: int | None
    out: Path | None
    force: bool
    resume: bool
    until: str | None
    quiet: bool
    as_json: bool


def run_campaign(options: CampaignOptions) -> int:
    """Fly a campaign, or go on with one; returns the exit status."""
    _check(options)
    try:
        plan, store = _resumed(options) if options.resume else _new(options)
        with store.lock():
            return _fly(plan, store, options)
    except StoreError as error:
        return refuse(str(error))


def _check(options: CampaignOptions) -> None:
    if options.scenario is None:
        raise _problem("edl6dof campaign", "name a campaign file, such as tianwen1_mc, or with --resume the folder of a campaign")
    if options.until is not None:
        try:
            Until.parse(options.until)
        except ValueError as error:
            raise _problem("--until", str(error)) from None
    if options.engine not in ("threads", "dask"):
        raise _problem("--engine", f"must be threads or dask (got {options.engine!r})")
    if options.cluster is not None and options.engine != "dask":
        raise _problem("--cluster", "needs --engine dask")


def _new(options: CampaignOptions) -> tuple[Plan, Store]:
    plan = load_plan(options.scenario, options.sets, options.cases, options.seed)
    store = Store(options.out or Path("runs") / plan.name)
    if options.force:
        store.clear()
    run.begin(plan, store, options.until)
    return plan, store


def _resumed(options: CampaignOptions) -> tuple[Plan, Store]:
    folder = Path(options.scenario)
    if not (folder / "campaign.json").is_file():
        given = load_plan(options.scenario, options.sets, options.cases, options.seed)
        folder = options.out or Path("runs") / given.name
        if given.text != Store(folder).plan_text:
            raise StoreError(f"{folder} was begun with another plan; go on with it by: edl6dof campaign {folder} --resume")
    elif options.sets or options.cases is not None or options.seed is not None:
        raise StoreError(f"{folder} has its plan; it takes no other values when it goes on")
    store = Store(folder)
    return run.resumed_plan(store), store


def _fly(plan: Plan, store: Store, options: CampaignOptions) -> int:
    talk = not (options.quiet or options.as_json)
    if not store.complete:
        try:
            _warm_up(plan, talk)
            with _engine(options) as engine, _progress(talk, plan.count) as report:
                run.fly(plan, store, engine, report)
        except KeyboardInterrupt:
            print(f"interrupted; what has flown is kept; go on with: edl6dof campaign {store.folder} --resume", file=sys.stderr)
            return INTERRUPTED
        except OSError as error:
            words = f"{error.strerror or error}; what has flown is kept; go on with: edl6dof campaign {store.folder} --resume"
            return refuse(f"{store.folder}: {words}")
    _show(store, options)
    return 0


@contextmanager
def _engine(options: CampaignOptions) -> Iterator[Engine]:
    if options.engine == "threads":
        yield Threads(options.workers)
        return
    try:
        with dask_engine(options.cluster, options.workers) as engine:
            yield engine
    except ImportError:
        raise _problem("--engine", "Dask is not installed; try: pip install 'edl6dof[dask]'") from None


def _warm_up(plan: Plan, talk: bool) -> None:
    """Compile before anything flies in parallel: two processes that compile would do the work twice."""
    if announce_compiling(talk):
        from edl6dof.campaign.executor import Pilot

        Pilot(plan.loaded).fly(list(plan.cases(0, 1)))


@contextmanager
def _progress(talk: bool, total: int) -> Iterator[run.Report | None]:
    """Progress with rate, time left, and success so far, on stderr; a line at every tenth where that is no terminal."""
    console = Console(stderr=True)
    if not talk:
        yield None
        return
    if not console.is_terminal:
        yield _lines()
        return
    columns = (
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]:6.1f}/s"),
        TimeRemainingColumn(),
        TextColumn("success {task.fields[success]}"),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("fly", total=total, rate=0.0, success="")
        yield lambda tally: bar.update(task, completed=tally.flown, rate=tally.rate, success=str(tally.success))


def _lines() -> run.Report:
    shown = [0]

    def report(tally: run.Tally) -> None:
        tenth = 10 * tally.flown // tally.total
        if tenth > shown[0]:
            shown[0] = tenth
            print(f"{tally.flown} of {tally.total}, {tally.rate:.1f}/s, success {tally.success}", file=sys.stderr, flush=True)

    return report


def _show(store: Store, options: CampaignOptions) -> None:
    summary = json.loads((store.folder / "summary.json").read_text(encoding="utf-8"))
    if options.as_json:
        print(json.dumps(summary, indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    success = Proportion(summary["successes"], summary["cases"])
    style = "bold green" if success.value >= 0.99 else "bold yellow"
    console.print(f"[{style}]{escape(summary['name'])}: {success.successes} of {success.trials} succeed, {success}[/]")
    if options.quiet:
        return
    for cause in summary["causes"]:
        console.print(f"  {cause['cases']:>6}  {cause['cause']}", markup=False)
    if summary["cases"] < summary["cases_planned"]:
        console.print(f"stopped after {summary['cases']} of {summary['cases_planned']} cases: the interval is narrow enough")
    if summary["flown_in_this_run"]:
        console.print(f"{summary['flights_per_second']:.1f} flights per second on {summary['engine']}", markup=False)
    console.print(f"next: edl6dof report {store.folder}, edl6dof refly {store.folder} CASE", markup=False)


def run_refly(folder: Path, number: int, out: Path | None, force: bool, replay: bool) -> int:
    """Fly one case again with all its telemetry, and compare it with its row; returns the exit status."""
    from edl6dof.app.fly import write_files
    from edl6dof.campaign.refly import differences, reflown

    target = out or Path("runs") / f"{folder.resolve().name}_case{number}"
    try:
        store = Store(folder)
        plan = run.resumed_plan(store)
        with atomic_folder(target, "flight", force) as partial:
            flight = reflown(plan, number)
            wrong = differences(store, plan, number, flight)
            write_files(flight, partial, replay)
    except StoreError as error:
        return refuse(str(error))
    print(f"{target}: case {number}, {flight.outcome}")
    print("identical to its row" if not wrong else f"differs from its row: {', '.join(wrong)}")
    return 1 if wrong else 0


def run_compare(first: Path, second: Path, as_json: bool) -> int:
    """Compare two campaigns on common random numbers; returns the exit status."""
    from edl6dof.campaign.compare import compare

    try:
        result = compare(Store(first), Store(second))
    except StoreError as error:
        return refuse(str(error))
    if as_json:
        print(json.dumps(result.data, indent=1))
        return 0
    _show_comparison(Console(highlight=False, soft_wrap=True), result)
    return 0


def _show_comparison(console: Console, result: Comparison) -> None:
    a, b = result.names
    both, only_a, only_b, neither = result.counts
    for name, success in zip(result.names, result.success, strict=True):
        console.print(f"{name}: success {success}", markup=False)
    console.print(f"both succeed {both}, {a} alone {only_a}, {b} alone {only_b}, neither {neither}", markup=False)
    console.print(f"a split as uneven by chance alone: p = {result.p_value:.3g} (McNemar, exact)")
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="Paired differences that are clear at 95 %", title_justify="left")
    for column in ("figure", a, b, "B - A", "95 %"):
        table.add_column(column, justify="left" if column == "figure" else "right")
    for figure in result.figures:
        if figure.clear:
            numbers = (figure.mean_a, figure.mean_b, figure.difference, figure.half_width)
            table.add_row(figure.figure, *(significant(number, 5) for number in numbers[:3]), f"+-{significant(numbers[3], 2)}")
    console.print(table if table.row_count else "no figure differs clearly")


def _problem(place: str, message: str) -> ConfigError:
    return ConfigError([Problem(place, 0, 0, "", message)])
