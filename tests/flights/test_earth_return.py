"""Spin-stabilised returns to Earth: Stardust from 135 km to the salt flats, Genesis without its parachutes,
both from YAML alone.
"""

import numpy as np
import pytest

import edl6dof


@pytest.fixture(scope="module")
def stardust():
    return edl6dof.fly("stardust")


def test_stardust_comes_down_at_the_target_under_its_parachutes(stardust):
    assert stardust.termination.success, stardust.termination.outcome
    keys = [event["key"] for event in stardust.events]
    assert [key for key in keys if key in ("drogue", "main", "touchdown")] == ["drogue", "main", "touchdown"]
    figures = stardust.figures
    assert figures["landing_distance_m"] < 500.0  # the entry was laid so: no prediction
    # before the flight: Mach 1.4 at the drogue; by reconstruction 32.89 g0 and 4 to 5 m/s at the ground
    assert figures["parachute_mach"] == pytest.approx(1.4, abs=0.08)
    assert figures["peak_load_g0"] == pytest.approx(32.89, rel=0.05)
    assert 3.5 < figures["touchdown_vertical_m_s"] < 5.0


def test_nothing_changes_the_spin(stardust):
    entry = stardust.telemetry["t_s"] < stardust.figures["parachute_s"]
    roll = stardust.telemetry["truth.rate_p_deg_s"][entry]
    assert roll[0] == pytest.approx(81.0, abs=1e-4)
    assert roll == pytest.approx(np.full(len(roll), roll[0]), abs=1e-9)


def test_nutation_without_air_is_that_of_a_symmetric_top():
    """Lateral rates turn in the body at (Ixx/Iyy - 1) p, and keep their length."""
    overrides = ("vehicle.aero.model=none", "initial.rate_deg_s=[81, 6, 0]", "simulation.time_limit_s=40")
    t = edl6dof.fly("stardust", [*overrides, "mission={goal: time, phases: []}"]).telemetry
    q, r = t["truth.rate_q_deg_s"], t["truth.rate_r_deg_s"]
    turned = np.unwrap(np.arctan2(r, q))
    expected = (2.1 / 1.8 - 1.0) * np.radians(81.0) * t["t_s"]
    assert np.abs(turned) == pytest.approx(expected, abs=1e-4)
    assert np.hypot(q, r) == pytest.approx(np.full(len(q), np.hypot(q[0], r[0])), abs=1e-5)


def test_genesis_without_parachutes_strikes_the_ground():
    flight = edl6dof.fly("genesis")
    assert flight.termination.outcome.startswith("crashed") and not flight.termination.success
    # 86 m/s was flown, tumbling: nose first it is slower, and the scenario says so
    assert 40.0 < flight.figures["touchdown_vertical_m_s"] < 60.0
    assert 25.0 < flight.figures["peak_load_g0"] < 32.0
