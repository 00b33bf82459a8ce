"""Convective and radiative heating, against the formulas and hand-computed values of their papers."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from pydantic import ValidationError

import edl6dof
from edl6dof.config.dtype import in_si
from edl6dof.environment.gas import GasParams
from edl6dof.environment.heating import (
    RadiationParams,
    convective_heat_flux,
    radiative_heat_flux,
    wall_temperature,
)

GAS = {
    "gas_constant_j_kg_k": 191.0,
    "heat_capacity_ratio": 1.4,
    "shock_layer_heat_capacity_ratio": 1.33,
    "molecular_diameter_m": 4.6e-10,
    "molecular_mass_kg": 7.3e-26,
    "sutton_graves_constant": 1.9e-4,
}


@cache
def of_planet(name):
    """Radiation of a planet that ships."""
    scenario = {"mars": "pathfinder", "earth": "stardust"}[name]
    return edl6dof.load(scenario).scenario.planet.gas.radiation


def flux_of(name, rho, nose_radius, speed):
    """Radiative heat flux, W/cm2."""
    return radiative_heat_flux(in_si(of_planet(name)), rho, nose_radius, speed) / 1e4


def test_heat_flux_of_sutton_and_graves():
    """1.9e-4 sqrt(4e-4 / 0.25) 5000^3 W/m2; the blunter nose is the cooler."""
    gas = in_si(GasParams(**GAS))
    assert convective_heat_flux(gas, 4e-4, 0.25, 5000.0) == pytest.approx(950e3, rel=1e-12)
    assert convective_heat_flux(gas, 4e-4, 1.0, 5000.0) == pytest.approx(475e3, rel=1e-12)


def test_radiation_on_mars_is_that_of_tauber_and_sutton():
    """2.35e4 r^0.526 rho^1.19 f(V): at a row, between two rows, above the last and below the first."""
    for speed, f in ((7000.0, 8.1), (7100.0, 0.5 * (8.1 + 10.2)), (9500.0, 32.8), (5999.0, 0.0)):
        expected = 2.35e4 * 2.0**0.526 * 3e-4**1.19 * f
        assert flux_of("mars", 3e-4, 2.0, speed) == pytest.approx(expected, rel=1e-12)


def test_radiation_on_earth_is_that_of_tauber_and_sutton():
    """The exponent of the nose radius falls with speed and density, and is limited by the radius."""
    rho, speed, f = 3e-4, 12000.0, 359.0
    free = 1.072e6 * speed**-1.88 * rho**-0.325
    assert 0.3 < free < 0.5
    assert flux_of("earth", rho, 0.5, speed) == pytest.approx(4.736e4 * 0.5**free * rho**1.22 * f, rel=1e-12)
    thin, slow, g = 1e-5, 9000.0, 1.5  # free exponent 1.7
    for radius, exponent in ((0.8, 1.0), (1.5, 0.6), (2.5, 0.5)):
        expected = 4.736e4 * radius**exponent * thin**1.22 * g
        assert flux_of("earth", thin, radius, slow) == pytest.approx(expected, rel=1e-12)


def test_a_planet_without_table_does_not_radiate():
    assert radiative_heat_flux(in_si(RadiationParams()), 1e-3, 1.0, 9000.0) == 0.0
    with pytest.raises(ValidationError, match="speeds must rise"):
        RadiationParams(speeds=[(7000.0, 1.0), (7000.0, 2.0)])


def test_a_flight_counts_both():
    """Stardust at 12 km/s: the telemetry holds the formulas, and their sum is integrated."""
    flight = edl6dof.fly("stardust", ["simulation.time_limit_s=120", "mission.goal=time"])
    speed, rho = flight["truth.airspeed_m_s"], flight["truth.density_kg_m3"]
    scenario = flight.scenario
    gas, radius = scenario.planet.gas, scenario.vehicle.nose_radius_m
    radiative = np.array(
        [flux_of("earth", *pair) for pair in zip(rho, [radius] * len(rho), speed, strict=True)]
    )
    convective = gas.sutton_graves_constant * np.sqrt(rho / radius) * speed**3 / 1e4
    np.testing.assert_allclose(flight["truth.radiative_heat_flux_w_cm2"], radiative, rtol=1e-9)
    np.testing.assert_allclose(flight["truth.heat_flux_w_cm2"], convective + radiative, rtol=1e-9)
    assert flight.figures["peak_radiative_heat_flux_w_cm2"] == pytest.approx(radiative.max(), rel=0.01)
    load = np.trapezoid(convective + radiative, flight["t_s"])
    assert flight.figures["heat_load_j_cm2"] == pytest.approx(load, rel=1e-3)


def test_a_wall_that_radiates_all_heat():
    """0.85 sigma T^4 = q, at 1000 K: 48.2 kW/m2."""
    assert wall_temperature(0.85 * 5.670374419e-8 * 1e12) == pytest.approx(1000.0, rel=1e-12)
