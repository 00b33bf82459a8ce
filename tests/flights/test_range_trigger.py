"""The parachute opened by range: abeam of the aim point whatever the wind, inside the speeds allowed for it,
and at their edge where the aim point is out of reach.
"""

from __future__ import annotations

import pytest

import edl6dof

ENTRY = "flight_software.guidance.entry"
#: Speed (m/s) above which the scenario does not open, and below which it opens wherever it is.
FASTEST, SLOWEST = 480.0, 345.0
#: A guidance call at 5 Hz and 0.48 km/s.  The error of navigation comes on top.
ABEAM_M = 100.0


def beyond_what_navigation_errs(figures):
    """Distance (m) along the track from the point abeam of the aim point, less the error of navigation."""
    return abs(figures["parachute_downrange_m"]) - figures["parachute_nav_position_m"]


@pytest.fixture(scope="module")
def flight():
    return edl6dof.fly("msl_range_trigger")


def test_opens_abeam_of_the_aim_point_within_limits(flight):
    assert flight.outcome == "deployed within limits"
    assert beyond_what_navigation_errs(flight.figures) < ABEAM_M
    assert SLOWEST < flight.figures["parachute_speed_m_s"] < FASTEST


@pytest.mark.parametrize("scale", [-1.0, pytest.param(0.0, marks=pytest.mark.long)])
def test_wind_moves_the_speed_at_the_mortar_and_not_the_place(scale):
    wind = [f"wind.scale={scale}"]
    by_range = edl6dof.fly("msl_range_trigger", wind).figures
    by_speed = edl6dof.fly("msl", wind).figures
    assert beyond_what_navigation_errs(by_range) < ABEAM_M
    assert abs(by_speed["parachute_downrange_m"]) > 1500.0
    assert abs(by_range["parachute_speed_m_s"] - by_speed["parachute_speed_m_s"]) > 3.0


@pytest.mark.parametrize(("bank_deg", "speed"), [(0.0, FASTEST), (90.0, SLOWEST)])
def test_opens_at_the_edge_of_the_speeds_where_the_aim_point_is_out_of_reach(bank_deg, speed):
    """Flown far beyond it with the lift up, and short of it with none."""
    law = [f"{ENTRY}.law=constant_bank", f"{ENTRY}.constant_bank.bank_deg={bank_deg}"]
    flown = edl6dof.fly("msl_range_trigger", law).figures
    assert abs(flown["parachute_downrange_m"]) > 10e3
    assert flown["parachute_speed_m_s"] == pytest.approx(speed, abs=3.0)
