"""The comparison of powered laws: what is paired, what is measured, and that a small run of it comes out
whole.
"""

from math import inf, nan, sqrt

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

import edl6dof
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.scenario.records import build_records
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.studies import landing
from edl6dof.studies.landing import DISPERSED, POWERED, divert


def row(law, flight=0, condition=DISPERSED, **figures_):
    return {
        "law": law,
        "flight": flight,
        "condition": condition,
        "came_down": True,
        **figures_,
    }


def test_every_powered_law_is_compared():
    assert POWERED_LAWS.names == landing.LAWS
    assert {"polynomial", "gravity_turn", "e_guidance", "apollo", "constant_thrust"} <= set(landing.LAWS)


def test_difference_is_of_the_same_flights_and_its_interval_that_of_their_mean():
    fuel = {"polynomial": [60.0, 70.0, 80.0, 90.0], "apollo": [61.0, 73.0, 82.0, nan]}
    rows = [row(law, i, hover_fuel_kg=kg) for law, every in fuel.items() for i, kg in enumerate(every)]
    mean, half = landing.difference(rows, "apollo", "hover_fuel_kg")
    assert mean == pytest.approx(2.0)
    assert half == pytest.approx(1.96 * 1.0 / sqrt(3))
    assert landing.difference(rows, "polynomial", "hover_fuel_kg") == (0.0, 0.0)
    assert np.all(np.isnan(landing.difference(rows[4:], "apollo", "hover_fuel_kg")))  # no reference flown


@pytest.mark.parametrize(
    "figure, value",
    [("target_miss_m", 5.1), ("hover_speed_m_s", 5.1), ("hover_off_m", -10.1), ("target_miss_m", inf)],
)
def test_target_is_reached_only_within_every_tolerance(figure, value):
    good = {"target_miss_m": 4.9, "hover_speed_m_s": 4.9, "hover_off_m": -9.9}
    assert landing.reached(row("apollo", **good))
    assert not landing.reached(row("apollo", **{**good, figure: value}))
    assert not landing.reached(row("apollo"))  # never came to hover


def test_laws_meet_the_same_cases_and_only_they_differ():
    truths = landing.dispersed(20)
    scenario = edl6dof.load(landing.SCENARIO).scenario
    ours, theirs = (landing.cases(scenario, truths, law) for law in ("apollo", "polynomial"))
    for one, other in zip(ours, theirs, strict=True):
        assert (one.index, one.truth, one.belief, one.profile) == (
            *(other.index, other.truth, other.belief, other.profile),
        )
        assert {**one.label, "law": ""} == {**other.label, "law": ""}
    counts = {c: sum(one.label["condition"] == c for one in ours) for c in (DISPERSED, divert(600.0))}
    assert counts == {DISPERSED: 20, divert(600.0): 2}
    # a shorter run flies the first of a longer one
    assert truths[3].truth == landing.dispersed(4)[3].truth


def test_miss_is_small_and_saturation_grows_with_the_divert():
    found = {}
    for metres in (0.0, 600.0):
        flight = edl6dof.fly("tianwen1", [f"{POWERED}.target.divert_m={metres}", "simulation.log_every=5"])
        found[metres] = landing.of_flight(flight)
    for one in found.values():
        assert one["navigated_miss_m"] < 5.0
        assert 0.0 < one["hover_fuel_kg"] < one["ground_fuel_kg"]
    assert found[600.0]["saturated_s"] > found[0.0]["saturated_s"] + 5.0
    assert found[600.0]["peak_tilt_deg"] > found[0.0]["peak_tilt_deg"] + 10.0


def test_no_powered_law_allocates():
    """Counted by numba's own runtime: twenty calls allocate no more than one."""
    _nrt_python.memsys_enable_stats()
    loaded = edl6dof.load("tianwen1")
    onboard, state = build_records(loaded).onboard, snapshots_at(loaded, [460.0])[0].fsw
    records = [np.zeros(1, dtype) for dtype in (VEHICLE_STATE, NAV, POWERED_TARGET)]
    for record, saved in zip(
        records, (state["vehicle"], state["nav"], state["guidance"]["target"]), strict=True
    ):
        record[0] = saved[0]
    memories = [np.zeros(1, POWERED_LAWS.memory) for _ in range(2)]
    for law, name in enumerate(POWERED_LAWS.names):
        onboard["guidance"]["powered"]["law"] = law
        function, counts = chosen("powered_law", onboard[0]), []
        for repeats in (1, 1, 20):
            before = rtsys.get_allocation_stats().alloc
            landing._repeat(function, onboard, *records, *memories, np.zeros(1, GUIDE), repeats)
            counts.append(rtsys.get_allocation_stats().alloc - before)
        assert counts[1] == counts[2], name


def test_small_run_comes_out_whole(monkeypatch):
    monkeypatch.setattr(landing, "DIVERTS", (0.0, 600.0))
    monkeypatch.setattr(landing, "ENGINE_FAULTS", {"dead 20 s": (20.0, "engine_dead", {})})
    monkeypatch.setattr(landing, "LATE_RELEASES", (300.0,))
    monkeypatch.setattr(landing, "SAVED_AFTER_S", (9.0,))
    seen, laws = [], ("polynomial", "gravity_turn")
    report = landing.STUDY.fly(2, laws, lambda done, total: seen.append((done, total)))
    assert report.runs == len(report.rows) == 12 and seen[-1] == (12, 12)
    rows = report.rows
    for one, other in zip(rows[:6], rows[6:], strict=True):  # the same until the engine lights
        assert (one["law"], other["law"]) == ("polynomial", "gravity_turn")
        for name in ("ignition_height_m", "ignition_descent_m_s", "ignition_drift_m_s"):
            assert one[name] == other[name]
    fuel, miss, navigated, kept, diverts, late, faults = report.grids
    assert "n = 2 too small: 50 % needs 6" in miss.title and miss.rows == navigated.rows
    assert [line[0] for line in fuel.rows] == ["polynomial", "gravity_turn"]
    assert fuel.rows[0][2] == 0.0 and fuel.rows[1][2] != 0.0
    assert kept.rows[1][-2] == 100.0 and 0.0 < kept.rows[1][-1] < 50.0
    assert diverts.rows[0][4] > diverts.rows[0][1]  # a divert costs
    assert late.rows[0][1] > 20.0  # too low for any law
    faster = next(finding for finding in report.findings if "late releases" in finding.label)
    assert faster.label.startswith("polynomial: faster than gravity_turn") and abs(faster.computed) < 0.5
    assert faults.rows[0][1] > 30.0  # without its engine it crashes
    dead = next(finding for finding in report.findings if finding.label.startswith("dead"))
    assert dead.computed == 0.0 and "after main engine dead" in dead.note
    assert list(report.pictures) == ["comparison"]
