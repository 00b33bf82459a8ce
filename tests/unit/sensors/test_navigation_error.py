"""Errors put on top of ideal instruments: constant ones along radius, track and across, and white noise."""

import numpy as np
import pytest
from instrument_bench import Bench

from edl6dof.scenario.loading import load_scenario

R, V = np.array([3.5e6, 0.0, 0.0]), np.array([-300.0, 4000.0, 0.0])
FORCE = np.array([-50.0, 0.0, 12.0])


def bench(**params):
    made = Bench("navigation_error", params)
    made.put(r=R, v=V)
    made.outputs["specific_force_B"] = FORCE
    return made


def test_without_errors_the_truth_is_told():
    sensed = bench().measure()
    assert np.array_equal(sensed["r_I"], R) and np.array_equal(sensed["v_I"], V)
    assert np.array_equal(sensed["specific_force_B"], FORCE)


def test_constant_errors_lie_along_the_radius_the_track_and_across_it():
    sensed = bench(position_m=(1.0, 2.0, 3.0), velocity_m_s=(0.1, 0.2, 0.3), force_scale=0.02).measure()
    assert sensed["r_I"] - R == pytest.approx([1.0, 2.0, 3.0])
    assert sensed["v_I"] - V == pytest.approx([0.1, 0.2, 0.3])
    assert sensed["specific_force_B"] == pytest.approx(1.02 * FORCE)


def test_noise_of_the_specific_force_is_white_and_of_the_given_size():
    made = bench(force_noise_m_s2=0.5)
    read = np.array([made.measure()["specific_force_B"].copy() for _ in range(1200)]) - FORCE
    assert read.std(axis=0) == pytest.approx([0.5] * 3, rel=5.0 / np.sqrt(2400.0))
    assert np.all(np.abs(np.mean(read[1:] * read[:-1], axis=0)) < 5.0 * 0.25 / np.sqrt(1200.0))
    across = np.corrcoef(read.T)[np.triu_indices(3, 1)]
    assert np.all(np.abs(across) < 5.0 / np.sqrt(1200.0))


def test_perfect_instruments_say_the_truth_at_the_centre_of_mass():
    made, q, w = Bench("perfect", {"end_switch": 0.9}), (0.5, -0.5, 0.5, 0.5), (0.1, 0.2, -0.3)
    made.put(r=R, v=V, q=q, w=w)
    made.outputs["specific_force_B"], made.outputs["height"] = FORCE, 123.0
    for pads, opening, contact, wing in ((0, 0.89, 0, 0), (1, 0.91, 1, 1), (4, 0.0, 1, 0), (0, 1.0, 0, 1)):
        made.outputs["pads"], made.outputs["wing_opening"] = pads, opening
        sensed = made.measure()
        assert (sensed["footpad_contact"], sensed["wing_open"]) == (contact, wing)
    for name, true in (("r_I", R), ("v_I", V), ("q_I2B", q), ("w_B", w), ("specific_force_B", FORCE)):
        assert np.array_equal(sensed[name], true), name
    assert sensed["height_above_ground"] == 123.0


def test_the_set_perfect_of_a_point_mass_keeps_it_and_nothing_else():
    named = "sensors.carried=[perfect, imu, star_tracker, navigation_error]"
    assert load_scenario("wu2013", [named]).scenario.sensors_in_flight.flown == [
        "perfect",
        "imu",
        "navigation_error",
    ]
