"""A folder that came from somebody else: looking at it runs no code of it, and flying it again asks first."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command import ROOT, SHORT, VIEWERS, finished, refused, viewing
from in_process import called

from edl6dof.manifest import seal

#: A law that leaves a trace when it is merely loaded.
LAW = """
from pathlib import Path
from edl6dof.config.base import Params
from edl6dof.jit import kernel
from edl6dof.registry import Member

Path(__file__).with_name("RAN").touch()

class MineParams(Params):
    "Mine."

@kernel
def guide(params, plan, onboard, nav, memory, out):
    "Mine."
    return 0.5

FAMILY = "entry_law"
MEMBER = Member("mine", MineParams, {"guide": guide}, "me, 2026")
"""

SCENARIO = """
extends: tianwen1
name: mine
plugins: [{}]
flight_software: {{guidance: {{entry: {{law: mine}}}}}}
"""


@pytest.fixture(scope="module")
def sent(tmp_path_factory) -> Path:
    """What a stranger sends: a run folder whose scenario names the law beside it."""
    home = tmp_path_factory.mktemp("stranger")
    (home / "law.py").write_text(LAW)
    assert called("fly", *SHORT, "--out", home / "sent", "-q").returncode == 1  # cut short: not landed
    text = (home / "sent" / "scenario.yaml").read_text()
    for old, new in (
        (r"^plugins: .*$", f"plugins: [{home / 'law.py'}]"),
        (r"law: drag_tracking", "law: mine"),
    ):
        text, count = re.subn(old, new, text, flags=re.MULTILINE)
        assert count == 1
    (home / "sent" / "scenario.yaml").write_text(text)
    seal(home / "sent", "flight")
    return home


@pytest.fixture
def received(sent, tmp_path, monkeypatch) -> Path:
    """The folder on the user's machine; the stranger's law lies at the very path that the scenario names."""
    (sent / "RAN").unlink(missing_ok=True)
    monkeypatch.chdir(tmp_path)
    shutil.copytree(sent / "sent", tmp_path / "received")
    return tmp_path / "received"


def ran(sent: Path) -> bool:
    return (sent / "RAN").exists()


@pytest.mark.parametrize(
    "viewer",
    [
        pytest.param(one, marks=pytest.mark.long if one in ("compare", "mat", "nesc") else ())
        for one in VIEWERS
    ],
)
def test_viewers_show_it_and_run_nothing(viewer, sent, received, tmp_path):
    done = called(*viewing(viewer, received, tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    assert not ran(sent)


def test_flying_it_again_asks_once_and_is_remembered_until_the_law_changes(sent, received, tmp_path):
    again = ("check", received / "scenario.yaml")
    done = called(*again, cwd=tmp_path)
    assert refused(done) and "--trust" in done.stderr and "law.py" in done.stderr
    assert not ran(sent)
    assert finished(*again, "--trust", cwd=tmp_path).returncode == 0
    assert ran(sent)
    (sent / "RAN").unlink()
    assert finished(*again, cwd=tmp_path).returncode == 0, "accepted before"
    assert ran(sent)
    (sent / "RAN").unlink()
    original = (sent / "law.py").read_text()
    try:
        (sent / "law.py").write_text(original.replace("0.5", "0.6"))
        done = called(*again, cwd=tmp_path)
        assert refused(done) and "--trust" in done.stderr
        assert not ran(sent)
    finally:
        (sent / "law.py").write_text(original)


def test_ones_own_scenario_is_flown_without_asking_and_so_is_its_run(sent, tmp_path):
    (tmp_path / "mine.yaml").write_text(SCENARIO.format(sent / "law.py"))
    files = ("mine.yaml", str(sent / "sent" / "scenario.yaml"))
    program = f"from in_process import called\nprint([called('check', file).returncode for file in {files}])"
    folders = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": folders},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stdout == "[0, 0]\n", done.stderr


@pytest.mark.parametrize(
    "command", ["report", "plot", "export", "compare", "replay", "verify", "version", "params"]
)
def test_folder_or_file_named_like_a_command_is_no_scenario(command, sent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (sent / "RAN").unlink(missing_ok=True)
    (tmp_path / command).mkdir()
    for name in ("scenario.yaml", "campaign.yaml"):
        (tmp_path / command / name).write_text(f"name: x\nplugins: [{sent / 'law.py'}]\n")
    (tmp_path / f"{command}.yaml").write_text(f"name: x\nplugins: [{sent / 'law.py'}]\n")
    called(command, "--help")
    called(command, command, command)
    assert not ran(sent)


@pytest.mark.parametrize(
    "words",
    [("refly", "evil", "0"), ("campaign", "evil", "--resume"), ("campaign", "evil"), ("replay", "evil")],
)
@pytest.mark.parametrize("mark", ["campaign.json", None])
def test_campaign_folder_asks_before_it_flies(words, mark, sent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (sent / "RAN").unlink(missing_ok=True)
    (tmp_path / "evil").mkdir()
    (tmp_path / "evil" / "campaign.yaml").write_text(f"name: x\nplugins: [{sent / 'law.py'}]\n")
    if mark:
        (tmp_path / "evil" / mark).write_text("{}")
    assert refused(called(*words))
    assert not ran(sent)


def test_recording_with_words_of_a_scenario_in_it_is_no_scenario(sent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (sent / "RAN").unlink(missing_ok=True)
    (tmp_path / "evil.rrd").write_text(f"name: x\nplugins: [{sent / 'law.py'}]\n")
    called("replay", "evil.rrd", "--html", "out.html")
    assert not ran(sent)
