"""``edl6dof validate``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from edl6dof.app.counting import count_runs
from edl6dof.app.exit_status import NOT_WITHIN_LIMITS, refuse
from edl6dof.campaign.rows import Row
from edl6dof.manifest import listed
from edl6dof.missions.comparison import Compared, compare, inside, reached_goal
from edl6dof.missions.mission import load_mission, shipped_missions
from edl6dof.missions.words import HEADS, OUTSIDE, causes, cells, failures, heading, outcome
from edl6dof.missions.write import to_json, write_validation
from edl6dof.report.terminal import open_table
from edl6dof.runs.folder import atomic_folder, default_folder

#: Flights of each mission where their number is not given, and the most.
FLIGHTS, MOST_FLIGHTS = 200, 1_000_000


@dataclass(frozen=True)
class ValidateOptions:
    """Options of ``edl6dof validate``."""

    names: tuple[str, ...]
    flights: int | None
    workers: int | None
    out: Path | None
    force: bool
    as_json: bool


def run_validate(options: ValidateOptions) -> int:
    """Fly missions, set them beside what was published, write the folder; returns the exit status."""
    flights = FLIGHTS if options.flights is None else options.flights
    if not 2 <= flights <= MOST_FLIGHTS:
        return refuse(f"-n {flights}: a spread needs 2 flights, and at most {MOST_FLIGHTS} are flown")
    missions = [load_mission(name, flights) for name in options.names or shipped_missions()]
    if twice := {one.name for one in missions if [two.name for two in missions].count(one.name) > 1}:
        return refuse(f"{', '.join(sorted(twice))}: named twice")
    target = options.out or default_folder("validation", options.force)
    rows: dict[str, list[Row]] = {}
    compared: list[Compared] = []
    with atomic_folder(target, "validation", options.force) as folder:
        for mission in missions:
            with count_runs(mission.name, quiet=options.as_json) as progress:
                rows[mission.name] = mission.fly(options.workers, progress)
            compared.append(compare(mission, rows[mission.name]))
        write_validation(compared, rows, folder)
    if options.as_json:
        print(to_json(compared), end="")
    else:
        _show(compared, target)
    return 0 if reached_goal(compared) else NOT_WITHIN_LIMITS


def _show(missions: Sequence[Compared], target: Path) -> None:
    console = Console(highlight=False, soft_wrap=True)
    console.print(_table(missions))
    for mission in missions:
        for words in (*causes(mission), *failures(mission)):
            console.print(words, markup=False, soft_wrap=False)
    console.print(f"{target}: {listed(target)}", markup=False)
    console.print(Text(outcome(missions), style="bold green" if reached_goal(missions) else "bold red"))


def _table(missions: Sequence[Compared]) -> Table:
    """All missions in one table, each under a line of its own."""
    table = open_table("Predicted beside flown", *HEADS)
    for mission in missions:
        share = inside(mission.predicted)
        style = "bold" if share.successes == share.trials else "bold yellow"
        table.add_section()
        table.add_row(*(Text(words, style=style) for words in heading(mission)))
        for one in mission.predicted:
            *told, remark = cells(one)
            marked = "bold red" if OUTSIDE in remark else ""
            table.add_row(*map(Text, told), Text(remark, style=marked))
    return table
