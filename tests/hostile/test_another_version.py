"""A run that another version of the program wrote: shown where it holds what is to be shown, and told in one
line where not; its scenario is flown again, or its keys are said to be of that version.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from command import SHORT, VIEWERS, refused, viewing
from in_process import called

import edl6dof
from edl6dof.manifest import MANIFEST, seal

#: A channel that reports are made from.
NEEDED = "truth.dynamic_pressure_pa"
BOTH = f"written by edl6dof 9.8.7, and this is edl6dof {edl6dof.__version__}"


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> Path:
    run = tmp_path_factory.mktemp("flown") / "run"
    assert called("fly", *SHORT, "--out", run, "-q", "--no-replay").returncode == 1  # cut short: not landed
    return run


def of_another_version(flown: Path, folder: Path, *, without: str = "-", more: str = "") -> Path:
    """The run as version 9.8.7 might have written it: keys and a column that this one does not know, and
    ``without`` the columns of that pattern; ``more`` stands at the end of its scenario.
    """
    run = Path(shutil.copytree(flown, folder / "other"))
    (run / MANIFEST).unlink()
    scenario = run / "scenario.yaml"
    text = scenario.read_text().replace(f"edl6dof {edl6dof.__version__}", "edl6dof 9.8.7", 1)
    scenario.write_text(text + more)
    summary = json.loads((run / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps({**summary, "edl6dof_version": "9.8.7", "crew": ["none"]}))
    events = json.loads((run / "events.json").read_text())
    (run / "events.json").write_text(json.dumps([{**event, "crew": "none"} for event in events]))
    table = pq.read_table(run / "telemetry.parquet")
    table = table.select([name for name in table.column_names if not re.fullmatch(without, name)])
    pq.write_table(table.append_column("crew.mood", pa.array(table["t_s"])), run / "telemetry.parquet")
    seal(run, "flight")
    rewritten(run, written_by="edl6dof 9.8.7")
    return run


def rewritten(run: Path, **changes: object) -> None:
    manifest = json.loads((run / MANIFEST).read_text())
    (run / MANIFEST).write_text(json.dumps({**manifest, **changes}))


@pytest.fixture(scope="module")
def other(flown, tmp_path_factory) -> Path:
    return of_another_version(flown, tmp_path_factory.mktemp("other"))


@pytest.fixture(scope="module")
def fewer(flown, tmp_path_factory) -> Path:
    return of_another_version(flown, tmp_path_factory.mktemp("fewer"), without=NEEDED)


@pytest.mark.parametrize(
    "viewer",
    [
        pytest.param(viewer, marks=pytest.mark.long if viewer in ("replay", "compare") else ())
        for viewer in VIEWERS
    ],
)
def test_a_run_of_another_version_is_shown(viewer, other, tmp_path):
    done = called(*viewing(viewer, other, tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    if viewer == "report":
        page = (tmp_path / "out.html").read_text()
        assert "edl6dof 9.8.7" in page and f"edl6dof {edl6dof.__version__}" in page, "flown by, report by"


@pytest.mark.parametrize("viewer", ["report", "compare"])
def test_a_channel_that_is_not_there_is_told_with_both_versions(viewer, fewer, tmp_path):
    done = called(*viewing(viewer, fewer, tmp_path / "out"))
    assert refused(done) and len(done.stderr.splitlines()) == 1
    assert f"no channel {NEEDED!r}, which is needed here" in done.stderr and BOTH in done.stderr
    assert not list(tmp_path.iterdir())


def test_what_does_not_need_the_channel_is_shown(fewer, tmp_path):
    for viewer in ("csv", "plot", "list"):
        assert called(*viewing(viewer, fewer, tmp_path / viewer)).returncode == 0
    plot = called("plot", fewer, "crew.mood", "--out", tmp_path / "mood.png")
    assert plot.returncode == 0, plot.stderr


def test_python_reads_what_there_is_and_says_what_is_missing(fewer, tmp_path):
    run = edl6dof.open_run(fewer)
    assert run["crew.mood"].shape == run["t_s"].shape and run.unit("crew.mood") == ""
    assert "time limit" in run.outcome and run.metrics and run._repr_html_()
    with pytest.raises(edl6dof.ConfigError, match=rf"no channel {NEEDED!r}.*" + re.escape(BOTH)):
        edl6dof.report(run, out=tmp_path / "report.html")


def test_an_older_channel_missing_in_a_run_of_this_version_names_no_other(flown, tmp_path):
    run = of_another_version(flown, tmp_path, without=NEEDED)
    rewritten(run, written_by=f"edl6dof {edl6dof.__version__}")
    done = called("report", run)
    assert refused(done) and f"no channel {NEEDED!r}" in done.stderr and "written by" not in done.stderr


@pytest.mark.parametrize("change", [{"kind": "swarm"}, {"files": ["summary.json"]}])
def test_a_manifest_in_a_form_of_another_version_is_not_called_damaged(change, other, tmp_path):
    run = Path(shutil.copytree(other, tmp_path / "run"))
    rewritten(run, **change)
    done = called("report", run)
    assert refused(done) and f"{MANIFEST}: cannot be read: {BOTH}" in done.stderr
    rewritten(run, written_by="edl6dof 9.8.7\n<b>anything</b>")
    assert "is damaged: it is no manifest" in called("report", run).stderr


def test_a_summary_in_a_form_of_another_version_names_it(other, tmp_path):
    run = Path(shutil.copytree(other, tmp_path / "run"))
    summary = json.loads((run / "summary.json").read_text())
    del summary["limits"]
    (run / "summary.json").write_text(json.dumps(summary))
    (run / MANIFEST).unlink()
    seal(run, "flight")
    rewritten(run, written_by="edl6dof 9.8.7")
    done = called("report", run)
    assert refused(done) and "summary.json: is not the file of a run: limits" in done.stderr
    assert BOTH in done.stderr


def test_a_scenario_of_another_version_is_flown_and_said_to_be_one(other, tmp_path):
    done = called("fly", other / "scenario.yaml", "-q", "--no-replay", "--out", tmp_path / "again")
    assert done.returncode == 1, done.stderr  # cut short, as the first
    assert done.stderr == f"{other / 'scenario.yaml'}: {BOTH}; the flight may differ from that one\n"


def test_keys_of_another_version_are_said_to_be_of_it(flown, tmp_path):
    run = of_another_version(flown, tmp_path, more="crew: {size: 3}\n")
    done = called("check", run / "scenario.yaml")
    assert refused(done) and "crew: unknown key" in done.stderr
    assert f"scenario.yaml: {BOTH}" in done.stderr
    mine = tmp_path / "mine.yaml"
    mine.write_text("extends: tianwen1\nname: mine\ncrew: {size: 3}\n")
    assert "written by" not in called("check", mine).stderr
