"""Each way to end has a status of its own; 1 never means that the program itself went wrong."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from command import PROGRAM, ROOT, SHORT
from in_process import called

from edl6dof.cli import group


def test_a_defect_of_the_program_is_status_70_and_says_so(tmp_path):
    broken = (
        "import edl6dof.cli.inspection as p; p.show_params = lambda *a: 1 / 0; from edl6dof.cli import main; "
        "main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", broken, "params"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT)},
        timeout=60,
    )
    assert done.returncode == group.DEFECT == 70
    assert "ZeroDivisionError" in done.stderr and done.stderr.rstrip().endswith(
        "please report it with these lines"
    )


def test_status_1_is_a_flight_outside_its_limits(tmp_path):
    assert (
        called("fly", *SHORT, "--out", tmp_path / "run", "-q", "--no-replay").returncode
        == group.NOT_WITHIN_LIMITS
        == 1
    )


def test_reader_that_stops_reading_is_no_failure(tmp_path):
    done = called("params", "--json")
    assert done.returncode == 0 and len(done.stdout) > 100_000
    line = " ".join(f"'{word}'" for word in [*PROGRAM, "params", "--json"])
    script = f"{line} | head -1 >/dev/null; exit ${{PIPESTATUS[0]}}"
    piped = subprocess.run(
        ["bash", "-c", script],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        timeout=60,
    )
    assert piped.returncode == group.BROKEN_PIPE == 141
    assert piped.stderr == ""


@pytest.mark.parametrize("command", ["fly", "campaign", "faults", "study", "verify", "refly", "replay"])
def test_help_of_the_program_lists_every_status(command, capsys):
    text = " ".join(called("--help").stdout.split())
    for status in (
        "0 done",
        "1 not within limits",
        "2 bad input",
        "69 something",
        "70 a defect",
        "130 interrupted",
    ):
        assert status in text
    assert "Exit status" in called(command, "--help").stdout
