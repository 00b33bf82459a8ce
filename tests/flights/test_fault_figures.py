"""The figures of ``tools/fault_figures.py`` on a few dispersed flights; the tool flies 400 and
more.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from chance import fewest

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows

TOOL = Path(__file__).resolve().parents[2] / "tools" / "fault_figures.py"
FLIGHTS = 6
#: Instruments of ``tianwen1_meters``.
METERS = ("sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches, flow_meters]",)


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("fault_figures", TOOL)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def plan():
    """Flights by force and torque alone, without flow meters."""
    return load_plan("tianwen1_mc", cases=FLIGHTS)


@pytest.fixture(scope="module")
def metered():
    return load_plan("tianwen1_mc", METERS, cases=FLIGHTS)


def flown(tool, plan, cases):
    """Rows of the flights that lasted until their fault."""
    rows = list(fly_rows(plan.loaded, cases, collect=tool.isolated))
    begun = [row for row in rows if row.get("fault_s") is not None]
    assert len(begun) >= fewest(len(rows), 0.95)
    return begun


def often(rows, true):
    """Whether something is true of as many rows as of flights of which it is true of 95 %."""
    return sum(bool(true(row)) for row in rows) >= fewest(len(rows), 0.95)


def test_dead_horizontal_thruster_is_named_and_the_flights_land_with_meters(tool, metered):
    begun = flown(tool, metered, tool.dispersed(metered, 7, "stuck_off"))
    assert often(begun, lambda row: row["name_right"])
    # how far from the site is a matter of the dispersed entry
    assert often(begun, lambda row: row["outcome"].startswith("landed"))
    assert often(begun, lambda row: row["false_alarms"] == 0.0)
    assert np.median([row["isolation_s"] for row in begun if row["name_right"]]) < 1.0


@pytest.mark.long  # of the suite: test_faults_in_flight.py
def test_stuck_thruster_is_named_at_any_moment_of_any_flight_with_meters(tool, metered):
    """Thruster, moment, winds, vehicle and direction of the divert are drawn for each flight."""
    begun = [
        row
        for seed in (7, 11, 13)
        for row in flown(tool, metered, tool.dispersed(metered, seed, "stuck_on", tool.STRONG))
    ]
    assert often(begun, lambda row: row["name_right"])
    assert often(begun, lambda row: row["outcome"].startswith("landed"))
    assert often(begun, lambda row: row["false_alarms"] == 0.0)


@pytest.mark.long
def test_no_thruster_is_isolated_without_a_fault_with_meters(tool, metered):
    rows = list(fly_rows(metered.loaded, tool.dispersed(metered, 7, None), collect=tool.isolated))
    assert len(rows) == FLIGHTS and often(rows, lambda row: row["isolated"] == "")


@pytest.mark.parametrize(
    ("kind", "which"),
    [("stuck_off", "HORIZONTAL"), pytest.param("stuck_on", "STRONG", marks=pytest.mark.long)],
)
def test_thruster_is_named_by_force_and_torque(tool, plan, kind, which):
    """With the noise of the inertial unit, its lever arm, and vibration with the engine; a dead thruster may
    pass for a weak one.
    """
    begun = flown(tool, plan, tool.dispersed(plan, 7, kind, getattr(tool, which)))
    assert often(begun, lambda row: row["name_right"])
    assert often(begun, lambda row: row["outcome"].startswith("landed"))
    assert often(begun, lambda row: not row["sound_named"])
    assert np.median([row["isolation_s"] for row in begun if row["name_right"]]) < 1.5


def test_force_and_torque_feign_no_fault(tool, plan):
    rows = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, None), collect=tool.isolated))
    assert len(rows) == FLIGHTS and often(rows, lambda row: row["isolated"] == "")


def test_a_jerk_of_the_canopy_that_follows_the_latch_valve_by_chance_names_no_leak(tool):
    """In an unexpected wind of 40 m/s, the flight of a thousand in which A1 was named when the jerk counted
    with every later movement.
    """
    wind = "wind={model: constant, constant: {north_m_s: 40}}"
    plan = load_plan("tianwen1_mc", (wind,), cases=125, seed=7001)
    (row,) = fly_rows(plan.loaded, plan.cases(118, 119), collect=tool.isolated)
    assert row["isolated"] == ""


def test_a_tone_of_any_strength_hides_no_fault_from_force_and_torque(tool):
    """It is predicted, and so removed from the residual."""
    unit = "sensors.inertial_unit.vibration"
    tone = (f"{unit}.acceleration_m_s2=9.0", f"{unit}.rate_deg_s=0.6")
    plan = load_plan("tianwen1_mc", tone, cases=FLIGHTS)
    dead = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, "stuck_off"), collect=tool.isolated))
    assert often(dead, lambda row: row["name_right"])
    assert often(dead, lambda row: not row["sound_named"])


def test_vibration_too_strong_hides_a_fault_from_force_and_torque_and_feigns_none(tool):
    """Where diagnosis without meters breaks it falls silent: tools/diagnosis_limits.py. A tone can be
    predicted; a random vibration cannot.
    """
    unit = "sensors.inertial_unit.vibration.random"
    strong = (f"{unit}.acceleration_g0=2.2", f"{unit}.rate_deg_s=1.4")
    plan = load_plan("tianwen1_mc", strong, cases=FLIGHTS)
    dead = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, "stuck_off"), collect=tool.isolated))
    assert often(dead, lambda row: not row["name_right"])
    assert often(dead, lambda row: row["false_alarms"] == 0.0)
