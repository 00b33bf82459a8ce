"""``edl6dof covariance`` on a campaign file, and beside the flights of a finished campaign."""

from __future__ import annotations

import csv

import numpy as np
import pyarrow.parquet as pq
import pytest
from campaign_run import write_drop

FIGURES = ("peak_load_g0", "peak_dynamic_pressure_pa", "peak_heat_flux_w_cm2", "heat_load_j_cm2")


def budget(path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8") as file:
        first, *rows = csv.reader(file)
    assert first == ["source", *FIGURES]
    return {name: np.array(values, dtype=float) for name, *values in rows}


def test_covariance_is_that_of_the_campaign_beside_it(edl6dof, tmp_path):
    """Drops through thin air answer linearly: 24 flights tell what 430 show, and what each source gives."""
    assert edl6dof("campaign", write_drop(tmp_path), "-q")[0] == 0
    status, out, _ = edl6dof("covariance", "runs/drops", "--at", "entry", "--pairs", "8", "--out", "b.csv")
    assert status == 0 and "campaign: 430 flights, 17.9 times as many" in out
    assert "not significant: vehicle.rcs.thrusters.*.thrust_n" in out
    found, flown = budget(tmp_path / "b.csv"), pq.read_table("runs/drops/cases.parquet")
    sampled = np.array([flown[name].to_numpy().std(ddof=1) for name in FIGURES])
    assert found["all"] == pytest.approx(sampled, rel=0.1)
    heavy, thick = found["vehicle.mass.entry_kg"], found["atmosphere.density_factor"]
    assert np.hypot(heavy, thick) == pytest.approx(found["all"], rel=0.02)
    assert found["random profiles and noise"] == pytest.approx(0.0, abs=1e-9 * found["all"].max())
    assert heavy[0] < 0.0 < thick[0]  # of two bodies the heavier one is braked less


def test_pictures_and_parameters_alone(edl6dof, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    status, out, _ = edl6dof(
        "covariance", write_drop(tmp_path), "--at", "entry", "--pairs", "8", "--each", "--out", "e.png"
    )
    assert status == 0 and "each alone" in out and "vehicle.mass.entry_kg" in out
    table = out.partition("each alone")[2].rpartition("─ \n")[2]
    rows = [row for row in table.splitlines() if row.startswith(" ") and row.strip()]
    assert {len(row.split()) for row in rows} == {1 + 2 * len(FIGURES)}, "a source is a line"
    assert (tmp_path / "e.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--at", "landing"), "--at: must be entry, parachute, trim_wing, backshell, touchdown"),
        (("--out", "budget.xlsx"), "budget.xlsx: must end in .csv, .png, .pdf, .svg"),
        (("--at", "touchdown"), "72 of 72 flights do not come to the event; one: flown to the time limit"),
        (("--set", "nothing=1"), "unknown key"),
    ],
)
def test_bad_input_is_refused(edl6dof, tmp_path, words, message):
    status, out, err = edl6dof("covariance", write_drop(tmp_path), *words)
    assert status == 2 and message in err and "Traceback" not in err and not out


def test_beside_a_campaign_no_other_values(edl6dof, tmp_path):
    assert edl6dof("campaign", write_drop(tmp_path), "-n", "8", "-q")[0] == 0
    status, _, err = edl6dof("covariance", "runs/drops", "--set", "wind.scale=2")
    assert status == 2 and "its covariance accepts no other values" in err
    status, _, err = edl6dof("covariance", "runs/drops", "--at", "entry")
    assert status == 2 and "only 8 of its flights came to the event" in err
