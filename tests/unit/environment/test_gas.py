"""The ratio of specific heats of a planet's gas against spectroscopy, tables and scipy's derivative."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.differentiate import derivative

from edl6dof.environment.gas import (
    GAS,
    GasParams,
    fill_gas,
    inverse_knudsen_number,
    pressure_and_sound,
    ratio_of_specific_heats,
)

RIGID = {
    "gas_constant_j_kg_k": 188.92,
    "heat_capacity_ratio": 1.4,
    "shock_layer_heat_capacity_ratio": 1.33,
    "molecular_diameter_m": 4.6e-10,
    "molecular_mass_kg": 7.3e-26,
    "sutton_graves_constant": 1.9e-4,
}
#: Carbon dioxide: two bending vibrations, symmetric and antisymmetric stretching (667, 1388 and 2349 per cm
#: of fundamental wave number; Herzberg 1945), K.
CARBON_DIOXIDE = [
    {"temperature_k": 960.0, "modes": 2},
    {"temperature_k": 1997.0},
    {"temperature_k": 3380.0},
]
R = 8.31446  # J/(mol K)


def gas(**changes):
    record = np.zeros(1, GAS).view(np.recarray)[0]
    fill_gas(record, GasParams(**RIGID | changes))
    return record


@pytest.mark.parametrize(
    "temperature, heat_capacity",
    [(200.0, 32.359), (300.0, 37.221), (400.0, 41.325), (600.0, 47.321), (1000.0, 54.308)],
)
def test_carbon_dioxide_against_tables(temperature, heat_capacity):
    """NIST-JANAF tables (4th edition, 1998): heat capacity at constant pressure, J/(mol K)."""
    own = ratio_of_specific_heats(gas(vibrations=CARBON_DIOXIDE), temperature)
    assert own == pytest.approx(heat_capacity / (heat_capacity - R), abs=0.004)


@pytest.mark.parametrize("temperature", [50.0, 137.0, 210.0, 555.0, 3000.0])
def test_heat_capacity_is_the_slope_of_the_oscillators_energy(temperature):
    def energy(t):
        return 2.5 * t + sum(theta / np.expm1(theta / t) for theta in (960.0, 960.0, 1997.0, 3380.0))

    slope = derivative(energy, temperature).df
    own = ratio_of_specific_heats(gas(vibrations=CARBON_DIOXIDE), temperature)
    assert 1.0 / (own - 1.0) == pytest.approx(slope, rel=1e-8)


def test_limits_in_the_cold_and_in_the_heat():
    vibrating = gas(vibrations=CARBON_DIOXIDE)
    for cold in (0.0, 1.0, 20.0):
        assert ratio_of_specific_heats(vibrating, cold) == pytest.approx(1.4, abs=1e-12)
    assert ratio_of_specific_heats(vibrating, 1e6) == pytest.approx(1.0 + 1.0 / 6.5, abs=1e-5)
    assert {ratio_of_specific_heats(gas(), t) for t in (0.0, 94.0, 210.0, 2000.0)} == {1.4}


def test_sound_follows_the_ratio_and_pressure_does_not():
    at = (1e-2, 210.0)
    rigid, vibrating = pressure_and_sound(gas(), *at), pressure_and_sound(gas(vibrations=CARBON_DIOXIDE), *at)
    assert rigid[0] == vibrating[0] == pytest.approx(1e-2 * 188.92 * 210.0)
    ratio = ratio_of_specific_heats(gas(vibrations=CARBON_DIOXIDE), 210.0)
    assert (vibrating[1] / rigid[1]) ** 2 == pytest.approx(ratio / 1.4, rel=5e-7)


def test_sound_reads_the_ratio_at_every_temperature():
    record = gas(vibrations=CARBON_DIOXIDE)
    for temperature in (0.5, 33.0, 151.0, 199.9, 288.0, 1007.0, 1009.0, 2500.0):
        _, sound = pressure_and_sound(record, 1.0, temperature)
        ratio = sound**2 / (188.92 * temperature)
        assert ratio == pytest.approx(ratio_of_specific_heats(record, temperature), rel=5e-7)


@pytest.mark.parametrize("wrong", [0.0, -960.0, float("nan"), 1e6])
def test_impossible_vibrations_are_refused(wrong):
    with pytest.raises(ValidationError):
        gas(vibrations=[{"temperature_k": wrong}])


def test_mean_free_path_is_that_of_hard_spheres():
    """Boltzmann's k T / (sqrt(2) pi d^2 p) at the pressure of the ideal gas of the same density."""
    boltzmann, temperature, rho = 1.380649e-23, 210.0, 1e-6
    pressure = rho / 7.3e-26 * boltzmann * temperature
    path = boltzmann * temperature / (np.sqrt(2.0) * np.pi * 4.6e-10**2 * pressure)
    assert inverse_knudsen_number(gas(), rho, 3.4) == pytest.approx(3.4 / path, rel=1e-12)
