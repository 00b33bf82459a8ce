"""The files of a run: read back with independent readers and compared with the flight."""

from __future__ import annotations

import json

import numpy as np
import pyarrow.parquet as pq
import pytest

from edl6dof.config.document.source import read_document
from edl6dof.config.errors import ConfigError
from edl6dof.manifest import seal
from edl6dof.runs.files import atomic_folder
from edl6dof.runs.run import write_run
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario


@pytest.fixture(scope="module")
def run(nominal, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    write_run(nominal, folder)
    seal(folder, "flight")
    return folder


def test_parquet_holds_every_value_and_its_unit(nominal, run):
    table = pq.read_table(run / "telemetry.parquet")
    for name, column in nominal.telemetry.items():
        assert np.array_equal(table[name].to_numpy(), column, equal_nan=True), name
    field = table.schema.field("truth.alpha_deg")
    assert field.metadata[b"unit"] == b"deg"
    assert b"angle of attack" in field.metadata[b"meaning"]
    assert json.loads(table.schema.metadata[b"phases"]) == nominal.phase_names


def test_summary_figures_are_the_flights_own(nominal, run):
    summary = json.loads((run / "summary.json").read_text())
    assert summary["outcome"] == nominal.outcome
    assert summary["figures"]["touchdown_s"] == nominal.figures["touchdown_s"]
    assert json.loads((run / "events.json").read_text())[-1]["name"] == nominal.outcome


def test_resolved_scenario_reads_back_equal(nominal, run):
    loaded = check_document(read_document(run / "scenario.yaml"))
    assert isinstance(loaded.scenario, Scenario)
    assert loaded.scenario == nominal.scenario


def test_folder_appears_whole_or_not_at_all(tmp_path):
    target = tmp_path / "run"
    with (
        pytest.raises(RuntimeError, match="half way"),
        atomic_folder(target, "flight", force=False) as folder,
    ):
        (folder / "a").write_text("x")
        raise RuntimeError("half way")
    assert list(tmp_path.iterdir()) == []
    with atomic_folder(target, "flight", force=False) as folder:
        (folder / "summary.json").write_text("{}")
        assert not target.exists()
    assert (target / "summary.json").is_file()
    with pytest.raises(ConfigError), atomic_folder(target, "flight", force=False):
        pass
    with atomic_folder(target, "flight", force=True) as folder:
        (folder / "b").write_text("y")
    assert sorted(path.name for path in target.iterdir()) == ["b", "manifest.json"]


def test_force_does_not_replace_a_folder_that_is_no_run(tmp_path):
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("...")
    with (
        pytest.raises(ConfigError, match="is no result of .edl6dof fly."),
        atomic_folder(tmp_path / "precious", "flight", force=True),
    ):
        pass
    assert (tmp_path / "precious" / "thesis.tex").read_text() == "..."
