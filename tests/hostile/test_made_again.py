"""What is made from a result is made again without asking; a file of the user's own is kept."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from command import SHORT, refused
from in_process import called

from edl6dof.manifest import MADE

#: A command, and the file that it writes.
COMMANDS = {
    "report": (("report", "run"), "run/report.html"),
    "plot": (("plot", "run", "truth.mach"), "run/plots/truth.mach.html"),
    "picture": (("plot", "run", "truth.mach", "--out", "mach.png"), "mach.png"),
    "compare": (("compare", "run", "run"), "run/compared-with-run.html"),
    "csv": (("export", "run", "--format", "csv"), "run/telemetry.csv"),
    "oem": (("export", "run", "orbit.oem", "--format", "oem"), "orbit.oem"),
    "replay": (("replay", "run", "--html", "replay.html"), "replay.html"),
}


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> Path:
    home = tmp_path_factory.mktemp("flown")
    assert called("fly", *SHORT, "--out", home / "run", "-q").returncode == 1
    return home / "run"


@pytest.fixture
def home(flown, tmp_path) -> Path:
    shutil.copytree(flown, tmp_path / "run")
    return tmp_path


@pytest.mark.parametrize(
    "words, name",
    [
        pytest.param(*made, id=key, marks=pytest.mark.long if key in ("compare", "replay", "picture") else ())
        for key, made in COMMANDS.items()
    ],
)
def test_a_second_pass_makes_it_again_unless_it_is_the_users(home, words, name):
    def outcome():
        return called(*words, cwd=home)

    assert outcome().returncode == 0
    age = (home / name).stat().st_ino
    assert outcome().returncode == 0
    assert (home / name).stat().st_ino != age, "made anew"
    edited = (home / name).read_bytes() + b"\nmy remark"
    (home / name).write_bytes(edited)
    done = outcome()
    assert refused(done) and "byte for byte, what was made of this result" in done.stderr
    assert (home / name).read_bytes() == edited


def test_what_another_result_was_made_into_is_kept(home):
    shutil.copytree(home / "run", home / "other")
    assert called("export", "run", "x.csv", "--format", "csv", cwd=home).returncode == 0
    done = called("export", "other", "x.csv", "--format", "csv", cwd=home)
    assert refused(done) and "made of this result" in done.stderr


def test_a_file_that_was_there_before_is_kept(home):
    (home / "run" / "report.html").write_text("mine")
    assert refused(called("report", "run", cwd=home))
    assert (home / "run" / "report.html").read_text() == "mine"


def test_a_link_to_what_was_made_is_kept(home):
    assert called("export", "run", "a.csv", "--format", "csv", cwd=home).returncode == 0
    (home / "b.csv").symlink_to(home / "a.csv")
    assert refused(called("export", "run", "b.csv", "--format", "csv", cwd=home))
    assert (home / "b.csv").is_symlink()


@pytest.mark.parametrize("text", ["{}", "[[[[", "[1, null]", '"x"', "[" * 5000, ""])
def test_a_damaged_list_makes_every_file_the_users(home, text):
    assert called("plot", "run", "truth.mach", cwd=home).returncode == 0
    (home / "run" / MADE).write_text(text)
    assert refused(called("plot", "run", "truth.mach", cwd=home))


def test_force_replaces_it(home):
    (home / "mine.html").write_text("mine")
    assert called("plot", "run", "truth.mach", "--out", "mine.html", "--force", cwd=home).returncode == 0
    assert len(json.loads((home / "run" / MADE).read_text())) == 1
