"""The MSL-class vehicle: the published figures it stands for, and its entry."""

import numpy as np
import pytest

import edl6dof
from edl6dof.scenario.records import build_records


@pytest.fixture(scope="module")
def flight():
    return edl6dof.fly("msl")


def test_believed_airframe_has_the_published_ballistic_coefficient_and_lift_to_drag_ratio(flight):
    """Wu 2013 and others: 3300 kg, 15.9 m2, CD 1.45, L/D 0.24, so 143 kg/m2."""
    vehicle = build_records(flight.loaded).onboard[0]["vehicle"]
    assert vehicle["entry_mass"] / vehicle["drag_area"] == pytest.approx(3300.0 / (15.9 * 1.45), rel=0.03)
    assert vehicle["lift_to_drag"] == pytest.approx(0.24, abs=0.01)


def test_entry_ends_at_the_parachute_within_limits_near_the_aim_point(flight):
    assert flight.outcome == "deployed within limits"
    assert flight.success
    # by planet-relative speed: the wind is not known on board
    assert flight.metrics["parachute_mach"] == pytest.approx(1.7, abs=0.12)
    assert flight.metrics["parachute_miss_m"] < 3000.0


def test_vehicle_trims_as_planned_and_is_straightened_before_the_parachute(flight):
    t = flight.telemetry
    dense = (t["truth.dynamic_pressure_pa"] > 1000.0) & (t["truth.mach"] > 4.0)
    ratio = np.hypot(t["truth.aero_force_y_n"], t["truth.aero_force_z_n"])
    assert np.mean(t["truth.alpha_deg"][dense]) == pytest.approx(-16.5, abs=2.0)
    # lift comes from the axial force, not from CN
    assert np.all(ratio[dense] < 0.1 * -t["truth.aero_force_x_n"][dense])
    assert flight.metrics["parachute_total_alpha_deg"] < 5.0


def test_loads_are_those_of_an_entry_at_minus_fifteen_degrees(flight):
    """MSL was designed for 15 g; its guided entry peaked between 11 and 13 g (recalled)."""
    assert 10.0 < flight.metrics["peak_load_g0"] < 15.0
    assert flight.metrics["bank_reversals"] >= 3
