"""``edl6dof faults``: the matrix of single faults."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from edl6dof.app.compiling import announce_compiling
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.faults import KINDS, OF_THRUSTERS, fault_cases, fault_response, may_fail, phases_of
from edl6dof.campaign.rows import Row, table_of
from edl6dof.config.document.jsontext import json_text
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.wording import counted, nearest
from edl6dof.manifest import listed
from edl6dof.runs.folder import atomic_folder
from edl6dof.scenario.schema import LoadedScenario, load_scenario

_LEGEND = """\
matrix: s from the fault to its isolation; a name: another thruster was named;
-: never fired after the fault; ?: in use, but not named
below it: medians of s to the isolation, from the fault and from its first use;
largest distance from the site (m) and attitude error (deg)"""


@dataclass(frozen=True)
class FaultOptions:
    """Options of ``edl6dof faults``; lists as texts with commas, empty for the usual ones."""

    scenario: str
    kinds: str
    phases: str
    thrusters: str
    after_s: float
    sets: tuple[str, ...]
    out: Path | None
    force: bool
    as_json: bool
    workers: int | None


def run_faults(options: FaultOptions) -> int:
    """Fly the matrix, write its table, show it; returns the exit status."""
    loaded = load_scenario(options.scenario, options.sets)
    components, phases = _grid(options, loaded)
    kinds = list(components)
    target = options.out or Path("runs") / f"faults-{loaded.scenario.name}"
    cases = fault_cases(components, phases, options.after_s)
    with atomic_folder(target, "faults", options.force) as folder:
        with _progress(len(cases), quiet=options.as_json) as progress:
            rows = list(
                fly_rows(loaded, cases, workers=options.workers, collect=fault_response, progress=progress)
            )
        pq.write_table(table_of(rows), folder / "faults.parquet", compression="zstd")
        summary = json_text(_summary(rows, kinds, phases))
        (folder / "summary.json").write_text(summary, encoding="utf-8")
    if options.as_json:
        print(summary, end="")
    else:
        _show(Console(highlight=False, soft_wrap=True), rows, kinds, phases, target)
    return 0 if all(row["success"] for row in rows) else 1


def _grid(options: FaultOptions, loaded: LoadedScenario) -> tuple[dict[str, list[str]], list[str]]:
    """What is to fail, by kind of fault, and the phases in which it fails."""
    scenario = loaded.scenario
    if not (math.isfinite(options.after_s) and options.after_s >= 0.0):
        raise ConfigError(
            [Problem("--after", 0, 0, "", f"must be a time in s, 0 or more (got {options.after_s:g})")]
        )
    if not (usual := phases_of(scenario)):
        raise ConfigError(
            [
                Problem(
                    options.scenario, 0, 0, "mission.phases", "there is no phase in which thrusters may fire"
                )
            ]
        )
    asked = ",".join(OF_THRUSTERS) if options.kinds == "all" else options.kinds
    components = {}
    for kind in _chosen("--kinds", asked, KINDS, ["stuck_off"]):
        what, names = may_fail(scenario, kind)
        if not names:
            words = f"there is no {what} that could fail"
            raise ConfigError([Problem(options.scenario, 0, 0, f"--kinds {kind}", words)])
        only = options.thrusters if what == "thruster" else ""
        components[kind] = _chosen("--thrusters", only, names, names)
    return components, _chosen("--phases", options.phases, scenario.phase_names, usual)


def _chosen(option: str, text: str, allowed: Sequence[str], usual: Sequence[str]) -> list[str]:
    """Names in a text with commas, in the order of ``allowed``."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    problems = []
    for name in names:
        if name not in allowed:
            near = nearest(name, list(allowed))
            hint = f"; did you mean {near!r}?" if near else ""
            problems.append(Problem(option, 0, 0, "", f"no {name!r}{hint} (there are: {', '.join(allowed)})"))
    if problems:
        raise ConfigError(problems)
    return [name for name in allowed if name in names] or list(usual)


def _summary(rows: Sequence[Row], kinds: Sequence[str], phases: Sequence[str]) -> dict[str, Any]:
    groups = [
        _group([row for row in rows if row["kind"] == kind and row["phase"] == phase])
        for kind in kinds
        for phase in phases
    ]
    return {
        "flights": len(rows),
        "survived": sum(row["success"] for row in rows),
        "groups": groups,
        "rows": list(rows),
    }


def _group(rows: Sequence[Row]) -> dict[str, Any]:
    """Figures of one kind of fault in one phase."""
    named = [row for row in rows if row.get("named") == row["component"]]
    times = [row["time_to_detect_s"] for row in named if "time_to_detect_s" in row]
    in_use = [
        max(row["time_to_detect_s"] - (row["unused_s"] or 0.0), 0.0)
        for row in named
        if row["kind"] != "stuck_on"
    ]
    return {
        "kind": rows[0]["kind"],
        "phase": rows[0]["phase"],
        "flights": len(rows),
        "survived": sum(row["success"] for row in rows),
        "named_right": len(named),
        "named_wrong": sum(row.get("named") not in (None, row["component"]) for row in rows),
        "never_used": sum(row["kind"] != "stuck_on" and row.get("unused_s") is None for row in rows),
        "median_time_to_detect_s": statistics.median(times) if times else None,
        "median_from_first_use_s": statistics.median(in_use) if in_use else None,
        "worst_landing_distance_m": max(
            (row["landing_distance_m"] for row in rows if "landing_distance_m" in row), default=None
        ),
        "worst_attitude_error_deg": max(
            (row["peak_attitude_error_deg"] or 0.0 for row in rows if row["success"]), default=None
        ),
    }


def _show(console: Console, rows: list[Row], kinds: list[str], phases: list[str], target: Path) -> None:
    for kind in kinds:
        console.print(_matrix([row for row in rows if row["kind"] == kind], kind, phases))
        console.print(_overview(_summary(rows, [kind], phases)["groups"]))
    console.print(_LEGEND, style="dim")
    for row in rows:
        if not row["success"]:
            console.print(
                Text(f"{row['component']} {row['kind']} in {row['phase']}: {row['outcome']}", style="red")
            )
    lost = sum(not row["success"] for row in rows)
    flights = counted(len(rows), "flight")
    outcome = f"{lost} of {flights} not within limits" if lost else f"{flights} landed within limits"
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(outcome, style="bold red" if lost else "bold green"))


def _matrix(rows: list[Row], kind: str, phases: list[str]) -> Table:
    """Components by phases: green landed and named, yellow landed and not named, red not within limits."""
    table = Table(
        title=kind.replace("_", " "),
        title_justify="left",
        title_style="bold",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    table.add_column("", header_style="")
    for phase in phases:
        table.add_column(phase, justify="right", header_style="")
    cells = {(row["component"], row["phase"]): _cell(row) for row in rows}
    for name in dict.fromkeys(row["component"] for row in rows):
        table.add_row(name, *(cells[name, phase] for phase in phases))
    return table


def _cell(row: Row) -> Text:
    right = row.get("named") == row["component"]
    if right:
        found = f"{row['time_to_detect_s']:.2f}"
    elif row.get("named"):
        found = str(row["named"])
    else:
        found = "-" if row["kind"] != "stuck_on" and row.get("unused_s") is None else "?"
    if not row["success"]:
        return Text(f"{row.get('cause', 'lost')} {found}", style="bold red")
    return Text(found, style="green" if right else ("magenta" if row.get("named") else "yellow"))


def _overview(groups: list[dict[str, Any]]) -> Table:
    """Counts, median times from fault and from first use to the isolation, largest distance from the site and
    attitude error.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(
        ("phase", "landed", "named", "wrong", "from\nfault s", "from\nuse s", "site\nm", "error\ndeg")
    ):
        table.add_column(
            heading, justify="right" if index else "left", header_style="", vertical="bottom", no_wrap=True
        )
    for group in groups:
        counts = (f"{group['survived']}/{group['flights']}", group["named_right"], group["named_wrong"])
        figures = [(group["median_time_to_detect_s"], 2), (group["median_from_first_use_s"], 2)]
        figures += [(group["worst_landing_distance_m"], 0), (group["worst_attitude_error_deg"], 1)]
        shown = ("" if value is None else f"{value:.{digits}f}" for value, digits in figures)
        table.add_row(group["phase"], *map(str, counts), *shown)
    return table


@contextmanager
def _progress(total: int, quiet: bool) -> Iterator[Callable[[int, Row], None] | None]:
    """A bar on stderr, if that is a terminal; a word before the first flight has to be compiled."""
    announce_compiling(not quiet)
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.fields[last]:<40}"),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("faults", total=total, last="")

        def report(done: int, row: Row) -> None:
            bar.update(task, completed=done, last=f"{row['component']} {row['kind']} {row['phase']}")

        yield report
