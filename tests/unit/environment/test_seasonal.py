"""Air of model seasonal: balance of its weight by an independent quadrature, measured pressures, seasons,
hours and dispersions, and what the flight computer may know of them.
"""

from math import cos, exp, radians, sin, sinh, sqrt

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.atmosphere import air
from edl6dof.environment.climate import surface_pressure
from edl6dof.environment.gravity import gravity_F
from edl6dof.scenario.records import build_case, build_onboard, build_records, build_tables

#: The climate alone, without what calibration found of the day that the scenario ships.
CLIMATE = (
    "atmosphere.model=seasonal",
    "atmosphere.seasonal={surface_pressure_factor: 1.0, temperature_bias_k: 0.0}",
)
CONSTANT = ("planet.gas.heat_capacity_ratio=1.29", "planet.gas.vibrations=[]")
CO2 = (
    "planet.gas.heat_capacity_ratio=1.4",
    "planet.gas.vibrations=[{temperature_k: 960.2, modes: 2}, {temperature_k: 1997.0}, "
    "{temperature_k: 3379.7}]",
)
#: Overrides of places, seasons and hours, one with every dispersion.
PLACES = {
    "tianwen1": (),
    "night on a high place": (
        "terrain.site_elevation_m=5200.0",
        "terrain.site_latitude_deg=-14.0",
        "terrain.site_longitude_deg=250.0",
        "planet.areoid=mars_gmm3_degree12",
        "initial.epoch_utc=2018-09-02T07:00:00",
    ),
    "polar, no areoid": (
        "terrain.site_latitude_deg=78.0",
        "terrain.site_elevation_m=-4100.0",
        "initial.epoch_utc=2008-05-25T23:38:00Z",
        "planet.areoid=''",
        *CO2,
    ),
    "another table, constant gas": (
        "atmosphere.table=mars_cospar_nh_mean.csv",
        "wind.model=none",
        *CONSTANT,
    ),
    "dispersed": (
        "atmosphere.seasonal={surface_pressure_factor: 1.07, temperature_bias_k: -8.0, "
        "temperature_perturbation: {enabled: true, sigma_k: 6.0}}",
    ),
}


def loaded(*overrides):
    return edl6dof.load("tianwen1", [*CLIMATE, *overrides])


def sky(*overrides, profile=0):
    """The air of a scenario as a function of height above the areoid, and the scenario."""
    scenario = loaded(*overrides, f"profile={profile}").truth
    tables = build_tables(scenario)
    case, table = build_case(scenario, tables)[0], tables[0]["atmosphere"]
    return (lambda height: air(case["atmosphere"], case["planet"]["gas"], table, height)), scenario


def weight(scenario):
    """Gravity less the centrifugal acceleration along the vertical of the site, m/s2, as a function of height
    above the areoid.
    """
    case, planet = build_case(scenario, build_tables(scenario))[0], scenario.planet
    lat, lon = radians(scenario.terrain.site_latitude_deg), radians(scenario.terrain.site_longitude_deg)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    polar = planet.equatorial_radius_m * (1.0 - planet.flattening)
    normal = planet.equatorial_radius_m**2 / np.hypot(planet.equatorial_radius_m * cos(lat), polar * sin(lat))
    ground = np.array([1.0, 1.0, (polar / planet.equatorial_radius_m) ** 2]) * normal * up
    ground += areoid_height(planet, lat, lon) * up
    spin = np.array([0.0, 0.0, planet.rotation_rate_rad_s])

    def at(height):
        r = ground + height * up
        return -(gravity_F(case["planet"]["gravity"], tuple(r)) - np.cross(spin, np.cross(spin, r))) @ up

    return at


def ratio_of_specific_heats(gas, temperature):
    """Of a gas of harmonic oscillators."""
    heat_capacity = 1.0 / (gas.heat_capacity_ratio - 1.0)
    for vibration in gas.vibrations:
        half = vibration.temperature_k / (2.0 * temperature)
        heat_capacity += vibration.modes * (half / sinh(half)) ** 2
    return 1.0 + 1.0 / heat_capacity


@pytest.mark.parametrize(
    "name",
    [
        name if name.startswith(("tianwen1", "polar")) else pytest.param(name, marks=pytest.mark.long)
        for name in PLACES
    ],
)
def test_every_layer_carries_what_lies_above_it(name):
    """Pressure against the weight of the air between heights in and between the rows, by Gauss's quadrature
    of the density and pressure that the kernel returns.
    """
    kernel, scenario = sky(*PLACES[name])
    rows = 500.0 * np.arange(-8, 240)
    edges = np.sort(np.concatenate([rows, rows[:-1] + 173.0]))
    nodes, weights = np.polynomial.legendre.leggauss(5)
    heavy, bottom = weight(scenario), kernel(edges[0])[1]
    gravity = np.polynomial.Chebyshev.fit(rows, [heavy(h) for h in rows], 12)
    carried = 0.0
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        heights = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        slopes = [gravity(h) * density / pressure for h in heights for density, pressure, *_ in [kernel(h)]]
        carried += 0.5 * (high - low) * np.dot(weights, slopes)
        assert np.log(bottom / kernel(high)[1]) == pytest.approx(carried, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("name", PLACES)
def test_gas_law_and_speed_of_sound(name):
    kernel, scenario = sky(*CO2, *PLACES[name])
    gas = scenario.planet.gas
    assert bool(gas.vibrations) == ("constant gas" not in name)
    for height in (-9000.0, -4099.4, 130.0, 12345.0, 70e3, 300e3):
        rho, p, t, a = kernel(height)
        assert p == pytest.approx(rho * gas.gas_constant_j_kg_k * t, rel=1e-12)
        rel = 1e-6 if gas.vibrations else 1e-12  # in rows of temperature
        assert a * a * rho / p == pytest.approx(ratio_of_specific_heats(gas, t), rel=rel)


def test_pressure_at_the_ground_is_that_of_the_climate():
    """7.65 mbar measured at Ls 97 and 6.85 mbar expected at Ls 142.7, 3.68 km below the areoid."""
    law = loaded().scenario.planet.climate.surface_pressure
    for season, measured in ((97.0, 765.0), (142.7, 685.0)):
        assert surface_pressure(law, radians(season), -3680.0) == pytest.approx(measured, rel=0.01)
    spring = surface_pressure(law, radians(45.21), -4099.4)
    assert sky()[0](-4099.4)[1] == pytest.approx(spring, rel=1e-4)
    assert spring == pytest.approx(864.0, rel=0.01)
    assert surface_pressure(law, 1.0, 0.0) / surface_pressure(law, 1.0, 11e3) == pytest.approx(exp(1.0))


def test_air_follows_season_and_hour():
    """Half a solar day moves the temperature at the ground by the wave of the hour, and not the pressure; the
    pressure follows the season: 0.89 of the mean at Ls 180, 1.039 at Ls 45.
    """
    calm, _ = sky("initial.epoch_utc=2021-05-15T00:30:00")
    night, _ = sky("initial.epoch_utc=2021-05-15T12:50:00")
    autumn, _ = sky("initial.epoch_utc=2022-02-24T00:00:00")
    ground = -4099.4
    assert calm(ground)[2] - night(ground)[2] == pytest.approx(24.0, abs=1.0)
    assert night(ground)[1] == pytest.approx(calm(ground)[1], rel=1e-3)
    assert night(20e3)[2] == pytest.approx(calm(20e3)[2], abs=1e-3)
    assert autumn(ground)[1] / calm(ground)[1] == pytest.approx(0.89 / 1.039, abs=0.005)


def test_below_the_table_the_air_gets_warmer_by_the_lapse_rate():
    kernel, _ = sky("atmosphere.seasonal={diurnal_amplitude_k: 0.0, lapse_rate_k_m: 3.0e-3}")
    for height in (-500.0, -2500.0, -4099.4, -7000.0):
        assert kernel(height)[2] == pytest.approx(214.1 - 3.0e-3 * height, abs=1e-3)
    assert kernel(10e3)[2] == pytest.approx(203.1, abs=1e-6)


@pytest.mark.parametrize("pick", [lambda s: np.log(s[0]), lambda s: s[2]], ids=["ln density", "temperature"])
def test_value_and_slope_are_continuous(pick):
    kernel, _ = sky()
    tiny = 1e-2
    for node in np.concatenate([np.arange(-7500.0, 12000.0, 500.0), [80e3, 199.5e3]]):
        value = [pick(kernel(node + k * tiny)) for k in (-2, -1, 1, 2)]
        slope_below, slope_above = (value[1] - value[0]) / tiny, (value[3] - value[2]) / tiny
        assert slope_below == pytest.approx(slope_above, abs=2e-6)


def test_dispersions_of_pressure_and_temperature():
    """A pressure factor scales every height alike; a warm column holds its pressure at the ground and is
    denser aloft, by the change of the scale height.
    """
    plain, scenario = sky()
    heavy, _ = sky("atmosphere.seasonal={surface_pressure_factor: 1.1}")
    warm, _ = sky("atmosphere.seasonal={temperature_bias_k: 10.0}")
    ground = scenario.terrain.site_elevation_m
    for height in (ground, 500.0, 42e3):
        assert np.divide(heavy(height), plain(height)) == pytest.approx([1.1, 1.1, 1.0, 1.0], rel=1e-12)
        assert warm(height)[2] - plain(height)[2] == pytest.approx(10.0, abs=0.1)
    assert warm(ground)[1] == pytest.approx(plain(ground)[1], rel=1e-12)
    heights = np.linspace(ground, 30e3, 400)
    slopes = [3.72 / 191.0 * (1.0 / plain(h)[2] - 1.0 / warm(h)[2]) for h in heights]
    raised = np.log(warm(30e3)[1] / plain(30e3)[1])
    assert raised == pytest.approx(np.trapezoid(slopes, heights), rel=0.02) and raised > 0.1


def test_random_temperature_has_its_sigma_and_length_and_belongs_to_the_case():
    waves = "atmosphere.seasonal={temperature_perturbation: {enabled: true, sigma_k: 4.0}}"
    plain, scenario = sky()
    assert sky(waves, profile=3)[0](7e3) == sky(waves, profile=3)[0](7e3) != sky(waves, profile=4)[0](7e3)
    tables = build_tables(scenario)
    varied = loaded(waves).truth
    change = np.empty((count := 300, 2))
    for case in range(len(change)):
        record = build_case(varied.model_copy(update={"profile": case}), tables)[0]
        for k, height in enumerate((10e3, 18e3)):  # one correlation length apart
            found = air(record["atmosphere"], record["planet"]["gas"], tables[0]["atmosphere"], height)
            change[case, k] = found[2] - plain(height)[2]
    assert change.mean(axis=0) == pytest.approx([0.0, 0.0], abs=4 * 4.0 / sqrt(count))
    assert change.std(axis=0) == pytest.approx([4.0, 4.0], rel=4 / sqrt(2 * count))
    assert np.corrcoef(change.T)[0, 1] == pytest.approx(exp(-1.0), abs=4 * (1 - exp(-2.0)) / sqrt(count))


def test_the_flight_computer_knows_the_climate_alone():
    dispersed = PLACES["dispersed"][0]
    plain, told = build_onboard(loaded().scenario), build_onboard(loaded(dispersed).scenario)
    assert told["atmosphere"].tobytes() == plain["atmosphere"].tobytes()
    unlike = build_onboard(loaded("initial.epoch_utc=2022-02-24T00:00:00").scenario)
    assert unlike["atmosphere"].tobytes() != plain["atmosphere"].tobytes()


def test_the_sound_believed_on_board_follows_the_gas():
    """At 200 K carbon dioxide has a ratio of 1.34 and not 1.29: 2 % more speed of sound, less Mach number."""
    stiff, soft = (build_records(loaded(*extra)) for extra in (CONSTANT, CO2))
    believed = [records.onboard[0]["atmosphere"] for records in (stiff, soft)]
    ratio = believed[1]["speed_of_sound"] / believed[0]["speed_of_sound"]
    assert np.all((ratio > 1.01) & (ratio < sqrt(1.4 / 1.29) + 1e-12))
    table = believed[1]
    heights = table["bottom"] + table["spacing"] * np.arange(len(ratio)) - loaded().scenario.site_areoid_m
    assert ratio[np.argmin(abs(heights - 11e3))] == pytest.approx(sqrt(1.34 / 1.29), abs=2e-3)
    case, shared = soft.case[0], soft.tables[0]["atmosphere"]
    true = [air(case["atmosphere"], case["planet"]["gas"], shared, height)[3] for height in heights]
    assert table["speed_of_sound"] == pytest.approx(true, rel=1e-12)


@pytest.mark.parametrize(
    "overrides, path, words",
    [
        (("planet=earth",), "atmosphere.model", "Earth has no planet.climate"),
        (("initial.epoch_utc=landing day",), "initial.epoch_utc", "got 'landing day'"),
        (("initial.epoch_utc=''",), "initial.epoch_utc", "must be the date and time of t = 0"),
        (("atmosphere.table=''", "wind.model=none"), "atmosphere.table", "seasonal needs a table"),
    ],
)
def test_what_it_needs_is_asked_for(overrides, path, words):
    with pytest.raises(ConfigError) as caught:
        loaded(*overrides)
    assert [problem for problem in caught.value.problems if problem.path == path and words in problem.message]


def test_a_flight_in_it_lands():
    flight = edl6dof.fly("tianwen1", ["atmosphere.model=seasonal"])
    assert flight.outcome == "landed within limits"
