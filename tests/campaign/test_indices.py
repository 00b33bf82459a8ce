"""Sobol indices: against scipy and closed forms, and the design that a campaign flies for them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from campaign_run import write_drop
from scipy import stats

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.design.sampling import PROFILES, SaltelliDesign
from edl6dof.campaign.sensitivity import sobol_indices
from edl6dof.config.errors import ConfigError
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.campaign.drivers import indices

PI = np.pi


def ishigami(x: np.ndarray) -> np.ndarray:
    """Ishigami and Homma (1990), x of shape (n, 3) in -pi .. pi."""
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


#: First-order and total indices of it, by hand.
VARIANCE = 7.0**2 / 8.0 + 0.1 * PI**4 / 5.0 + 0.01 * PI**8 / 18.0 + 0.5
FIRST = {"a": 0.5 * (1.0 + 0.1 * PI**4 / 5.0) ** 2 / VARIANCE, "b": 49.0 / 8.0 / VARIANCE, "c": 0.0}
TOTAL = FIRST | {"c": 0.01 * PI**8 * 8.0 / 225.0 / VARIANCE}
TOTAL["a"] += TOTAL["c"]


def flown(rows: int, seed: int = 1) -> dict[str, np.ndarray]:
    """The design of three groups, each of its matrices through the function."""
    swaps = SaltelliDesign({"a": [0], "b": [1], "c": [2]}, rows, seed)
    unit = swaps.unit_numbers(0, rows * swaps.width)
    figure = ishigami(PI * (2.0 * unit - 1.0))
    return {swaps.matrix(k): figure[k :: swaps.width] for k in range(swaps.width)}


@pytest.mark.long
def test_indices_are_those_of_the_closed_form():
    matrices = flown(4096)
    for index in sobol_indices(matrices.pop("A"), matrices.pop("B"), matrices):
        assert index.first[0] == pytest.approx(FIRST[index.name], abs=0.03)
        assert index.total[0] == pytest.approx(TOTAL[index.name], abs=0.03)


def test_indices_are_those_of_scipy():
    matrices = flown(256)
    a, b = matrices.pop("A"), matrices.pop("B")
    known = {"f_A": a[None], "f_B": b[None], "f_AB": np.stack(list(matrices.values()))[:, None]}
    expected = stats.sobol_indices(func=known, n=256)
    found = {index.name: index for index in sobol_indices(a, b, matrices)}
    for k, name in enumerate("abc"):
        assert found[name].first[0] == pytest.approx(np.ravel(expected.first_order)[k], abs=1e-9)
        assert found[name].total[0] == pytest.approx(np.ravel(expected.total_order)[k], abs=1e-9)


def test_intervals_hold():
    """In at least nine of ten designs of 128 rows, as bootstrap intervals of few rows do."""
    held = []
    for seed in range(30):
        matrices = flown(128, seed)
        for index in sobol_indices(matrices.pop("A"), matrices.pop("B"), matrices):
            held.append(index.first[1] <= FIRST[index.name] <= index.first[2])
            held.append(index.total[1] <= TOTAL[index.name] <= index.total[2])
    assert np.mean(held) >= 0.9


def test_rows_without_the_figure_are_left_out():
    matrices = flown(64)
    a, b = matrices.pop("A"), matrices.pop("B")
    gaps = {name: np.where(np.arange(64) == 7, np.nan, figure) for name, figure in matrices.items()}
    short = {name: np.delete(figure, 7) for name, figure in matrices.items()}
    assert sobol_indices(a, b, gaps) == sobol_indices(np.delete(a, 7), np.delete(b, 7), short)
    assert sobol_indices(a[:10], b[:10], {name: figure[:10] for name, figure in matrices.items()}) == []


def test_design_swaps_one_group_at_a_time():
    swaps = SaltelliDesign({"one": [1], "two": [0, 2], PROFILES: []}, 8, 3)
    unit = swaps.unit_numbers(0, 8 * swaps.width).reshape(8, swaps.width, 3)
    a, b = unit[:, 0], unit[:, 1]
    assert not np.any(a == b)
    assert np.array_equal(unit[:, 2], np.column_stack([a[:, 0], b[:, 1], a[:, 2]]))
    assert np.array_equal(unit[:, 3], np.column_stack([b[:, 0], a[:, 1], b[:, 2]]))
    assert np.array_equal(unit[:, 4], a)
    assert np.array_equal(swaps.unit_numbers(7, 19), unit.reshape(-1, 3)[7:19])
    profiles = [swaps.profile(case) for case in range(8 * swaps.width)]
    assert profiles[:5] == [0, 8, 0, 0, 8] and profiles[5:10] == [1, 9, 1, 1, 9]


def test_plan_flies_the_design(tmp_path):
    plan = load_plan(write_drop(tmp_path), cases=16, sampling="sobol_indices")
    assert list(plan.saltelli.groups) == [
        *("vehicle.mass.entry_kg", "atmosphere.density_factor", "vehicle.rcs.thrusters.*.thrust_n", PROFILES)
    ]
    assert plan.count == 16 * 6
    a, b, mass, _, thrust, profiles = plan.cases(6, 12)
    assert mass.truth == a.truth | {"vehicle.mass.entry_kg": b.truth["vehicle.mass.entry_kg"]}
    assert {path for path in a.truth if thrust.truth[path] == b.truth[path]} == {
        path for path in a.truth if path.startswith("vehicle.rcs")
    }
    assert profiles.truth == a.truth and (a.profile, b.profile, profiles.profile) == (1, 17, 17)
    assert a.label == {"matrix": "A", "row": 1}


@pytest.mark.parametrize(
    "more, said",
    [
        ("sweep:\n  axes:\n    - {path: wind.scale, values: [0.0, 1.0]}\n", "is flown alone"),
        (
            "  faults:\n    - {chance: 0.1, one_of: [{thruster: D1, kind: stuck_off, at: {time_s: 1.0}}]}\n",
            "takes no faults",
        ),
    ],
)
def test_what_a_design_cannot_hold_is_refused(tmp_path, more, said):
    file = Path(write_drop(tmp_path))
    file.write_text(file.read_text() + more)
    with pytest.raises(ConfigError, match=said):
        load_plan(str(file), cases=16, sampling="sobol_indices")


def test_design_flown_and_told(edl6dof, tmp_path):
    """A body that falls: mass and density move its dynamic pressure, the thrust of thrusters does not."""
    file = write_drop(tmp_path)
    Path(file).write_text("limits: {entry_dynamic_pressure_pa: 900.0}\n" + Path(file).read_text())
    status, _, err = edl6dof("campaign", file, "--sampling", "sobol_indices", "--until", "p_success +- 5%")
    assert status == 2 and "--until" in err
    status, out, _ = edl6dof("campaign", file, "-n", "32", "--sampling", "sobol_indices")
    assert status == 0 and "drops: 64 of 64 succeed" in out and "64 of 192 flights are independent" in out
    summary = json.loads(Path("runs/drops/summary.json").read_text())
    least = stats.binomtest(64, 64).proportion_ci(method="wilson").low
    assert summary["cases"] == 192 and summary["p_success_95"][0] == pytest.approx(least, abs=1e-6)
    known = Results(Path("runs/drops"))
    assert len(known.cases) == 64 and set(known.swapped("end_s")) == {"A", "B", *known.groups, PROFILES}
    _, table = indices(known)
    rows = {row[0].strip(): row for row in table.rows}
    assert edl6dof("report", "runs/drops")[0] == 0
    assert "Sobol indices" in Path("runs/drops/report.html").read_text(encoding="utf-8")
    assert list(rows)[:2] == ["peak dynamic pressure", "atmosphere.density_factor"]
    assert rows["atmosphere.density_factor"][3].bar > 0.9 > 0.1 > rows[PROFILES][3].bar
