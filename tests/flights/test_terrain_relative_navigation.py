"""Verifies: landmarks of a map make the position known before the backshell is released, with several seeds
and shares of wrong matches, and the lander reaches a site of the map; without the camera it does not know it.
"""

import pytest

import edl6dof

#: Requirement of Mars 2020 on the position (m).
REQUIRED_M = 40.0


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("wrong_share", [0.2, 0.4])
def test_position_is_known_before_the_backshell_is_released(seed, wrong_share):
    wrong = f"sensors.landmark_camera.wrong_share={wrong_share}"
    flight = edl6dof.fly("tianwen1_trn", [f"seed={seed}", wrong, "simulation.log_every=50"])
    assert flight.success
    assert flight.figures["backshell_nav_horizontal_m"] < REQUIRED_M
    assert flight.figures["site_miss_m"] < REQUIRED_M


def test_without_the_camera_the_position_is_not_known():
    carried = "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]"
    flight = edl6dof.fly("tianwen1_trn", [carried, "simulation.log_every=50"])
    assert flight.figures["backshell_nav_horizontal_m"] > REQUIRED_M


def test_a_displaced_map_displaces_the_position_as_much():
    """The displacement of the map is the error of the position within 5 m; the site moves with the map."""
    wide = "sensors.landmark_camera.map_offset_m=[0, 200, 0]"
    flight = edl6dof.fly("tianwen1_trn", [wide, "simulation.log_every=50"])
    offset = flight.case["sensors"]["unit"]["landmark_camera"]["offset"][0]
    assert abs(offset[1]) > 100.0
    assert flight.figures["backshell_nav_horizontal_m"] == pytest.approx(abs(offset[1]), abs=5.0)
    assert flight.figures["site_miss_m"] < REQUIRED_M
