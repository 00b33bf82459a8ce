"""Fly a small campaign in child processes, each of which dies, or meets an error, at one of its durable
operations.

    python campaign_faults.py FOLDER STORY:FAULT:EVERY ...

STORY is what the campaign does: ``new``, ``resume`` (its first part is there), ``force`` (another is complete
there) or ``force_unfinished``; of these two, what goes before the operations of ``new``.  FAULT is ``before``
or ``after`` (the process ends there at once) or the name of an error, such as ENOSPC.  Every EVERY-th
operation is tried once; for each, a line of JSON tells how the program ended, what readers then say, and
which table the next attempt gives.  Readers and the next attempt see nothing but the folder: one that was
left before, byte for byte, is not asked again.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import io
import json
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[1] / "campaign"))

from campaign_run import write_drop

from edl6dof.api import campaign as campaign_api
from edl6dof.api.reports import report_of
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.executor import CaseRunner, table_of
from edl6dof.campaign.identity import source_hash
from edl6dof.campaign.store import Store
from edl6dof.cli import campaigns
from edl6dof.cli.group import INTERRUPTED
from edl6dof.config.errors import ConfigError
from edl6dof.report.campaign import campaign_report  # noqa: F401  loaded once, not in every child

#: Two parts, the second not full.
CASES = 70
SEEDS = (3, 9)
OPERATIONS = ("replace", "fsync", "unlink", "rmdir", "mkdir", "open")
#: Status of a process that was made to die.
DEAD = 77
RUN = Path("runs/drops")
#: Names and contents; a folder has none.
Folder = frozenset[tuple[str, bytes | None]]


class Recorded:
    """An engine with the rows of flights flown before; it may stop after the first range."""

    def __init__(self, rows: dict[int, list[dict[str, Any]]], stops: bool = False):
        self.flown, self.stops = rows, stops

    def __str__(self) -> str:
        return "recorded rows"

    def rows(self, plan: Plan, ranges: Any) -> Iterator[dict[str, Any]]:
        """Rows of all cases."""
        for first, last in ranges:
            yield from self.flown[plan.campaign.seed][first:last]
            if self.stops:
                raise KeyboardInterrupt


class Faults:
    """Counts the durable operations of this process, and does something at one of them."""

    def __init__(self, number: int, fault: str):
        self.number, self.fault, self.seen = number, fault, []
        for name in OPERATIONS:
            module = io if name == "open" else os
            setattr(module, name, self._watched(name, getattr(module, name)))

    def _watched(self, name: str, operation: Callable[..., Any]) -> Callable[..., Any]:
        def watched(target: Any, *more: Any, **named: Any) -> Any:
            if name == "open" and not set("wax+") & set(more[0] if more else named.get("mode", "r")):
                return operation(target, *more, **named)
            if name == "mkdir" and os.path.isdir(target):  # filelock asks for the folder that it locks
                return operation(target, *more, **named)
            self.seen.append(
                f"{name} {os.readlink(f'/proc/self/fd/{target}') if isinstance(target, int) else target}"
            )
            here = len(self.seen) == self.number
            if here and self.fault == "before":
                os._exit(DEAD)
            if here and self.fault not in ("before", "after"):
                raise OSError(getattr(errno, self.fault), os.strerror(getattr(errno, self.fault)))
            try:
                return operation(target, *more, **named)
            finally:
                if here and self.fault == "after":
                    os._exit(DEAD)

        return watched


def in_child(work: Callable[[], Any]) -> tuple[int, Any]:
    """Do something in a process of its own: how it ended, and what it returned."""
    reading, writing = os.pipe()
    if (child := os.fork()) == 0:
        os.close(reading)
        try:
            result = work()
        except BaseException as error:  # whatever comes out of the program is what is looked for
            result = {"uncaught": repr(error)}
        os.write(writing, json.dumps(result).encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        text = pipe.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), json.loads(text) if text else None


def command(file: str, **chosen: Any) -> dict[str, Any]:
    """Status and standard error of ``edl6dof campaign``, as the command line has them."""
    given = {"cases": CASES, "quiet": True, **chosen}
    with contextlib.redirect_stderr(io.StringIO()) as err, contextlib.redirect_stdout(io.StringIO()):
        try:
            status = campaigns.campaign(file, **given)
        except ConfigError as error:
            status = 2
            print(error, file=err)
    return {"status": status, "err": err.getvalue()}


def resumed() -> dict[str, Any]:
    """``edl6dof campaign runs/drops --resume``."""
    return command(str(RUN), cases=None, resume=True)


def read() -> dict[str, str]:
    """What the readers of a campaign say: the rows that they find are counted, or their message is given."""
    said = {}
    for name, reader in (
        ("table", lambda: Store(RUN).table().num_rows),
        ("report", lambda: report_of(RUN).headline),
    ):
        try:
            said[name] = str(reader())
        except ConfigError as error:
            said[name] = f"message: {error}"
    return said


def unnumbered(names: list[str]) -> list[str]:
    """Names of files without the number of the process that wrote them."""
    return [re.sub(r"\.\d+\.part$", ".part", name) for name in names]


def left_over() -> Folder:
    """Every file and folder that is there, and what is in it."""
    found = [path for path in (RUN, *RUN.rglob("*")) if path.exists()]
    contents = [path.read_bytes() if path.is_file() else None for path in found]
    return frozenset(zip(unnumbered([str(path) for path in found]), contents, strict=True))


class Harness:
    """Everything that the children share: plans, flown rows, the folders that stories begin with, the tables
    they should end with.
    """

    def __init__(self, folder: Path):
        os.chdir(folder)
        self.file = write_drop(folder)
        self.plans = {seed: load_plan(self.file, cases=CASES, seed=seed) for seed in SEEDS}
        flown = {seed: CaseRunner(plan.loaded).fly(list(plan.cases())) for seed, plan in self.plans.items()}
        for plan in self.plans.values():
            table_of(flown[plan.campaign.seed]), source_hash(), plan.text  # there for all children
        campaign_api.load_plan = lambda file, sets, cases, seed, sampling: self.plans[seed or SEEDS[0]]
        self._use(Recorded(flown, stops=True))
        for seed in SEEDS:
            assert (
                in_child(lambda seed=seed: command(self.file, seed=seed, force=True))[1]["status"]
                == INTERRUPTED
            )
            shutil.copytree("runs", f"unfinished-{seed}")
        self._use(Recorded(flown))
        self.tables = {}
        for seed in SEEDS:
            assert in_child(lambda seed=seed: command(self.file, seed=seed, force=True))[1]["status"] == 0
            self.tables[seed] = (RUN / "cases.parquet").read_bytes()
            shutil.copytree("runs", f"complete-{seed}")
        read()  # what a report loads is there for all children too
        self.known: dict[Folder, dict[str, Any]] = {}
        gc.freeze()

    def _use(self, engine: Recorded) -> None:
        campaign_api.chosen_engine = lambda *_: contextlib.nullcontext(engine)

    def table(self) -> str:
        """Which table lies in the folder now."""
        found = (RUN / "cases.parquet").read_bytes()
        return next((f"seed {seed}" for seed, table in self.tables.items() if table == found), "another")

    def stories(self) -> dict[str, tuple[str | None, Callable[[], dict[str, Any]]]]:
        """Folder that is there before, and what is done."""
        first, other = SEEDS
        return {
            "new": (None, lambda: command(self.file)),
            "resume": (f"unfinished-{first}", resumed),
            "force": (f"complete-{other}", lambda: command(self.file, force=True)),
            "force_unfinished": (f"unfinished-{other}", lambda: command(self.file, force=True)),
        }

    def operations(self, story: str) -> list[str]:
        """The durable operations of a story that nothing disturbs."""
        before, work = self.stories()[story]
        self._lay_out(before)
        return unnumbered(in_child(lambda: (faults := Faults(0, "")) and work() and faults.seen)[1])

    def own_operations(self, story: str) -> list[str]:
        """Those of them that a new campaign has not: a forced one clears the folder, and is a new one."""
        found = self.operations(story)
        if not story.startswith("force"):
            return found
        new, first = self.operations("new"), "open runs/drops/.campaign.json.part"
        own, shared = found.index(first), new[new.index(first) :]
        assert found[own:] == shared[: len(found) - own]
        return found[: own + 1]

    def tried(self, story: str, number: int, fault: str) -> dict[str, Any]:
        """One fault, and what follows."""
        before, work = self.stories()[story]
        self._lay_out(before)
        status, ended = in_child(lambda: Faults(number, fault) and work())
        left = left_over()
        if left not in self.known:
            self.known[left] = self._what_follows()
        return {"exit": status, "ended": ended, **self.known[left]}

    def _what_follows(self) -> dict[str, Any]:
        said = in_child(read)[1]
        again = in_child(resumed)[1]
        if again.get("status") == 2:
            again = {"resume": again["err"], **in_child(lambda: command(self.file, force=RUN.exists()))[1]}
        return {"readers": said, "again": again, "table": self.table(), "left": sorted(os.listdir(RUN))}

    def _lay_out(self, before: str | None) -> None:
        shutil.rmtree("runs", ignore_errors=True)
        if before is not None:
            shutil.copytree(before, "runs")


def main(folder: str, *stories: str) -> None:
    """Try every operation of each story."""
    harness = Harness(Path(folder))
    for case in stories:
        story, fault, every = case.split(":")
        operations = list(enumerate(harness.own_operations(story), start=1))
        for number, operation in operations[:: int(every)]:
            tried = {"case": case, "operation": operation, **harness.tried(story, number, fault)}
            print(json.dumps(tried), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
