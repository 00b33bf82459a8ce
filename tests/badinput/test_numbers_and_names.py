"""Numbers that no counter holds, and names that no file system keeps, are refused in one line; nothing is
written.
"""

from __future__ import annotations

import sys

import in_process
import pytest

from edl6dof.cli import studies as study

HUGE = "99999999999999999999"
LONGEST = "x" * 150


def ended(monkeypatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["edl6dof", *words])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    return end.value.code


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["campaign", "tianwen1_mc", "-n", HUGE],
            f"--cases: campaign.cases: must be >= 1 and <= 10000000 (got {HUGE})",
        ),
        (
            ["campaign", "tianwen1_mc", "-n", "10000001"],
            "--cases: campaign.cases: must be >= 1 and <= 10000000 (got 10000001)",
        ),
        (
            ["campaign", "tianwen1_mc", "--seed", HUGE],
            f"--seed: campaign.seed: must be >= 0 and <= 9223372036854775807 (got {HUGE})",
        ),
        (["study", "guidance", "-n", HUGE], f"-n {HUGE}: must be 1 to {study.MOST_RUNS}"),
        (
            ["fly", "tianwen1", "--set", f"seed={HUGE}"],
            f"seed: must be >= 0 and <= 9223372036854775807 (got {HUGE})",
        ),
        (
            ["fly", "tianwen1", "--set", f"profile={HUGE}"],
            f"profile: must be >= 0 and <= 9223372036854775807 (got {HUGE})",
        ),
        (
            ["fly", "tianwen1", "--set", f"name={LONGEST}x"],
            "name: must do as a folder name: at most 150 bytes (got 151)",
        ),
        (
            ["fly", "tianwen1", "--set", f"name={'é' * 76}"],
            "name: must do as a folder name: at most 150 bytes (got 152)",
        ),
        *(
            (["fly", "tianwen1", "--set", f'name="{name}"'], "name: must do as a folder name")
            for name in ("a/b", ".a", "a.", " a", "a\\0b", "a\\nb", "..")
        ),
    ],
)
def test_refused(words, said, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert ended(monkeypatch, *words) == 2
    out, err = capsys.readouterr()
    assert said in err and out == ""
    assert len(err.splitlines()) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [["campaign", "tianwen1_mc"], ["faults"]])
def test_more_threads_than_any_machine_has_are_refused(command, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert ended(monkeypatch, *command, "--workers", HUGE) == 2
    assert "1024" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_longest_name_makes_a_run_folder(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    words = ["fly", "nesc/case01", "-q", "--set", f"name={LONGEST}", "--set", "simulation.time_limit_s=1"]
    assert ended(monkeypatch, *words) == 0
    assert (tmp_path / "runs" / LONGEST / "summary.json").is_file()
