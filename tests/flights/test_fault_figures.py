"""The figures of ``tools/fault_figures.py`` on a few dispersed flights; the tool flies 400 and
more.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows

TOOL = Path(__file__).resolve().parents[2] / "tools" / "fault_figures.py"
FLIGHTS = 3
#: Real instruments, without flow meters.
WITHOUT_METERS = ("sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]",)


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("fault_figures", TOOL)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def plan():
    return load_plan("tianwen1_mc", cases=FLIGHTS)


def test_dead_horizontal_thruster_is_named_and_every_flight_lands(tool, plan):
    rows = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, "stuck_off"), collect=tool.isolated))
    begun = [row for row in rows if row.get("fault_s") is not None]
    assert len(begun) >= FLIGHTS - 1
    assert all(row["name_right"] for row in begun)
    # how far from the site is a matter of the dispersed entry
    assert all(row["outcome"].startswith("landed") and row["false_alarms"] == 0.0 for row in begun)
    times = sorted(row["isolation_s"] for row in begun)
    assert times[len(times) // 2] < 1.0


@pytest.mark.long  # of the suite: test_faults_in_flight.py
@pytest.mark.parametrize("seed", [7, 11, 13])
def test_stuck_thruster_is_named_at_any_moment_of_any_flight(tool, plan, seed):
    """Thruster, moment, winds, vehicle and direction of the divert are drawn for each flight."""
    rows = list(
        fly_rows(plan.loaded, tool.dispersed(plan, seed, "stuck_on", tool.STRONG), collect=tool.isolated)
    )
    begun = [row for row in rows if row.get("fault_s") is not None]
    assert len(begun) >= FLIGHTS - 1
    assert all(row["name_right"] for row in begun)
    assert all(row["outcome"].startswith("landed") and row["false_alarms"] == 0.0 for row in begun)


@pytest.mark.long
def test_no_thruster_is_isolated_without_a_fault(tool, plan):
    rows = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, None), collect=tool.isolated))
    assert [row["isolated"] for row in rows] == [""] * FLIGHTS


@pytest.fixture(scope="module")
def without_meters():
    return load_plan("tianwen1_mc", WITHOUT_METERS, cases=FLIGHTS)


@pytest.mark.parametrize(
    ("kind", "which"),
    [("stuck_off", "HORIZONTAL"), pytest.param("stuck_on", "STRONG", marks=pytest.mark.long)],
)
def test_thruster_is_named_by_force_and_torque_where_there_are_no_meters(tool, without_meters, kind, which):
    """With the noise of the inertial unit, its lever arm, and vibration with the engine; a dead thruster may
    pass for a weak one.
    """
    cases = tool.dispersed(without_meters, 7, kind, getattr(tool, which))
    rows = list(fly_rows(without_meters.loaded, cases, collect=tool.isolated))
    begun = [row for row in rows if row.get("fault_s") is not None]
    assert len(begun) >= FLIGHTS - 1
    assert all(row["name_right"] for row in begun)
    assert all(row["outcome"].startswith("landed") and not row["sound_named"] for row in begun)
    times = sorted(row["isolation_s"] for row in begun)
    assert times[len(times) // 2] < 1.5


def test_force_and_torque_feign_no_fault_where_there_are_no_meters(tool, without_meters):
    rows = list(
        fly_rows(without_meters.loaded, tool.dispersed(without_meters, 7, None), collect=tool.isolated)
    )
    assert [row["isolated"] for row in rows] == [""] * FLIGHTS


def test_vibration_too_strong_hides_a_fault_from_force_and_torque_and_feigns_none(tool):
    """Where diagnosis without meters breaks it falls silent: tools/diagnosis_limits.py."""
    unit = "sensors.inertial_unit.vibration"
    strong = (*WITHOUT_METERS, f"{unit}.acceleration_m_s2=9.0", f"{unit}.rate_deg_s=0.6")
    plan = load_plan("tianwen1_mc", strong, cases=FLIGHTS)
    dead = list(fly_rows(plan.loaded, tool.dispersed(plan, 7, "stuck_off"), collect=tool.isolated))
    assert sum(row["name_right"] for row in dead) <= 1
    assert all(row["false_alarms"] == 0.0 for row in dead)
