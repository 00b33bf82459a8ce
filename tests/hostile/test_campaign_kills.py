"""A campaign that dies, or meets a full or broken disk, at any of its durable operations: the next attempt
gives the same table.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
COMPLETE = ["campaign.json", "campaign.yaml", "cases.parquet", "summary.json"]


#: What the campaign does, what happens to it, and at least how many operations that meets.
STORIES = {
    "new:before": 50,
    "new:ENOSPC": 50,
    "resume:EIO": 20,
    "force:before": 5,
    "force_unfinished:after": 5,
}

#: Of these the suite tries some operations, spread over all: one of so many.
EVERY = {"new:before": 12, "resume:EIO": 8, "force_unfinished:after": 5}


@pytest.fixture(scope="module")
def tried(request, tmp_path_factory) -> list[dict]:
    """Every story that is asked for, told by one program."""
    asked = [item.callspec.params["case"] for item in request.session.items if item.path.samefile(__file__)]
    words = [
        sys.executable,
        str(HERE / "campaign_faults.py"),
        str(tmp_path_factory.mktemp("kills")),
        *asked,
    ]
    environment = {**os.environ, "PYTHONPATH": str(HERE.parents[1])}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize(
    "case",
    [f"{story}:{every}" for story, every in EVERY.items()]
    + [pytest.param(f"{story}:1", marks=pytest.mark.long) for story in STORIES],
)
def test_fault_at_a_durable_operation(tried, case):
    """Status, words, readers, and the table of the next attempt, byte for byte."""
    story, fault, every = case.split(":")
    attempts = [one for one in tried if one["case"] == case]
    assert len(attempts) >= STORIES[f"{story}:{fault}"] // int(every), "the harness sees the operations"
    for one in attempts:
        where = one["operation"]
        if fault in ("before", "after"):
            assert one["exit"] == 77 and one["ended"] is None, where
        else:
            check_ending(one["ended"], where)
        assert "uncaught" not in one["readers"], (where, one["readers"])
        check_readers(one["readers"], where)
        check_next(one, story, where)


def check_ending(ended: dict, where: str) -> None:
    """An error becomes one line and status 2; what is only tidied up may fail."""
    assert "uncaught" not in ended, (where, ended)
    tidied_up = where.startswith("rmdir ") or where.endswith("/.lock")
    assert ended["status"] == 2 or (ended["status"] == 0 and tidied_up), (where, ended)
    if ended["status"] == 2:
        said = ended["err"]
        ways = (
            "nothing was written",
            "go on with: edl6dof campaign runs/drops --resume",
            "begin it anew with --force",
        )
        assert len(said.splitlines()) == 1 and any(way in said for way in ways), (where, said)


def check_readers(readers: dict[str, str], where: str) -> None:
    """Rows of whole parts, or a message."""
    table, report = readers["table"], readers["report"]
    assert table.startswith("message: runs/drops") or table in ("50", "70"), (where, table)
    assert report.startswith("message: runs/drops") == table.startswith("message: "), (where, report)


def check_next(one: dict, story: str, where: str) -> None:
    """``--resume`` completes what was begun; where nothing was, it says so and a new campaign gives the
    table.
    """
    again = one["again"]
    assert again.get("status") == 0 and one["left"] == COMPLETE, (where, again, one["left"])
    untouched = story.startswith("force") and "resume" not in again and one["table"] == "seed 9"
    assert untouched and one["readers"]["table"] in ("70", "50") or one["table"] == "seed 3", (
        where,
        one["table"],
    )
