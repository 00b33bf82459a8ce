"""``edl6dof fly``: exit status, output, run folder."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest
from cli_run import SHORT, hidden, run, spawn

import edl6dof
from edl6dof.report.terminal import stated_figures

QUICK = ("--no-replay",)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drop.yaml").write_text(SHORT)
    return tmp_path


def test_nominal_lands_within_limits_with_status_0(nominal, here, capsys, monkeypatch):
    """The shared flight comes first: a cold compile cache would add its notice."""
    code, out, err = run(capsys, monkeypatch, "fly", "tianwen1", *QUICK)
    assert (code, err) == (0, "")
    outcome, *files = lines = out.splitlines()
    assert outcome.startswith("tianwen1: landed within limits (at t = ")
    assert files == [
        "runs/tianwen1: events.json, scenario.yaml, summary.json, telemetry.parquet",
        "next: edl6dof report runs/tianwen1, edl6dof replay runs/tianwen1",
    ]
    assert max(map(len, lines)) <= 80


TABLES = ["Limits", "Timeline", "Comparison with the published flight", "Navigation"]


@pytest.mark.parametrize("words, published", [((), True), (("--set", "seed=2"), False)])
def test_tables_follow_the_outcome(words, published, here, capsys, monkeypatch):
    """The published flight is that of the scenario as it stands."""
    code, out, _ = run(capsys, monkeypatch, "fly", "tianwen1", "-v", *words, *QUICK)
    lines = [line.rstrip() for line in out.splitlines()]
    assert lines[0].startswith("tianwen1: landed ") and max(map(len, lines)) <= 80
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f]", out), "control characters"
    assert [line for line in lines if line in TABLES] == [
        title for title in TABLES if published or "published" not in title
    ]


def test_a_scenario_that_extends_another_has_the_published_figures_of_its_own_file(here):
    (here / "mine.yaml").write_text("extends: tianwen1\npublished: {parachute_mach: 1.9}\n")
    assert list(stated_figures(edl6dof.load("mine.yaml"))) == ["parachute_mach"]
    assert len(stated_figures(edl6dof.load("tianwen1"))) > 20
    assert not stated_figures(edl6dof.load("tianwen1_hazards"))


def test_missed_limit_is_status_1_and_is_named(here, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "fly", "tianwen1", "--set", "limits.landing_distance_m=1", *QUICK)
    assert code == 1
    lines = [line.rstrip() for line in out.splitlines()]
    assert lines[0].startswith("tianwen1: landed outside limits (distance from the landing site)")
    assert lines[1] == "Violated limits"
    (row,) = lines[5:-3]
    assert row.lstrip().startswith("distance from the landing site") and row.endswith("violated")
    assert json.loads(Path("runs/tianwen1/summary.json").read_text())["success"] is False


def test_flight_that_does_not_land_is_status_1(here, capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK)
    assert code == 1
    assert out.startswith("drop: ")


def test_quiet_prints_one_line(here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--quiet", *QUICK)
    assert (code, err) == (1, "")
    assert len(out.splitlines()) == 1
    assert out.startswith("drop: ")


def test_json_is_the_summary(here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--json", *QUICK)
    assert (code, err) == (1, "")
    assert out == Path("runs/drop/summary.json").read_text()
    assert json.loads(out)["name"] == "drop"


def test_default_folder_that_is_taken_gets_a_number(here, capsys, monkeypatch):
    for said in (
        "",
        "runs/drop exists; this goes to runs/drop-2\n",
        "runs/drop exists; this goes to runs/drop-3\n",
    ):
        code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK, "--quiet")
        assert (code, err) == (1, said)
    assert sorted(path.name for path in Path("runs").iterdir()) == ["drop", "drop-2", "drop-3"]
    assert run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK, "--quiet", "--force")[0] == 1
    assert len(list(Path("runs").iterdir())) == 3


def test_overwriting_needs_force(here, capsys, monkeypatch):
    assert run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK)[0] == 1
    before = Path("runs/drop/summary.json").stat().st_mtime_ns
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--out", "runs/drop", *QUICK)
    assert (code, out) == (2, "")
    assert err == "runs/drop: exists; choose another folder with --out, or replace it with --force\n"
    assert Path("runs/drop/summary.json").stat().st_mtime_ns == before
    Path("runs/drop/notes.txt").write_text("mine")
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--force", *QUICK)
    assert (code, out) == (2, "")
    assert err == (
        "runs/drop: holds notes.txt, which edl6dof did not write; it is not replaced, even with --force\n"
    )
    assert Path("runs/drop/notes.txt").read_text() == "mine"
    Path("runs/drop/notes.txt").unlink()
    assert run(capsys, monkeypatch, "fly", "drop.yaml", "--force", *QUICK)[0] == 1
    assert sorted(os.listdir("runs/drop")) == [
        "events.json",
        "manifest.json",
        "scenario.yaml",
        "summary.json",
        "telemetry.parquet",
    ]
    assert not hidden(here / "runs")


def test_force_never_replaces_what_is_no_run_folder(here, capsys, monkeypatch):
    (here / "precious").mkdir()
    (here / "precious" / "thesis.tex").write_text("years of work")
    code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--out", "precious", "--force", *QUICK)
    assert code == 2
    assert "precious: is no result of 'edl6dof fly'" in err
    code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--out", "drop.yaml", "--force", *QUICK)
    assert code == 2
    assert "is a file" in err
    code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--out", ".", "--force", *QUICK)
    assert code == 2
    assert (here / "precious" / "thesis.tex").read_text() == "years of work"
    assert (here / "drop.yaml").read_text() == SHORT


def test_empty_folder_and_linked_folder_are_taken(here, capsys, monkeypatch):
    (here / "real").mkdir()
    (here / "link").symlink_to("real")
    assert run(capsys, monkeypatch, "fly", "drop.yaml", "--out", "link", *QUICK)[0] == 1
    assert (here / "real" / "summary.json").is_file()
    assert run(capsys, monkeypatch, "fly", "drop.yaml", "--out", "link", "--force", *QUICK)[0] == 1
    assert (here / "link").is_symlink()
    assert (here / "real" / "summary.json").is_file()


@pytest.mark.parametrize("time", ["-1", "nan", "inf"])
def test_save_state_needs_a_time(time, here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--save-state", time, *QUICK)
    assert (code, out) == (2, "")
    assert err.startswith("--save-state: must be a time in s")
    assert not Path("runs").exists()


def test_saved_state_is_continued(here, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--save-state", "0.2", "-q", *QUICK)
    assert (code, err) == (1, "")
    assert (
        run(capsys, monkeypatch, "fly", "--from", "runs/drop/state.npz", "--out", "again", "-q", *QUICK)[0]
        == 1
    )
    first, again = (json.loads(Path(name, "summary.json").read_text()) for name in ("runs/drop", "again"))
    assert again["time_s"] == first["time_s"]


def test_state_that_was_never_reached_is_said(here, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--save-state", "99", "-q", *QUICK)
    assert code == 1
    assert err.startswith("--save-state 99: no state was saved")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fly"], "name a scenario"),
        (["fly", "drop.yaml", "--from", "x.npz"], "give no other"),
        (["fly", "--from", "none.npz"], "none.npz: cannot be read: No such file"),
        (["fly", "--from", "drop.yaml"], "is not a state saved by"),
        (["fly", "--from", "."], "cannot be read: Is a directory"),
        (["replay", "nowhere"], "no such replay"),
    ],
)
def test_wrong_requests_are_one_line_and_status_2(words, said, here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, *words)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert not Path("runs").exists()


@pytest.mark.parametrize("place", ["drop.yaml/run", "/proc/edl6dof/run", "x" * 300, "/dev/null/run"])
def test_place_that_cannot_be_written(place, here, capsys, monkeypatch):
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", "--out", place, *QUICK)
    assert (code, out) == (2, "")
    assert "cannot be written: " in err
    assert len(err.splitlines()) == 1
    assert os.listdir(here) == ["drop.yaml"]


def test_full_disk_leaves_nothing(here, capsys, monkeypatch):
    from edl6dof.runs import run as run_folder

    def full(flight, path):
        path.write_bytes(b"half")
        raise OSError("[Errno 28] Error writing bytes to file.\nDetail: No space left on device")

    monkeypatch.setattr(run_folder, "write_telemetry", full)
    code, out, err = run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK)
    assert (code, out) == (2, "")
    assert "runs/drop: cannot be written: " in err
    assert "No space left on device" in err
    assert len(err.splitlines()) == 1
    assert os.listdir(here) == ["drop.yaml"]


def test_full_disk_keeps_the_former_run(here, capsys, monkeypatch):
    from edl6dof.runs import run as run_folder

    run(capsys, monkeypatch, "fly", "drop.yaml", *QUICK)
    before = Path("runs/drop/summary.json").read_text()

    def full(flight, path):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(run_folder, "write_telemetry", full)
    assert run(capsys, monkeypatch, "fly", "drop.yaml", "--force", *QUICK)[0] == 2
    assert Path("runs/drop/summary.json").read_text() == before
    assert not hidden(here / "runs")


def test_closed_pipe_is_no_traceback(here):
    done = spawn(["params"], here)
    done.stdout.readline()
    done.stdout.close()
    assert "Traceback" not in done.stderr.read()
    done.wait(timeout=30)
