"""The probability of a rare violation of a requirement, by flights of two seconds with a known result."""

from __future__ import annotations

import json
from math import exp
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from campaign_run import write_drop
from scipy.stats import norm

import edl6dof as package
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import CaseRunner
from edl6dof.campaign.subset import estimate
from edl6dof.config.errors import ConfigError

#: Peak dynamic pressure (Pa) of the nominal drop; its logarithm has the standard deviation 0.1, that of the
#: density, but for a small effect of the mass.
NOMINAL_PA = 13.5455
HIGH_PA, LOW_PA = NOMINAL_PA * exp(0.3), NOMINAL_PA * exp(-0.3)
REQUIREMENTS = f"""\
requirements:
  - {{id: HIGH, text: Low pressure, figure: peak_dynamic_pressure_pa, at_most: {HIGH_PA}, share: 0.99}}
  - {{id: LOW, text: Some pressure, figure: peak_dynamic_pressure_pa, at_least: {LOW_PA}, share: 0.99}}
  - {{id: LAND, text: Slow landing, figure: touchdown_vertical_m_s, at_most: 1.0, share: 0.99}}
"""
DENSITY = "truth.atmosphere.density_factor"
SMALL = {"requirements": "r.yaml", "size": 20, "populations": 2}


@pytest.fixture
def drops(edl6dof, tmp_path):
    """A campaign file and requirements in an empty folder."""
    Path("r.yaml").write_text(REQUIREMENTS)
    return write_drop(tmp_path)


def test_the_nominal_drop_has_the_pressure_of_this_test(drops):
    assert package.fly(drops).figures["peak_dynamic_pressure_pa"] == pytest.approx(NOMINAL_PA, rel=1e-4)


@pytest.mark.parametrize("name, side, populations", [("HIGH", 1.0, 4), ("LOW", -1.0, 2)])
def test_probability_and_region_are_those_of_the_density(drops, name, side, populations):
    found = package.rare(drops, name, requirements="r.yaml", size=60, populations=populations, out="rare")
    one = estimate(found.populations, 0.99)
    assert one.low < norm.sf(3.0) < one.high and 0.1 < one.probability / norm.sf(3.0) < 10.0
    first, second, *_ = found.regions.items()
    assert first[0] == DENSITY and first[1].difference > 5.0 * second[1].difference
    beyond = norm.pdf(3.0) / norm.sf(3.0)  # mean of a truncated normal distribution
    assert side * first[1].mean == pytest.approx(beyond, abs=0.25)
    worst = max if side > 0.0 else min
    rows = found.failures
    assert rows[0]["peak_dynamic_pressure_pa"] == worst(row["peak_dynamic_pressure_pa"] for row in rows)
    assert len(found.levels) in (3, 4) and found.flights < 1100 and found.without_figure == {}


def test_a_worst_case_flies_again_from_its_file(edl6dof, drops):
    found = package.rare(drops, "HIGH", out="rare", **SMALL)
    for one in found.worst:
        assert edl6dof(*one["command"].split()[1:], "--no-replay", "--out", f"run{one['case']}")[0] == 0
        figures = package.open_run(f"run{one['case']}").figures
        assert figures["peak_dynamic_pressure_pa"] == one["value"]


def test_same_bits_for_any_number_of_workers_and_if_resumed(drops, monkeypatch):
    one = package.rare(drops, "HIGH", out="one", workers=1, **SMALL)
    two = package.rare(drops, "HIGH", out="two", workers=3, **SMALL)
    parts = sorted(Path("one/parts").glob("*.parquet"))
    assert len(parts) > 10
    for part in parts:
        assert part.read_bytes() == (Path("two/parts") / part.name).read_bytes()
    for part in sorted(Path("two/parts").glob("*"))[10:]:
        part.unlink()
    damaged = Path("two/parts/000003.parquet")
    damaged.write_bytes(damaged.read_bytes()[:-7])
    flown = []
    rows = CaseRunner.rows
    monkeypatch.setattr(CaseRunner, "rows", lambda self, *rest: flown.append(1) or rows(self, *rest))
    again = package.rare(drops, "HIGH", out="two", resume=True, **SMALL)
    assert len(flown) == len(parts) - 4
    for other in (two, again):
        assert other.estimate == one.estimate and other.regions == one.regions
        assert other.flights == one.flights == sum(pq.read_metadata(part).num_rows for part in parts)
        assert other.failures == one.failures
    flown.clear()
    assert package.rare(drops, "HIGH", out="two", resume=True, **SMALL).estimate == one.estimate and not flown


def test_another_seed_gives_other_flights(drops):
    one = package.rare(drops, "HIGH", out="one", **SMALL)
    other = package.rare(drops, "HIGH", out="other", seed=4, **SMALL)
    assert one.estimate != other.estimate


def test_a_folder_is_resumed_with_its_own_values_only(drops):
    package.rare(drops, "HIGH", out="rare", **SMALL)
    for changed in ({"size": 21}, {"populations": 3}, {"seed": 9}):
        with pytest.raises(ConfigError, match="was begun with other values"):
            package.rare(drops, "HIGH", out="rare", resume=True, **SMALL | changed)
    with pytest.raises(ConfigError, match="was begun with other values"):
        package.rare(drops, "LOW", out="rare", resume=True, **SMALL)
    with pytest.raises(ConfigError, match="exists"):
        package.rare(drops, "HIGH", out="rare", **SMALL)
    assert package.rare(drops, "LOW", out="rare", force=True, **SMALL).request.requirement.id == "LOW"
    Path("empty").mkdir()
    with pytest.raises(ConfigError, match="no rare.json"):
        package.rare(drops, "HIGH", out="empty", resume=True, **SMALL)


def test_flights_without_the_figure_are_failures_and_counted(edl6dof, drops):
    words = ("rare", drops, "r.yaml", "--requirement", "LAND", "-n", "20", "--out", "rare")
    status, out, _ = edl6dof(*words)
    assert status == 0 and "touchdown_vertical_m_s > 1 m/s: 1\n" in out
    assert "80 of 80 failures ended before they reached the figure (80: " in out and "not reached" in out


def test_the_command_prints_and_writes_the_result(edl6dof, drops):
    words = ("rare", drops, "r.yaml", "--requirement", "HIGH", "-n", "20", "--populations", "2")
    status, out, _ = edl6dof(*words)
    page = Path("runs/rare-drops/rare.html")
    assert status == 0 and DENSITY in out and page.is_file()
    status, out, _ = edl6dof(*words, "--resume", "--json")
    found = json.loads(out)
    assert status == 0 and found["requirement"]["id"] == "HIGH" and len(found["populations"]) == 2
    assert found["low"] < found["probability"] < found["high"]
    assert found["worst"][0]["command"].startswith("edl6dof fly runs/rare-drops/case")
    assert edl6dof(*words, "--force")[0] == 0


def test_the_folder_is_no_campaign(edl6dof, drops):
    package.rare(drops, "HIGH", out="rare", **SMALL)
    for words in (("assure", "rare"), ("campaign", "rare", "--resume"), ("refly", "rare", "0")):
        status, _, err = edl6dof(*words)
        assert status == 2 and "is not the folder of a campaign" in err


def test_bad_input_is_refused(edl6dof, drops, tmp_path):
    for words, message in (
        ((drops, "r.yaml", "--requirement", "LAN"), "no requirement 'LAN'; did you mean 'LAND'?"),
        ((drops, "--requirement", "HIGH"), "no requirement"),
        (("tianwen1", "--requirement", "HIGH"), "campaign:"),
        ((drops, "none.yaml", "--requirement", "HIGH"), "none.yaml"),
    ):
        status, out, err = edl6dof("rare", *words)
        assert status == 2 and out == "" and message in err
    file = Path(drops)
    file.write_text(file.read_text() + "sweep: {axes: [{path: wind.scale, of: truth, values: [0.0, 1.0]}]}\n")
    status, _, err = edl6dof("rare", drops, "r.yaml", "--requirement", "HIGH")
    assert status == 2 and "leave out sweep" in err and not Path("runs").exists()


def test_limits_of_the_scenario_are_requirements(edl6dof, drops):
    file = Path(drops)
    file.write_text("limits: {entry_dynamic_pressure_pa: 16.0}\n" + file.read_text())
    found = package.rare(drops, "peak_dynamic_pressure_pa", size=50, populations=2, out="rare")
    one = estimate(found.populations, 0.99)
    assert one.low < norm.sf(np.log(16.0 / NOMINAL_PA) / 0.1) < one.high


def test_a_drawn_fault_is_an_input(drops):
    """The numbers of a fault that may happen follow those of the dispersions, with the bits of a campaign."""
    file = Path(drops)
    fault = "{thruster: A1, kind: stuck_off, at: {time_s: 0.5}}"
    file.write_text(f"{file.read_text()}  faults: [{{chance: 0.25, one_of: [{fault}], later_s: 1.0}}]\n")
    plan = load_plan(drops)
    assert plan.numbers[-3:] == ["faults.0.happens", "faults.0.which", "faults.0.later"]
    cases, unit = list(plan.cases(0, 40)), plan.unit_numbers(0, 40)
    again = list(plan.cases_of(unit, range(40), range(40)))
    assert again == cases
    happened = np.array(["faults" in case.truth for case in cases])
    assert np.array_equal(happened, unit[:, -3] < 0.25) and 3 < happened.sum() < 20
    assert package.rare(drops, "HIGH", out="rare", **SMALL).regions["faults.0.happens"].spread > 0.2


def test_scores_of_correlated_parameters_are_correlated():
    plan = load_plan("tianwen1_mc")
    deviates = np.random.default_rng(1).normal(size=(4000, len(plan.numbers)))
    scores, values = (
        plan.scores(deviates),
        dict((target.path, column) for target, column in plan._values(norm.cdf(deviates))),
    )
    for name, score in zip(plan.numbers, scores.T, strict=True):
        own = values[name.partition(".")[2]]
        assert np.corrcoef(score, own)[0, 1] > 1.0 - 1e-9 and np.std(score) == pytest.approx(1.0, abs=0.04)
    inertia = [index for index, name in enumerate(plan.numbers) if "entry_inertia" in name]
    assert np.corrcoef(scores[:, inertia].T)[0, 1] == pytest.approx(0.9, abs=0.02)
