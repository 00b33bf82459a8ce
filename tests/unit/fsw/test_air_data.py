"""Ratios of measured to believed drag and lift against the estimate of all readings at once."""

from math import exp

import numpy as np
import pytest

from edl6dof.fsw.guidance.entry.air_data import AIR_DATA, measure_air
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import NAV, model_atmosphere

#: Speed (m/s) above any at which something opens.
FAST = 1e9


def reading_of(record, altitude, drag_ratio, lift_ratio):
    """``NAV`` of a flight through the expected wind at 3,200 m/s, which reads these ratios."""
    nav = np.zeros(1, NAV)[0]
    nav["altitude"], nav["mach"] = altitude, 15.0
    air, vehicle = record["atmosphere"], record["vehicle"]
    air["wind_north"], air["wind_east"] = -50.0, 20.0
    nav["v_N"] = (2000.0 - 50.0, 2500.0 + 20.0, 0.0)  # through the air that is expected: 2000, 2500 m/s
    heights = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    density = exp(np.interp(altitude, heights, air["ln_density"]))
    area, ratio = believed_aero(vehicle, 15.0, FAST)
    drag = drag_ratio * 0.5 * density * (2000.0**2 + 2500.0**2) * area / vehicle["entry_mass"]
    nav["drag"], nav["lift"] = drag, lift_ratio * ratio * drag
    return nav


def test_ratio_of_lift_approaches_what_is_measured_with_its_memory(onboard):
    record, memory = onboard[0], np.zeros(1, AIR_DATA)[0]
    tau, dt = record["guidance"]["entry"]["air_data"]["lift_memory"], 0.2
    nav = reading_of(record, 30e3, 1.2, 0.8)
    measure_air(record, nav, memory)
    assert memory["lift"] == 1.0
    for _ in range(round(tau / dt)):
        nav["t"] += dt
        measure_air(record, nav, memory)
    assert memory["lift"] == pytest.approx(1.0 - 0.2 * (1.0 - exp(-1.0)), abs=2e-3)
    assert memory["drag"] == pytest.approx(1.2, abs=2e-3)


def test_ratio_and_trend_of_drag_are_the_least_squares_estimate(onboard):
    """Against the posterior of all readings at once: prior of level and trend, random walk with height."""
    record, memory, rng = onboard[0], np.zeros(1, AIR_DATA)[0], np.random.default_rng(5)
    p = record["guidance"]["entry"]["air_data"]
    heights = 40e3 - np.cumsum(rng.uniform(100.0, 400.0, 60))
    readings = 1.1 + 2e-6 * (heights - 30e3) + 0.02 * rng.standard_normal(60)
    for height, reading in zip(heights, readings, strict=True):
        measure_air(record, reading_of(record, height, reading, 1.0), memory)
    # Gaussian conditioning: level at the last height and trend, given all readings
    above = heights - heights[-1]
    walk = 2.0 * p["wave_sigma"] ** 2 / p["wave_length"]
    scale_height = model_atmosphere(record["atmosphere"], heights[0])[2]
    fallen = heights[0] - heights  # since the prior
    trend_variance = (p["scale_height_error"] / scale_height) ** 2
    joint = (
        p["drag_error"] ** 2
        + trend_variance * np.outer(fallen, fallen)
        + walk * np.minimum.outer(fallen, fallen)
    )
    gain = np.linalg.inv(joint + p["reading_error"] ** 2 * np.eye(60)) @ (readings - 1.0)
    assert above[-1] == 0.0
    assert memory["drag"] == pytest.approx(1.0 + joint[-1] @ gain, abs=1e-9)
    assert memory["trend"] == pytest.approx(-trend_variance * fallen @ gain, rel=1e-6)
