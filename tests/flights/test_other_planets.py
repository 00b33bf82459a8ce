"""Titan and Earth from their scenario files, against closed forms with the scenario's own numbers."""

from __future__ import annotations

from math import cos, e, exp, log, radians, sin, sqrt

import numpy as np
import pytest

import edl6dof
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.scenario import records

G0 = 9.80665


@pytest.fixture(scope="module")
def titan():
    return edl6dof.fly("titan_probe", ["simulation.time_limit_s=15000"])  # to the ground


def weight_kg_m_s2(scenario) -> float:
    """Weight over mass at the surface, rotation of the planet included."""
    planet, latitude = scenario.planet, radians(scenario.initial.latitude_deg)
    a, f, gravity = planet.equatorial_radius_m, planet.flattening, planet.gravity
    r = a * (1.0 - f * sin(latitude) ** 2)
    j2 = gravity.j2 if gravity.model == "j2" else 0.0
    pull = gravity.mu_m3_s2 / r**2 * (1.0 + 1.5 * j2 * (a / r) ** 2 * (1.0 - 3.0 * sin(latitude) ** 2))
    return pull - planet.rotation_rate_rad_s**2 * r * cos(latitude) ** 2


def against_terminal_velocity(flight) -> tuple[float, float]:
    """Speed at the ground over sqrt(2 m g / (rho CD A)), and what it should be: falling air thickens, which
    slows it by v^2 / 2H.
    """
    rows, scenario = flight.telemetry, flight.scenario
    aero, last = scenario.vehicle.aero.constant, np.flatnonzero(rows["truth.height_m"] > 0.0)[-1]
    before = last - 100
    density, height, speed = (rows[f"truth.{name}"] for name in ("density_kg_m3", "height_m", "speed_m_s"))
    scale = (height[before] - height[last]) / log(density[last] / density[before])
    g = weight_kg_m_s2(scenario)
    terminal = sqrt(
        2.0
        * scenario.vehicle.mass.entry_kg
        * g
        / (density[last] * aero.drag_coefficient * aero.reference_area_m2)
    )
    return speed[last] / terminal, 1.0 + speed[last] ** 2 / (4.0 * g * scale)


def test_terminal_velocity_on_titan(titan):
    found, expected = against_terminal_velocity(titan)
    assert found == pytest.approx(expected, rel=1e-4)
    assert titan.telemetry["truth.density_kg_m3"][-1] == pytest.approx(
        titan.scenario.atmosphere.exponential.density_kg_m3, rel=1e-3
    )


def test_terminal_velocity_on_earth():
    found, expected = against_terminal_velocity(edl6dof.fly("earth_drop", ["simulation.time_limit_s=900"]))
    assert found == pytest.approx(expected, rel=3e-4)


def test_peak_deceleration_on_titan(titan):
    """Allen and Eggers: V^2 sin(gamma) / (2 e H); the path steepens and gravity pulls along it, a few per
    cent here.
    """
    start, air = titan.scenario.initial, titan.scenario.atmosphere.exponential
    peak = start.speed**2 * sin(-start.flight_path_angle) / (2.0 * e * air.scale_height_m)
    assert titan.telemetry["truth.load_g0"].max() * G0 == pytest.approx(peak, rel=0.05)


def test_peak_deceleration_straight_down_without_gravity():
    """Allen and Eggers, exact for this path."""
    bare = (
        "planet.gravity.model=none",
        "planet.rotation_rate_rad_s=0",
        "initial.flight_path_angle_deg=-90",
        "simulation.time_limit_s=150",
    )
    flight = edl6dof.fly("titan_probe", (*bare, "simulation.log_every=1"))
    start, air, vehicle = (
        flight.scenario.initial,
        flight.scenario.atmosphere.exponential,
        flight.scenario.vehicle,
    )
    ballistic = vehicle.mass.entry_kg / (
        vehicle.aero.constant.drag_coefficient * vehicle.aero.constant.reference_area_m2
    )
    above = air.density_kg_m3 * exp(-start.altitude_m / air.scale_height_m)
    peak = start.speed**2 * exp(air.scale_height_m * above / ballistic) / (2.0 * e * air.scale_height_m)
    assert flight.telemetry["truth.load_g0"].max() * G0 == pytest.approx(peak, rel=1e-4)


def test_speed_of_sound_and_heating_are_those_of_the_planet(titan):
    gas, rows = titan.scenario.planet.gas, titan.telemetry
    sound = sqrt(
        gas.heat_capacity_ratio
        * gas.gas_constant_j_kg_k
        * titan.scenario.atmosphere.exponential.temperature_k
    )
    np.testing.assert_allclose(rows["truth.mach"], rows["truth.speed_m_s"] / sound, rtol=1e-9)
    heat = gas.sutton_graves_constant * np.sqrt(
        rows["truth.density_kg_m3"] / titan.scenario.vehicle.nose_radius_m
    )
    expected = heat * rows["truth.speed_m_s"] ** 3 / 1e4
    np.testing.assert_allclose(rows["truth.heat_flux_w_cm2"], expected, rtol=1e-6, atol=1e-12)


def test_flight_computer_knows_the_air_from_below_the_site_to_above_the_start():
    scenario = edl6dof.load("titan_probe", ["atmosphere.top_m=100e3"]).scenario
    air = scenario.atmosphere.exponential
    onboard = records.build_onboard(scenario)[0]
    for altitude in (scenario.terrain.site_elevation_m, 1e5, scenario.initial.altitude_m):
        density, _, scale = model_atmosphere(onboard["atmosphere"].view(np.recarray), altitude)
        assert density == pytest.approx(air.density_kg_m3 * exp(-altitude / air.scale_height_m), rel=1e-9)
        assert scale == pytest.approx(air.scale_height_m, rel=1e-9)
