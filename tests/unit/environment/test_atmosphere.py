"""Air: the table against its file, hydrostatics of the extension, US76 against publications, perturbation
statistics.
"""

import csv
from math import exp, sinh, sqrt
from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.environment.atmosphere import ATMOSPHERE, AtmosphereParams, air, air_inputs, fill_atmosphere
from edl6dof.environment.atmosphere_table import build_table, profile_path
from edl6dof.environment.gas import GAS, GasParams, fill_gas

DATA = Path(edl6dof.__file__).parent / "data" / "atmosphere"
COSPAR = "mars_cospar_nh_mean.csv"


GIVEN = edl6dof.load("tianwen1").scenario
RIGID = {"gas_constant_j_kg_k": 191.0, "heat_capacity_ratio": 1.29, "vibrations": []}
CO2 = {
    "heat_capacity_ratio": 1.4,
    "vibrations": [
        {"temperature_k": 960.0, "modes": 2},
        {"temperature_k": 1997.0},
        {"temperature_k": 3380.0},
    ],
}
EXPONENTIAL = {"density_kg_m3": 0.0158, "scale_height_m": 9354.0, "temperature_k": 214.0}


def with_gas(**changes):
    gas = GasParams(**GIVEN.planet.gas.model_dump() | RIGID | changes)
    return GIVEN.planet.model_copy(update={"gas": gas})


CONSTANT = with_gas()


def build(seed: int = 0, case: int = 0, planet=CONSTANT, **given) -> tuple[np.void, np.void, np.void]:
    params = AtmosphereParams(**{"table": GIVEN.atmosphere.table, "extension_gravity_m_s2": 3.72, **given})
    table = build_table(air_inputs(params, planet))[0]
    atm, gas = np.zeros(1, ATMOSPHERE)[0], np.zeros(1, GAS)[0]
    fill_atmosphere(atm, params, table, seed, case)
    fill_gas(gas, planet.gas)
    return atm, gas, table


def columns(name: str, skip: int = 1) -> np.ndarray:
    return np.genfromtxt(DATA / name, delimiter=",", skip_header=skip)


def test_table_reproduces_its_file():
    atm, gas, table = build()
    for h, density, temperature, *_ in columns("marsgram2010_jezero_feb2021_winds.csv"):
        rho, p, t, a = air(atm, gas, table, h * 1e3)
        assert rho == pytest.approx(density, rel=1e-12)
        assert t == pytest.approx(temperature, rel=1e-12)
        assert p == pytest.approx(density * 191.0 * temperature, rel=1e-12)
        assert a == pytest.approx(sqrt(1.29 * p / rho), rel=1e-12)


def test_sound_in_a_gas_that_vibrates_follows_the_temperature_of_the_table():
    """Each harmonic oscillator adds (x / 2 sinh(x/2))^2, x = theta / T, to the heat capacity c_v / R."""
    atm, gas, table = build(planet=with_gas(**CO2))
    for h, _, temperature, *_ in columns("marsgram2010_jezero_feb2021_winds.csv"):
        rho, p, t, a = air(atm, gas, table, h * 1e3)
        halves = [theta / (2.0 * temperature) for theta in (960.0, 960.0, 1997.0, 3380.0)]
        ratio = 1.0 + 1.0 / (2.5 + sum((half / sinh(half)) ** 2 for half in halves))
        assert t == pytest.approx(temperature, rel=1e-12) and 1.29 < ratio < 1.4
        assert (p, a) == pytest.approx((rho * 191.0 * t, sqrt(ratio * p / rho)), rel=1e-6)


def test_other_tables_load_too():
    atm, gas, table = build(table=COSPAR, bottom_m=-10e3, planet=with_gas(gas_constant_j_kg_k=190.8))
    for h, temperature, pressure, density, sound in columns(COSPAR):
        rho, p, t, a = air(atm, gas, table, h * 1e3)
        assert (rho, t) == pytest.approx((density, temperature), rel=1e-12)
        if h <= 80:  # higher up the gas of the table gets lighter
            assert (p, a) == pytest.approx((pressure, sound), rel=1e-2)


def test_the_profile_of_phoenix_is_a_column_in_balance_of_carbon_dioxide():
    """Rows copied by hand: p = rho R T, and pressure falls by rho g, as gravity falls with height."""
    name = "phoenix_tes_limb.csv"
    rows = np.genfromtxt(profile_path(name), delimiter=",", comments="#", skip_header=3)
    h, temperature, pressure, rho = rows[:, 0] * 1e3, *rows[:, 1:].T
    np.testing.assert_allclose(pressure / (rho * temperature), 191.0, rtol=0.007)
    r = 3.3762e6 + h  # polar radius
    gravity = 4.2828e13 / (r * r)
    fallen = -np.diff(np.log(pressure))
    weight = 0.5 * (gravity / temperature)[1:] + 0.5 * (gravity / temperature)[:-1]
    np.testing.assert_allclose(fallen, weight * np.diff(h) / 191.0, rtol=0.015)


@pytest.mark.parametrize("pick", [lambda s: np.log(s[0]), lambda s: s[2]], ids=["ln density", "temperature"])
def test_value_and_slope_are_continuous(pick):
    atm, gas, table = build()
    tiny = 1e-3
    for node in np.concatenate([np.arange(-8500.0, 12000.0, 500.0), [80e3, 199.5e3, 200e3, 200.5e3]]):
        value = [pick(air(atm, gas, table, node + k * tiny)) for k in (-2, -1, 1, 2)]
        assert value[1] == pytest.approx(value[2], abs=2e-5)
        slope_below, slope_above = (value[1] - value[0]) / tiny, (value[3] - value[2]) / tiny
        assert slope_below == pytest.approx(slope_above, abs=1e-6)


def test_extension_below_the_file_is_hydrostatic_and_isothermal():
    atm, gas, table = build()
    dh = 10.0
    for h in np.arange(-9000.0, -600.0, 173.0):
        rho, _, t, _ = air(atm, gas, table, h)
        gradient = (air(atm, gas, table, h + dh)[1] - air(atm, gas, table, h - dh)[1]) / (2 * dh)
        assert gradient == pytest.approx(-rho * 3.72, rel=1e-6)
        assert t == pytest.approx(214.1, abs=1e-9)


def test_extension_has_the_cospar_shape():
    """ln(rho(-4 km) / rho(0 km)) of the COSPAR reference, printed with three digits."""
    atm, gas, table = build()
    reference = {row[0]: row[3] for row in columns(COSPAR)}
    ours = np.log(air(atm, gas, table, -4000.0)[0] / air(atm, gas, table, 0.0)[0])
    assert ours == pytest.approx(np.log(reference[-4] / reference[0]), rel=0.02)


def test_above_the_top_density_falls_exponentially():
    atm, gas, table = build()
    first, second, third = (air(atm, gas, table, 200e3 + h)[0] for h in (10e3, 20e3, 30e3))
    assert second / first == pytest.approx(third / second, rel=1e-12)
    assert 0.0 < third < second < first
    assert air(atm, gas, table, 1e7)[0] < 1e-300


def test_altitude_that_is_not_a_number_gives_no_number():
    atm, gas, table = build()
    assert np.isnan(air(atm, gas, table, np.nan)[0])


# NESC check case 6, Atmos_06_sim_04.csv (NASA/TM-2015-218675): altitude ft, speed of sound ft/s, density
# slug/ft3, pressure lbf/ft2, temperature deg R at 0, 14.8 and 30 s.
NESC = [
    (30000.0, 994.849493459, 8.90685451211e-4, 629.673709538, 411.838873082),
    (26532.7363672, 1009.63364063, 0.0010098441865, 735.289613103, 424.170240962),
    (16284.443772, 1052.14515368, 0.00143455024951, 1134.34071255, 460.642377204),
]


@pytest.mark.parametrize("row", NESC, ids=lambda row: f"{row[0]:.0f}ft")
def test_us76_agrees_with_the_nesc_columns(row):
    foot, pound_mass, g0 = 0.3048, 0.45359237, 9.80665
    pound_force = pound_mass * g0
    slug = pound_force / foot
    altitude, sound, density, pressure, rankine = row
    atm, gas, table = build(model="us76", table="")
    rho, p, t, a = air(atm, gas, table, altitude * foot)
    assert rho == pytest.approx(density * slug / foot**3, rel=1e-6)
    # SIM 4's pressure is its rho T times 287.05578, while its own speed of sound implies 287.05282 (standard:
    # 287.05287).
    assert p == pytest.approx(pressure * pound_force / foot**2, rel=1e-5)
    assert t == pytest.approx(rankine / 1.8, rel=1e-6)
    assert a == pytest.approx(sound * foot, rel=1e-6)


# U.S. Standard Atmosphere 1976: geopotential altitude m, temperature K and pressure Pa at the base of each
# layer, as printed.
PUBLISHED = [
    (0.0, 288.15, 101325.0),
    (11000.0, 216.65, 22632.0),
    (20000.0, 216.65, 5474.9),
    (32000.0, 228.65, 868.02),
    (47000.0, 270.65, 110.91),
    (51000.0, 270.65, 66.939),
    (71000.0, 214.65, 3.9564),
]


@pytest.mark.parametrize("row", PUBLISHED, ids=lambda row: f"{row[0]:.0f}m")
def test_us76_agrees_with_the_publication(row):
    atm, gas, table = build(model="us76", table="")
    height, temperature, pressure = row
    _, p, t, _ = air(atm, gas, table, 6356766.0 * height / (6356766.0 - height))
    assert (t, p) == pytest.approx((temperature, pressure), rel=5e-5)


def test_us76_agrees_with_the_printed_table():
    """The csv counts geopotential altitude (its last lapse ends at 84.85 km), the kernel geometric
    altitude.
    """
    atm, gas, table = build(model="us76", table="")
    with (DATA / "USStandardAtmosphere1976.csv").open() as file:
        rows = [tuple(map(float, row)) for row in list(csv.reader(file))[2:]]
    for height, temperature, density in rows:
        if height <= 84852.0:
            rho, _, t, _ = air(atm, gas, table, 6356766.0 * height / (6356766.0 - height))
            assert t == pytest.approx(temperature, abs=0.006)
            assert rho == pytest.approx(density, rel=2e-5)


def test_exponential_and_none():
    atm, gas, table = build(model="exponential", table="", exponential=EXPONENTIAL)
    rho, p, t, a = air(atm, gas, table, 9354.0)
    assert rho == pytest.approx(0.0158 * exp(-1.0), rel=1e-14)
    assert p == pytest.approx(rho * 191.0 * t, rel=1e-14)
    atm, gas, table = build(model="none", table="", exponential=EXPONENTIAL)
    rho, p, _, a = air(atm, gas, table, 1e4)
    assert (rho, p) == (0.0, 0.0)
    assert a > 0.0


def test_density_factor_scales_density_and_pressure_only():
    plain, biased = build(), build(density_factor=1.1)
    a, b = air(*plain, 1234.0), air(*biased, 1234.0)
    assert b[:2] == pytest.approx((1.1 * a[0], 1.1 * a[1]), rel=1e-14)
    assert b[2:] == a[2:]


def test_disabled_perturbation_is_bit_identical_and_zero():
    plain, seeded = build(), build(seed=7, case=3)
    assert not np.any(seeded[0]["density_change"])
    assert air(*plain, 777.0) == air(*seeded, 777.0)


def test_perturbation_belongs_to_seed_and_case():
    on = {"perturbation": {"enabled": True}}
    first = build(1, 2, **on)[0]["density_change"].copy()
    assert np.array_equal(first, build(1, 2, **on)[0]["density_change"])
    assert not np.array_equal(first, build(1, 3, **on)[0]["density_change"])
    assert not np.array_equal(first, build(2, 2, **on)[0]["density_change"])


def test_perturbation_statistics():
    """Sigma of the table and e-folding length at altitude, from 2000 cases, read through the kernel."""
    params = AtmosphereParams(table=GIVEN.atmosphere.table, perturbation={"enabled": True})
    atm, gas, table = build(perturbation={"enabled": True})
    heights = (10e3, 15e3, 60e3)  # 5 km apart: one correlation length
    nominal = [air(*build(), h)[0] for h in heights]
    change = np.empty((2000, 3))
    for case in range(len(change)):
        fill_atmosphere(atm, params, table, 5, case)
        change[case] = [air(atm, gas, table, h)[0] / n - 1.0 for h, n in zip(heights, nominal, strict=True)]
    source = columns("marsgram2010_jezero_feb2021_winds.csv")
    sigma = [source[np.searchsorted(source[:, 0], h / 1e3), 5] / 100 for h in heights]
    assert np.all(abs(change.mean(axis=0)) < 4 * np.array(sigma) / sqrt(2000))
    assert change.std(axis=0) == pytest.approx(sigma, rel=4 / sqrt(2 * 2000))
    assert np.corrcoef(change.T)[0, 1] == pytest.approx(exp(-1.0), abs=4 * (1 - exp(-2.0)) / sqrt(2000))
    assert abs(np.corrcoef(change.T)[0, 2]) < 4 / sqrt(2000)


def test_perturbed_density_stays_positive_and_smooth():
    atm, gas, table = build(3, 3, perturbation={"enabled": True, "sigma_scale": 5.0})
    rho = np.array([air(atm, gas, table, h)[0] for h in np.arange(-9e3, 210e3, 250.0)])
    assert np.all(rho > 0.0)
    values = [air(atm, gas, table, 10e3 + k * 1e-3)[0] for k in (-2, -1, 1, 2)]
    assert values[1] - values[0] == pytest.approx(values[3] - values[2], abs=1e-10)


def test_perturbation_fills_the_air_up_to_the_top_of_the_scenario():
    """Titan's air without a csv: density still varies at 600 km."""
    given = {"perturbation": {"enabled": True}, "model": "exponential", "table": "", "exponential": AIR}
    atm, gas, table = build(1, 1, top_m=1.3e6, **given)
    bare, _, _ = build(1, 1, top_m=1.3e6, **given | {"perturbation": {"enabled": False}})
    factors = [air(atm, gas, table, h)[0] / air(bare, gas, table, h)[0] for h in (600e3, 610e3, 640e3)]
    assert len(set(factors)) == 3 and all(0.5 < factor < 1.5 for factor in factors)


AIR = {"density_kg_m3": 5.35, "scale_height_m": 21050.0, "temperature_k": 94.0}
