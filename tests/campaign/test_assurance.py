"""Requirements judged by the flights of a campaign: closed forms, simulated risks, and the command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from campaign_run import write_drop
from scipy import stats

import edl6dof as package
from edl6dof.campaign.assurance import Requirement, flights_to_verify, judge, share_bounds
from edl6dof.campaign.design.sampling import unit_numbers
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.campaign_results import Results

LIMITS = "limits: {entry_dynamic_pressure_pa: 900.0, entry_load_g0: 15.0}\n"
REQUIREMENTS = """\
requirements:
  - {id: R1, text: Small load, figure: peak_load_g0, at_most: 15.0, share: 0.95}
  - {id: R2, text: No air, figure: peak_dynamic_pressure_pa, at_most: 1.0, share: 0.9, confidence: 0.95}
  - {id: R3, text: Some pressure, figure: peak_dynamic_pressure_pa, at_least: 1.0, share: 0.999}
"""
BAD = """\
requirements:
  - {id: R1, text: one, figure: peak_load, at_most: 3.6, share: 99.73}
  - {id: R1, text: two, figure: peak_load_g0, at_most: 4.0, at_least: 3.0, share: 0.99, confidense: 0.9}
  - {id: R3, figure: peak_load_g0, share: 0.95}
"""


def requirement(share=0.99, **changes) -> Requirement:
    given = {"id": "R", "text": "r", "figure": "peak_load_g0", "at_most": 0.0, "share": share}
    return Requirement(**given | changes)


def judged(values, failed=False, **changes):
    values = np.asarray(values, dtype=float)
    return judge(requirement(**changes), values, np.broadcast_to(failed, values.shape))


@pytest.mark.parametrize(
    "share, flights", [(0.9973, [852, 1440, 1970, 2473]), (0.99865, [1705, 2880, 3941, 4947])]
)
def test_flights_that_verify_a_share_are_those_of_the_binomial_distribution(share, flights):
    assert [flights_to_verify(failures, share, 0.9) for failures in range(4)] == flights
    for failures, n in enumerate(flights):
        chance = stats.binom(n, 1.0 - share).cdf(failures)
        assert chance <= 0.1 < stats.binom(n - 1, 1.0 - share).cdf(failures)
        values = np.where(np.arange(n) < failures, 1.0, -1.0)
        assert judged(values, share=share).verdict == "verified"
        assert judged(values[:-1], share=share).verdict == "undecided"
    assert flights_to_verify(0, 0.99999, 0.9) == 230_258


def test_997_of_1000_flights_demonstrate_99_33_percent():
    low, high = share_bounds(3, 1000, 0.9)
    assert 0.99333 < low < 0.99334
    assert stats.binom(1000, 1.0 - low).cdf(3) == pytest.approx(0.1, abs=1e-9)
    assert stats.binom(1000, 1.0 - high).sf(2) == pytest.approx(0.1, abs=1e-9)
    assert share_bounds(0, 10, 0.9)[1] == 1.0 and share_bounds(10, 10, 0.9)[0] == 0.0
    exact = stats.binomtest(997, 1000).proportion_ci(0.8, method="exact")  # 10 % on each side
    assert (exact.low, exact.high) == pytest.approx((low, high), abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_requirement_is_verified_exactly_if_the_bound_of_the_figure_is_within_the_limit(sign):
    rng = np.random.default_rng(7)
    seen = set()
    for _ in range(300):
        values = sign * rng.normal(size=int(rng.integers(20, 400)))
        limit = sign * float(rng.uniform(0.8, 3.0))
        side = {"at_most": limit} if sign > 0.0 else {"at_most": None, "at_least": limit}
        one = judged(values, share=0.95, **side)
        within = one.bound is not None and sign * one.bound <= sign * limit
        assert within == (one.verdict == "verified")
        assert one.failures == np.sum(sign * values > sign * limit)
        assert sign * one.worst[0][1] == max(sign * values) == sign * values[one.worst[0][0]]
        seen.add(one.verdict)
    assert seen == {"verified", "violated", "undecided"}


def test_flights_that_failed_or_have_no_value_are_failures_and_the_worst():
    values = np.full(300, -1.0)
    assert judged(values).failures == 0
    values[[5, 7]] = np.nan, 3.0
    failed = np.zeros(300, bool)
    failed[9] = True
    one = judged(values, failed)
    rows = [row for row, _ in one.worst]
    assert one.failures == 3 and set(rows) == {5, 7, 9} and rows[-1] == 7
    assert judged(np.full(300, np.nan)).verdict == "violated"
    assert judged(np.full(300, np.nan)).bound is None


def test_a_failure_that_no_limit_explains_is_one_of_every_requirement():
    """Five landings: a success, one outside a limit, one that tipped over within the limits, one lost before
    touchdown outside a limit, and one that could not fly.
    """
    columns = {
        "peak_load_g0": np.array([9.0, 16.0, 9.0, 16.0, np.nan]),
        "touchdown_tilt_deg": np.array([1.0, 1.0, 1.0, np.nan, np.nan]),
    }

    class Landings(dict):
        ok = np.array([True, False, False, False, False])
        limits = [(figure_of_merit("peak_load_g0"), 15.0), (figure_of_merit("touchdown_tilt_deg"), 4.0)]

    landings = Landings(columns)
    assert Results.failed.func(landings).tolist() == [False, False, True, True, True]
    landings.limits = []
    assert Results.failed.func(landings).tolist() == [False, True, True, True, True]


@pytest.mark.parametrize("flights", [60, 230, 388])
def test_consumer_and_producer_risk_of_independent_flights(flights):
    """With a true share equal to the required one, each wrong verdict comes up in at most one of ten."""
    rng, repetitions, limit = np.random.default_rng(flights), 2000, stats.norm.ppf(0.99)
    found = [judged(rng.normal(size=flights), at_most=limit).verdict for _ in range(repetitions)]
    failures = stats.binom(flights, 0.01)
    verdicts = {k: judged(np.where(np.arange(flights) < k, 1.0, -1.0)).verdict for k in range(flights)}
    for verdict in ("verified", "violated"):
        chance = sum(failures.pmf(k) for k in verdicts if verdicts[k] == verdict)
        assert chance <= 0.1
        spread = np.sqrt(chance * (1.0 - chance) / repetitions)
        assert abs(found.count(verdict) / repetitions - chance) <= 4.0 * spread


@pytest.mark.parametrize("sampling", ["latin_hypercube", "sobol"])
def test_consumer_risk_of_stratified_flights_is_smaller(sampling):
    """Failures of a sum that rises with each input; a true share equal to the required one."""
    names, flights = [f"input {k}" for k in range(4)], 230
    limit, verified = 2.0 * stats.norm.ppf(0.99), 0
    for seed in range(300):
        unit = unit_numbers(sampling, seed, names, flights, 0, flights)
        verified += judged(stats.norm.ppf(unit).sum(axis=1), at_most=limit).verdict == "verified"
    assert verified <= 30


def test_repeated_decisions_have_a_larger_consumer_risk():
    """A campaign flown until it verifies, with up to 0, 1, 2 and 3 failures: numbers of the how-to page."""
    waiting, before, risk, found = np.array([1.0]), 0, 0.0, []
    for allowed in range(4):
        flights = flights_to_verify(allowed, 0.99, 0.9)
        waiting = np.convolve(waiting, stats.binom(flights - before, 0.01).pmf(np.arange(60)))
        risk += waiting[: allowed + 1].sum()
        waiting[: allowed + 1], before = 0.0, flights
        found.append(round(100.0 * risk, 1))
    assert found == [9.9, 14.6, 17.7, 20.0]


@pytest.fixture
def drops(edl6dof, tmp_path):
    """A campaign of 60 drops with limits, in ``runs/drops``."""
    file = Path(write_drop(tmp_path))
    file.write_text(LIMITS + file.read_text())
    assert edl6dof("campaign", str(file), "-n", "60", "-q")[0] == 0
    return str(file)


def test_limits_of_the_scenario_are_requirements(edl6dof, drops):
    status, out, _ = edl6dof("assure", "runs/drops")
    assert status == 1 and out.startswith("drops: 0 of 2 requirements verified, 2 undecided\n")
    assert "limits of the scenario, share 99 %, confidence 90 %" in out
    assert "demonstrated with 90 % confidence: 96.23 %" in out and "undecided: needs 230" in out
    assert Path("runs/drops/assurance.html").is_file()
    command = "edl6dof campaign runs/drops/campaign.yaml -n 230 --out runs/drops-230"
    assert f"For the undecided: {command}. " in out
    assert edl6dof(*command.split()[1:], "-q")[0] == 0
    status, out, _ = edl6dof("assure", "runs/drops-230")
    assert status == 0 and "2 of 2 requirements verified\n" in out and "For the undecided" not in out
    assert edl6dof("campaign", drops, "-n", "4", "-q", "--force")[0] == 0  # the page is of the campaign


def test_a_file_of_requirements_is_judged(edl6dof, drops):
    Path("r.yaml").write_text(REQUIREMENTS)
    status, out, _ = edl6dof("assure", "runs/drops", "r.yaml", "--json")
    assert status == 1 and not Path("runs/drops/assurance.html").exists()
    found = json.loads(out)
    first, second, third = found["requirements"]
    assert [one["verdict"] for one in (first, second, third)] == ["verified", "violated", "undecided"]
    assert [one["failures"] for one in (first, second, third)] == [0, 60, 0]
    assert third["needed"] == 2302 and first["bound"] < 15.0 and second["demonstrated"] == 0.0
    table = package.open_run("runs/drops")
    assert second["worst"][0]["case"] == table.worst("peak_dynamic_pressure_pa")
    status, out, _ = edl6dof(*second["worst"][0]["command"].split()[1:], "--no-replay")
    assert status == 0 and "identical to its row" in out
    assert {row["factor"]: row["command"] for row in found["credibility"]}["use history"] == ""
    judged = package.assure(table, "r.yaml", out="board.pdf")
    assert json.loads(json.dumps(judged.data)) == found and not judged.verified
    assert Path("board.pdf").read_bytes().startswith(b"%PDF")
    with pytest.raises(ValueError, match="in memory only"):
        package.assure(package.campaign(drops, cases=2))


def test_every_mistake_of_a_file_is_reported_with_its_line(edl6dof, drops):
    Path("bad.yaml").write_text(BAD)
    status, out, err = edl6dof("assure", "runs/drops", "bad.yaml")
    assert status == 2 and out == ""
    lines = [line.removeprefix("bad.yaml:") for line in err.splitlines()]
    assert [line.partition(":")[0] for line in lines] == ["2", "2", "3", "3", "3", "4", "4"]
    for line, words in (
        (0, "requirements.0.figure: no figure 'peak_load'; did you mean 'peak_load_g0'?"),
        (1, "requirements.0.share: must be > 0 and < 1 (got 99.73)"),
        (2, "requirements.1.id: must be given once (got 'R1' twice)"),
        (3, "requirements.1.at_most: give one of at_most and at_least (got at_most and at_least)"),
        (4, "requirements.1.confidense: unknown key; did you mean 'confidence'?"),
        (5, "requirements.2.text: required key is missing"),
        (6, "requirements.2.at_most: give one of at_most and at_least (got none)"),
    ):
        assert words in lines[line]
    for words in (["none.yaml"], ["bad.yaml", "--out", "x.txt"]):
        assert edl6dof("assure", "runs/drops", *words)[0] == 2
    assert edl6dof("assure", "nowhere")[0] == 2


def test_flights_that_are_no_random_sample_are_refused(edl6dof, tmp_path):
    file = Path(write_drop(tmp_path))
    plain = LIMITS + file.read_text()
    for name, section, words in (
        ("grid", "sweep: {axes: [{path: wind.scale, of: truth, values: [0.0, 1.0]}]}\n", "points of a grid"),
        (
            "matrix",
            "fault_matrix: {groups: [{kind: stuck_off, component: thruster, names: [A1], "
            "moments: [{name: soon, at: {time_s: 1.0}}]}]}\n",
            "cells of a fault matrix",
        ),
    ):
        file.write_text(plain + section)
        assert edl6dof("campaign", str(file), "-n", "2", "-q", "--out", name)[0] in (0, 1)
        status, out, err = edl6dof("assure", name)
        assert status == 2 and out == "" and words in err


def test_only_independent_flights_of_a_sobol_design_count(edl6dof, tmp_path):
    file = Path(write_drop(tmp_path))
    file.write_text(LIMITS + file.read_text())
    assert edl6dof("campaign", str(file), "-n", "8", "-q", "--sampling", "sobol_indices")[0] == 0
    found = json.loads(edl6dof("assure", "runs/drops", "--json")[1])
    assert found["flights"] == 16 and "matrices A and B" in found["notes"][1]
    assert found["next"] == "edl6dof campaign runs/drops/campaign.yaml -n 115 --out runs/drops-115"


def test_conditions_of_the_verdicts_are_stated(edl6dof, tmp_path):
    file = Path(write_drop(tmp_path))
    file.write_text(LIMITS + file.read_text().replace("  seed: 3", "  seed: 3\n  sampling: sobol"))
    until = "p_success +- 10%"
    assert edl6dof("campaign", str(file), "-q", "--until", until)[0] == 0
    notes = json.loads(edl6dof("assure", "runs/drops", "--json")[1])["notes"]
    assert any("stratified (sobol)" in words for words in notes)
    assert any(f"stopped early ({until})" in words for words in notes)
    assert any("random from flight to flight" in words for words in notes)
    Path("runs/drops/summary.json").unlink()
    status, _, err = edl6dof("assure", "runs/drops")
    assert status == 2 and "is not complete" in err


def test_a_scenario_without_limits_needs_a_file(edl6dof, tmp_path):
    assert edl6dof("campaign", write_drop(tmp_path), "-n", "3", "-q")[0] == 0
    status, _, err = edl6dof("assure", "runs/drops")
    assert status == 2 and "has no limits: name a file of requirements" in err
