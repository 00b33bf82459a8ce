"""A folder that came from somebody else: looking at it runs no code of it, and flying it again asks first."""

from __future__ import annotations

import os
import py_compile
import re
import shutil
import sys
from pathlib import Path

import pytest
from command import SHORT, VIEWERS, finished, refused, viewing
from in_process import called

from edl6dof.kernels import cache
from edl6dof.manifest import hash_of, seal

#: A law that leaves a trace when it is merely loaded.
LAW = """
from pathlib import Path
from edl6dof.config.base import Params
from edl6dof.kernels import kernel
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
    assert refused(done) and "edl6dof trust" in done.stderr and "law.py" in done.stderr
    assert not ran(sent)
    done = called("trust", received / "scenario.yaml", "--yes", cwd=tmp_path)
    assert done.returncode == 0 and "return 0.5" in done.stdout and not ran(sent), "its source, shown"
    assert finished(*again, cwd=tmp_path).returncode == 0
    assert ran(sent)
    (sent / "RAN").unlink()
    original = (sent / "law.py").read_text()
    try:
        (sent / "law.py").write_text(original.replace("0.5", "0.6"))
        done = called(*again, cwd=tmp_path)
        assert refused(done) and "edl6dof trust" in done.stderr
        assert not ran(sent)
    finally:
        (sent / "law.py").write_text(original)


def test_trust_without_an_answer_accepts_nothing(sent, tmp_path):
    done = finished("trust", sent / "law.py", cwd=tmp_path)
    assert done.returncode == 1 and "not accepted" in done.stdout
    assert refused(called("check", sent / "sent" / "scenario.yaml", cwd=tmp_path))
    assert not ran(sent)


def test_source_that_would_hide_itself_is_shown_with_its_escapes(tmp_path):
    (tmp_path / "law.py").write_text('HIDDEN = 1\x1b[1A\x1b[2K\n"\u202e"\n')
    shown = called("trust", tmp_path / "law.py", "--yes", cwd=tmp_path).stdout
    assert "\x1b" not in shown and "\u202e" not in shown
    assert r"HIDDEN = 1\x1b[1A\x1b[2K" in shown and r"\u202e" in shown


def _extends_a_subfolder(home: Path, law: Path) -> Path:
    """A run folder, with its manifest, whose scenario gets the plugin from a file below."""
    (home / "base").mkdir()
    shutil.copy(law, home / "base" / "law.py")
    (home / "base" / "mission.yaml").write_text(SCENARIO.format("law.py"))
    (home / "scenario.yaml").write_text("extends: base/mission.yaml\nname: theirs\n")
    seal(home, "flight")
    return home / "scenario.yaml"


def _without_a_manifest(home: Path, law: Path) -> Path:
    shutil.copy(law, home / "law.py")
    (home / "scenario.yaml").write_text(SCENARIO.format("law.py"))
    return home / "scenario.yaml"


def _below_a_run_folder(home: Path, law: Path) -> Path:
    _extends_a_subfolder(home, law)
    return home / "base" / "mission.yaml"


def _campaign_of_a_scenario(home: Path, law: Path) -> Path:
    _without_a_manifest(home, law)
    (home / "campaign.yaml").write_text("extends: scenario.yaml\ncampaign: {runs: 2, seed: 1}\n")
    return home / "campaign.yaml"


ATTACKS = (_extends_a_subfolder, _without_a_manifest, _below_a_run_folder, _campaign_of_a_scenario)


@pytest.mark.parametrize("attack", ATTACKS)
@pytest.mark.parametrize("command", ["check", "fly"])
def test_no_command_runs_a_plugin_without_consent_wherever_it_lies(command, attack, sent, tmp_path):
    if command == "fly" and attack is _campaign_of_a_scenario:
        command = "campaign"
    scenario = attack(tmp_path, sent / "law.py")
    done = called(command, scenario, cwd=tmp_path)
    assert refused(done) and "edl6dof trust" in done.stderr, done.stderr
    assert not list(tmp_path.rglob("RAN"))


def test_what_was_accepted_is_what_runs(sent, tmp_path):
    """Byte code beside an accepted plugin, as Python would load it unchecked, takes no part."""
    scenario = _without_a_manifest(tmp_path, sent / "law.py")
    law = tmp_path / "law.py"
    (tmp_path / "other.py").write_text(f"open({str(tmp_path / 'OTHER')!r}, 'w')\n" + LAW)
    (tmp_path / "__pycache__").mkdir()
    compiled = tmp_path / "__pycache__" / f"law.{sys.implementation.cache_tag}.pyc"
    py_compile.compile(
        str(tmp_path / "other.py"),
        str(compiled),
        invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH,
    )
    assert called("trust", law, "--yes", cwd=tmp_path).returncode == 0
    assert finished("check", scenario, cwd=tmp_path).returncode == 0
    assert (tmp_path / "RAN").exists() and not (tmp_path / "OTHER").exists()


def test_environment_is_no_consent(sent, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(sent / "law.py", tmp_path / "law.py")
    monkeypatch.setenv("EDL6DOF_PLUGINS", "law.py")
    done = called("check", "tianwen1")
    assert refused(done) and "edl6dof trust law.py" in done.stderr
    assert not (tmp_path / "RAN").exists()


def test_comment_that_would_be_code_in_another_coding_stays_a_comment(sent, tmp_path):
    """In UTF-7, ``+AAo-`` is the end of a line."""
    scenario = _without_a_manifest(tmp_path, sent / "law.py")
    hidden = f"# see +AAo-open({str(tmp_path / 'OTHER')!r}, 'w')\n"
    (tmp_path / "law.py").write_text("# coding: utf-7\n" + hidden + LAW)
    assert called("trust", tmp_path / "law.py", "--yes", cwd=tmp_path).returncode == 0
    assert finished("check", scenario, cwd=tmp_path).returncode == 0
    assert (tmp_path / "RAN").exists() and not (tmp_path / "OTHER").exists()


@pytest.mark.parametrize("end", ["\n", "\x85", "\u2028"])
def test_name_of_an_accepted_file_accepts_no_other(end, sent, tmp_path):
    """A line break in a name would begin another line of the list."""
    scenario = _without_a_manifest(tmp_path, sent / "law.py")
    named = tmp_path / f"harmless{end}{hash_of(tmp_path / 'law.py')}  .py"
    named.write_text("x = 1\n")
    assert called("trust", named, "--yes", cwd=tmp_path).returncode == 0
    done = called("check", scenario, cwd=tmp_path)
    assert refused(done) and not (tmp_path / "RAN").exists()


@pytest.mark.parametrize("content", ["too large", "no text", "a pipe"])
def test_file_that_is_no_source_is_refused(content, sent, tmp_path):
    scenario = _without_a_manifest(tmp_path, sent / "law.py")
    law = tmp_path / "law.py"
    if content == "a pipe":
        law.unlink()
        os.mkfifo(law)
    elif content == "no text":
        law.write_bytes(b"x = '\xff'\n")
    else:
        os.truncate(law, 1 << 40)  # of zeros, which take no room
    for words in (("trust", law, "--yes"), ("check", scenario)):
        assert refused(called(*words, cwd=tmp_path))


def test_plugin_changed_after_it_was_read_has_the_machine_code_of_what_was_read(sent, tmp_path, monkeypatch):
    """Its code is kept under the content that runs, not under the one that the file has by then."""
    law = tmp_path / "law.py"
    law.write_text(LAW)
    monkeypatch.setattr(cache, "received", {})
    stamp = cache.stamp.__wrapped__
    os.utime(law, (1e9, 1e9))
    before = stamp(str(law))
    cache.receive(law, LAW.encode(), in_loop=False)
    law.write_text(LAW.replace("0.5", "0.6"))
    os.utime(law, (1e9, 1e9))
    assert stamp(str(law)) == before
    cache.received.clear()
    assert before and stamp(str(law)) != before


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
