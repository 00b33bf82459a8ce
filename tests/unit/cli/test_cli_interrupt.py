"""A run that is interrupted or killed leaves a complete result or none, and the next run cleans up."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from cli_run import SHORT, hidden, run, spawn

from edl6dof.config.errors import ConfigError
from edl6dof.manifest import seal
from edl6dof.runs import files as run_files
from edl6dof.runs.files import atomic_folder

#: About ten seconds of computing, in chunks of a fraction of a second.
SLOW = [
    "fly",
    "tianwen1",
    "--set",
    "simulation.step_s=0.0002",
    "--set",
    "simulation.log_every=1000",
    "--no-replay",
    "-q",
]


def wait_for_hidden(folder: Path, process) -> None:
    end = time.monotonic() + 60.0
    while not (folder.is_dir() and hidden(folder)):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < end
        time.sleep(0.005)


def test_interrupt_leaves_nothing(tmp_path):
    process = spawn(SLOW, tmp_path)
    wait_for_hidden(tmp_path / "runs", process)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (130, "")
    assert err == "interrupted; nothing was written\n"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(signal.SIGKILL, marks=pytest.mark.long),
        pytest.param(signal.SIGTERM, marks=pytest.mark.long),
    ],
)
def test_kill_leaves_no_result_and_the_next_run_cleans_up(number, tmp_path, capsys, monkeypatch):
    process = spawn([*SLOW, "--out", "runs/drop"], tmp_path)
    wait_for_hidden(tmp_path / "runs", process)
    process.send_signal(number)
    process.communicate(timeout=30)
    assert process.returncode != 0
    assert not (tmp_path / "runs" / "drop").exists()
    monkeypatch.chdir(tmp_path)
    Path("drop.yaml").write_text(SHORT)
    assert run(capsys, monkeypatch, "fly", "drop.yaml", "--no-replay", "-q")[0] == 1
    assert os.listdir("runs") == ["drop"]
    assert (tmp_path / "runs" / "drop" / "summary.json").is_file()


def test_run_of_a_living_process_is_left_alone(tmp_path, monkeypatch):
    target = tmp_path / "run"
    other = tmp_path / f".run.{os.getppid()}-{run_files._host()}.part"
    other.mkdir()
    with atomic_folder(target, "flight", force=False) as folder:
        (folder / "summary.json").write_text("{}")
    assert other.is_dir()
    assert (target / "summary.json").is_file()


def test_folder_of_another_host_goes_only_when_it_is_old(tmp_path):
    fresh, old = tmp_path / ".run.1-elsewhere.part", tmp_path / ".run.2-elsewhere.part"
    fresh.mkdir()
    old.mkdir()
    os.utime(old, (1e9, 1e9))
    with atomic_folder(tmp_path / "run", "flight", force=False):
        pass
    assert hidden(tmp_path) == [fresh.name]


def test_names_with_dots_and_brackets(tmp_path):
    for name in ("v1.2", "a[b]", "x y"):
        dead = tmp_path / f".{name}.{2**22 + 1}-{run_files._host()}.part"
        dead.mkdir()
        with atomic_folder(tmp_path / name, "flight", force=False) as folder:
            (folder / "summary.json").write_text("{}")
        assert not dead.exists()
        assert (tmp_path / name / "summary.json").is_file()


def test_neighbours_leftovers_are_not_touched(tmp_path):
    other = tmp_path / f".run.more.{2**22 + 1}-{run_files._host()}.part"
    other.mkdir()
    user = tmp_path / ".run.backup.tar"
    user.mkdir()
    with atomic_folder(tmp_path / "run", "flight", force=False):
        pass
    assert user.is_dir()


def test_kill_between_the_two_renames_brings_the_former_run_back(tmp_path):
    target, aside = tmp_path / "run", tmp_path / f".run.{2**22 + 1}-{run_files._host()}.old"
    aside.mkdir()
    (aside / "summary.json").write_text("former")
    seal(aside, "flight")
    with pytest.raises(ConfigError), atomic_folder(target, "flight", force=False):
        pass
    assert (target / "summary.json").read_text() == "former"
    with atomic_folder(target, "flight", force=True) as folder:
        (folder / "summary.json").write_text("new")
    assert (target / "summary.json").read_text() == "new"
    assert not hidden(tmp_path)


def test_failing_second_rename_restores_the_former_run(tmp_path, monkeypatch):
    target = tmp_path / "run"
    target.mkdir()
    (target / "summary.json").write_text("former")
    seal(target, "flight")

    def failing(partial, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(run_files, "put_in_place", failing)
    with pytest.raises(KeyboardInterrupt), atomic_folder(target, "flight", force=True) as folder:
        (folder / "summary.json").write_text("new")
    assert (target / "summary.json").read_text() == "former"
    assert not hidden(tmp_path)


def test_result_that_appeared_meanwhile_is_not_replaced(tmp_path):
    target = tmp_path / "run"
    with pytest.raises(ConfigError), atomic_folder(target, "flight", force=False) as folder:
        (folder / "summary.json").write_text("late")
        target.mkdir()
        (target / "summary.json").write_text("first")
    assert (target / "summary.json").read_text() == "first"
    assert not hidden(tmp_path)


def test_exception_removes_the_folders_made_for_it(tmp_path):
    with pytest.raises(ZeroDivisionError), atomic_folder(tmp_path / "a" / "b" / "run", "flight", force=False):
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
