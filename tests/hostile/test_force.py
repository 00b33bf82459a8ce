"""``--force`` replaces a whole result of the same command, and nothing that a user would miss."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import get_args

import pytest
from command import SHORT, refused
from in_process import called

from edl6dof.config.errors import ConfigError
from edl6dof.manifest import MANIFEST, Kind, Manifest, seal
from edl6dof.runs.files import COMMANDS, atomic_folder


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> Path:
    home = tmp_path_factory.mktemp("flown")
    assert called("fly", *SHORT, "--out", home / "run", "-q", "--no-replay").returncode == 1
    return home / "run"


@pytest.fixture
def run(flown, tmp_path) -> Path:
    return Path(shutil.copytree(flown, tmp_path / "run"))


def force(run: Path):
    return called("fly", *SHORT, "--out", run, "--force", "-q", "--no-replay")


def everything(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_run_and_what_the_program_wrote_into_it_later_is_replaced(run):
    for words in (
        ("report", run),
        ("plot", run, "truth.mach"),
        ("export", run, "--format", "csv"),
        ("compare", run, run),
    ):
        assert called(*words).returncode == 0
    assert len(everything(run)) == 10  # with the list of what was made
    assert force(run).returncode == 1
    assert sorted(everything(run)) == [
        "events.json",
        MANIFEST,
        "scenario.yaml",
        "summary.json",
        "telemetry.parquet",
    ]


@pytest.mark.parametrize("kind", get_args(Kind))
def test_result_of_every_kind_is_replaced_by_one_of_its_own_kind_alone(kind, tmp_path):
    """Of a calibration too: its manifest was taken for a damaged one."""
    for text in ("first", "second"):
        with atomic_folder(tmp_path / "result", kind, force=text == "second") as folder:
            (folder / "summary.json").write_text(text)
    assert Manifest.of(tmp_path / "result").read("summary.json") == b"second"
    other = next(one for one in get_args(Kind) if one != kind)
    words = f"is a result of 'edl6dof {COMMANDS[kind]}'"
    with pytest.raises(ConfigError, match=words), atomic_folder(tmp_path / "result", other, force=True):
        pass


def add(run: Path, name: str) -> None:
    (run / name).parent.mkdir(parents=True, exist_ok=True)
    (run / name).write_text("years of work")


STRANGERS = [
    "thesis.tex",
    "plots/thesis.tex",
    "plots/deep/a.png",
    "report/notes.txt",
    ".hidden",
    "runs/x/summary.json",
]


@pytest.mark.parametrize("name", STRANGERS)
def test_file_of_the_users_own_is_kept_and_named(run, name):
    add(run, name)
    before = everything(run)
    done = force(run)
    assert refused(done) and name in done.stderr
    assert everything(run) == before


@pytest.mark.parametrize("name", ["scenario.yaml", "summary.json", "telemetry.parquet"])
def test_file_that_the_user_has_edited_is_kept_and_named(run, name):
    (run / name).write_bytes((run / name).read_bytes() + b"\n# mine")
    before = everything(run)
    done = force(run)
    assert refused(done) and name in done.stderr and "changed" in done.stderr
    assert everything(run) == before


def test_link_is_kept(run):
    (run / "data").symlink_to(run.parent)
    assert refused(force(run))
    assert (run / "data").is_symlink()


def test_result_of_another_command_is_kept(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "summary.json").write_text("{}")
    seal(tmp_path / "other", "study")
    done = force(tmp_path / "other")
    assert refused(done) and "edl6dof study" in done.stderr
    assert Manifest.of(tmp_path / "other").kind == "study"


@pytest.mark.parametrize("name", ["campaign.json", "summary.json", MANIFEST])
def test_folder_with_nothing_but_a_name_we_use_is_kept(tmp_path, name):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / name).write_text('{"kind": "flight"}')
    assert refused(force(tmp_path / "other"))
    assert (tmp_path / "other" / name).read_text() == '{"kind": "flight"}'
