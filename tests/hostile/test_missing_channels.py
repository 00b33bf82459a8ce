"""A run with other columns and keys is shown if it holds what is needed, and refused in one line if not."""

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


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> Path:
    run = tmp_path_factory.mktemp("flown") / "run"
    assert called("fly", *SHORT, "--out", run, "-q", "--no-replay").returncode == 1  # cut short: not landed
    return run


def altered(flown: Path, folder: Path, *, without: str = "-") -> Path:
    """The run with keys and a column that are unknown, without the columns of a pattern."""
    run = Path(shutil.copytree(flown, folder / "other"))
    (run / MANIFEST).unlink()
    summary = json.loads((run / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps({**summary, "edl6dof_version": "9.8.7", "crew": ["none"]}))
    events = json.loads((run / "events.json").read_text())
    (run / "events.json").write_text(json.dumps([{**event, "crew": "none"} for event in events]))
    table = pq.read_table(run / "telemetry.parquet")
    table = table.select([name for name in table.column_names if not re.fullmatch(without, name)])
    pq.write_table(table.append_column("crew.mood", pa.array(table["t_s"])), run / "telemetry.parquet")
    seal(run, "flight")
    return run


@pytest.fixture(scope="module")
def other(flown, tmp_path_factory) -> Path:
    return altered(flown, tmp_path_factory.mktemp("other"))


@pytest.fixture(scope="module")
def fewer(flown, tmp_path_factory) -> Path:
    return altered(flown, tmp_path_factory.mktemp("fewer"), without=NEEDED)


@pytest.mark.parametrize(
    "viewer",
    [
        pytest.param(viewer, marks=pytest.mark.long if viewer in ("replay", "compare") else ())
        for viewer in VIEWERS
    ],
)
def test_a_run_with_unknown_keys_is_shown(viewer, other, tmp_path):
    done = called(*viewing(viewer, other, tmp_path / "out"))
    assert done.returncode == 0, done.stderr
    if viewer == "report":
        page = (tmp_path / "out.html").read_text()
        assert "edl6dof 9.8.7" in page and f"edl6dof {edl6dof.__version__}" in page, "flown by, report by"


@pytest.mark.parametrize("viewer", ["report", "compare"])
def test_a_channel_that_is_not_there_is_named(viewer, fewer, tmp_path):
    done = called(*viewing(viewer, fewer, tmp_path / "out"))
    assert refused(done) and len(done.stderr.splitlines()) == 1
    assert f"no channel {NEEDED!r}, which is needed here" in done.stderr
    assert not list(tmp_path.iterdir())


def test_what_does_not_need_the_channel_is_shown(fewer, tmp_path):
    for viewer in ("csv", "plot", "list"):
        assert called(*viewing(viewer, fewer, tmp_path / viewer)).returncode == 0
    plot = called("plot", fewer, "crew.mood", "--out", tmp_path / "mood.png")
    assert plot.returncode == 0, plot.stderr


def test_python_reads_what_there_is_and_says_what_is_missing(fewer, tmp_path):
    run = edl6dof.open_run(fewer)
    assert run["crew.mood"].shape == run["t_s"].shape and run.unit("crew.mood") == ""
    assert "time limit" in run.outcome and run.figures and run._repr_html_()
    with pytest.raises(edl6dof.ConfigError, match=f"no channel {NEEDED!r}"):
        edl6dof.report(run, out=tmp_path / "report.html")
