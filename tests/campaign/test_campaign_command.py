"""``edl6dof campaign``, ``refly`` and ``report`` on the folder of a campaign."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from campaign_run import write_drop

from edl6dof.campaign.store import Info, Summary
from edl6dof.manifest import hash_of, read_sealed, write_sealed
from edl6dof.report.campaign.campaign_results import Results

GRID = """\
sweep:
  axes:
    - {path: wind.scale, of: truth, values: [0.0, 1.0]}
    - {path: initial.speed_m_s, first: 40.0, last: 60.0, count: 3}
"""

#: Two moments of inertia of one mass model, as lines of a campaign section.
CORRELATED = """\
  correlated:
    - paths: [vehicle.mass.entry_inertia_kg_m2.0, vehicle.mass.entry_inertia_kg_m2.1]
      three_sigma: [30.0, 30.0]
      correlation: [[1.0, 0.9], [0.9, 1.0]]
"""


def table(folder="runs/drops"):
    return pq.read_table(Path(folder) / "cases.parquet")


def test_campaign_refly_and_report(edl6dof, tmp_path):
    file = write_drop(tmp_path)
    status, out, err = edl6dof("campaign", file, "-n", "60")
    assert status == 0 and "drops: 60 of 60 succeed, 100.00 % (93.98 .. 100.00 %)" in out
    assert "60 of 60" in err and table().num_rows == 60
    status, out, _ = edl6dof("refly", "runs/drops", "17", "--no-replay")
    assert status == 0 and "identical to its row" in out
    assert (tmp_path / "runs/drops_case17/telemetry.parquet").is_file()
    status, out, _ = edl6dof("refly", "runs/drops", "--worst", "peak_dynamic_pressure_pa", "--no-replay")
    peaks = np.array(table()["peak_dynamic_pressure_pa"])
    assert status == 0 and f"case {peaks.argmax()}, " in out and f"pressure: {peaks.max():.4g} Pa\n" in out
    for words in (["--worst", "peak_dynamic_presure_pa"], [], ["3", "--worst", "peak_load_g0"]):
        assert edl6dof("refly", "runs/drops", *words)[0] == 2
    status, out, _ = edl6dof("report", "runs/drops")
    page = Path("runs/drops/report.html").read_text(encoding="utf-8")
    assert status == 0 and "60 of 60 flights succeed" in page and "vehicle.mass.entry_kg" in page
    assert "Quantiles further out need more than 60 flights: 95 % needs 72" in page
    assert edl6dof("refly", "runs/drops", "60")[0] == 2


def test_inputs_drawn_together_are_one_group_and_quantiles_have_bounds(edl6dof, tmp_path):
    lines = "limits: {entry_dynamic_pressure_pa: 900.0}\n"
    file = Path(write_drop(tmp_path))
    file.write_text(lines + file.read_text() + CORRELATED)
    status, out, _ = edl6dof("campaign", str(file), "-n", "80", "--json")
    result = json.loads(out)["figures"]["peak_dynamic_pressure_pa"]
    assert status == 0 and [one["share"] for one in result["quantiles"]] == [0.05, 0.5, 0.95]
    assert all(one["low"] < one["value"] < one["high"] for one in result["quantiles"])
    assert result["flights_needed"] == {"0.0013": 2836, "0.01": 368, "0.99": 368, "0.9987": 2836}
    groups = {name: columns.shape for name, columns in Results(Path("runs/drops")).groups.items()}
    assert groups["vehicle.rcs.thrusters.*.thrust_n"] == (80, 22)
    assert groups["vehicle.mass.entry_inertia_kg_m2.*"] == (80, 2) and groups["vehicle.mass.entry_kg"] == (
        80,
        1,
    )
    status, out, _ = edl6dof("campaign", "runs/drops", "--resume")
    assert "95 % (bounds at 95 %)" in out and "99 % needs 368, 99.87 % needs 2,836" in out


def test_refly_notices_a_row_that_is_not_its_own(edl6dof, tmp_path):
    edl6dof("campaign", write_drop(tmp_path), "-n", "20", "-q")
    wrong = table().set_column(table().column_names.index("end_s"), "end_s", [[1.5] * 20])
    pq.write_table(wrong, "runs/drops/cases.parquet")
    status, _, err = edl6dof("refly", "runs/drops", "3", "--no-replay")
    assert status == 2 and "cases.parquet: is damaged" in err
    summary = Path("runs/drops/summary.json")
    changes = {"cases_sha256": hash_of(Path("runs/drops/cases.parquet"))}
    write_sealed(summary, read_sealed(summary, Summary).model_copy(update=changes))
    status, out, _ = edl6dof("refly", "runs/drops", "3", "--no-replay")
    assert (status, out.splitlines()[-2]) == (1, "differs from its row: end_s")
    assert out.splitlines()[-1].endswith("check this machine: edl6dof verify --golden")


def test_case_flown_from_its_resolved_scenario_is_the_same(edl6dof, tmp_path):
    """The run folder of a case holds all of it, the random profiles too."""
    file = Path(write_drop(tmp_path))
    file.write_text(
        file.read_text().replace("atmosphere:\n", "atmosphere:\n  perturbation: {enabled: true}\n")
        + "wind: {gust: {enabled: true}}\n"
    )
    edl6dof("campaign", str(file), "-n", "5", "-q")
    edl6dof("refly", "runs/drops", "4", "--no-replay")
    edl6dof("fly", "runs/drops_case4/scenario.yaml", "--out", "again", "--no-replay", "-q")
    first, second = (
        json.loads(Path(folder, "summary.json").read_text())["figures"]
        for folder in ("runs/drops_case4", "again")
    )
    assert first == second


def test_stops_when_the_interval_is_narrow_enough(edl6dof, tmp_path):
    """100 successes of 100: half width 1.85 %; 150 of 150: 1.25 %."""
    status, out, _ = edl6dof(
        "campaign", write_drop(tmp_path), "--until", "p_success +- 1.5%", "--workers", "2"
    )
    assert status == 0 and table().num_rows == 150
    assert "stopped after 150 of 430 cases" in out


def test_refuses_to_overwrite_and_to_mix(edl6dof, tmp_path):
    file = write_drop(tmp_path)
    assert edl6dof("campaign", file, "-n", "10", "-q")[0] == 0
    status, _, err = edl6dof("campaign", file, "-n", "10")
    assert status == 2 and "go on with --resume, replace it with --force" in err
    assert edl6dof("campaign", file, "-n", "20", "--force", "-q")[0] == 0 and table().num_rows == 20
    status, _, err = edl6dof("campaign", file, "--resume")
    assert status == 2 and "begun with another plan" in err
    info = read_sealed(Path("runs/drops/campaign.json"), Info)
    others = {"sources": "f" * 64, "versions": {**info.identity.versions, "numpy": "1.0"}}
    write_sealed(
        Path("runs/drops/campaign.json"),
        info.model_copy(update={"identity": info.identity.model_copy(update=others)}),
    )
    for words in (
        ["campaign", "runs/drops", "--resume"],
        ["refly", "runs/drops", "3"],
        ["replay", "runs/drops", "--html", "x.html"],
    ):
        status, _, err = edl6dof(*words)
        assert (
            status == 2
            and f"numpy: was 1.0, is {np.__version__}" in err
            and "sources of edl6dof: was ffffffffffff, is " in err
        )


def test_force_does_not_remove_what_is_no_campaign(edl6dof, tmp_path):
    file = write_drop(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("")
    status, _, err = edl6dof("campaign", file, "--out", "mine", "--force")
    assert (
        status == 2 and "not the folder of a campaign" in err and (tmp_path / "mine" / "thesis.txt").is_file()
    )
    assert edl6dof("campaign", "mine", "--resume")[2].startswith("mine: is not the folder of a campaign")


@pytest.mark.parametrize(
    "words, said",
    [
        (["campaign"], "name a campaign file"),
        (["campaign", "tianwen1"], "has no campaign: and no sweep: section"),
        (["campaign", "tianwen1_mc", "--until", "soon"], "must have the form 'p_success +- 0.5%'"),
        (["campaign", "tianwen1_mc", "--engine", "cloud"], "must be threads or dask"),
        (["campaign", "tianwen1_mc", "--cluster", "tcp://127.0.0.1:1"], "needs --engine dask"),
        (["refly", "nowhere", "3"], "is not the folder of a campaign"),
    ],
)
def test_bad_words_are_refused_in_one_line(edl6dof, words, said):
    status, out, err = edl6dof(*words)
    assert (status, out) == (2, "") and said in err and len(err.splitlines()) == 1


def test_sweep_flies_every_point_and_is_mapped(edl6dof, tmp_path):
    file = Path(write_drop(tmp_path))
    head, _, _ = file.read_text().partition("campaign:")
    file.write_text(head + GRID)
    assert edl6dof("campaign", str(file), "-q")[0] == 0
    rows = table().to_pylist()
    assert [(row["truth.wind.scale"], row["belief.initial.speed_m_s"]) for row in rows] == [
        (scale, speed) for scale in (0.0, 1.0) for speed in (40.0, 50.0, 60.0)
    ]
    assert edl6dof("report", "runs/drops")[0] == 0
    assert "heatmap" in Path("runs/drops/report.html").read_text(encoding="utf-8")


def test_comparison_on_common_random_numbers(edl6dof, tmp_path):
    """A heavier body of the same drag falls faster; the pairs show it at once, and the sign is that of B -
    A.
    """
    file = write_drop(tmp_path)
    edl6dof("campaign", file, "-n", "40", "-q", "--out", "a")
    edl6dof("campaign", file, "-n", "40", "-q", "--out", "b", "--set", "initial.altitude_m=8000")
    status, out, _ = edl6dof("compare", "a", "b", "--json")
    result = json.loads(out)
    assert status == 0 and result["pairs"] == {"both": 40, "first_only": 0, "second_only": 0, "neither": 0}
    peak = next(figure for figure in result["figures"] if figure["figure"] == "peak_dynamic_pressure_pa")
    assert peak["difference"] > 10 * peak["half_width"] > 0.0, "denser air further down"
    a, b = (pq.read_table(f"{name}/cases.parquet")["peak_dynamic_pressure_pa"].to_numpy() for name in "ab")
    assert peak["difference"] == pytest.approx((b - a).mean())
    assert "peak dynamic pressure" in edl6dof("compare", "a", "b")[1]
    edl6dof("campaign", file, "-n", "40", "-q", "--out", "c", "--seed", "9")
    status, _, err = edl6dof("compare", "a", "c")
    assert status == 2 and "fly both with the same campaign section and seed" in err
