"""One contract for what every model of air, wind, parachute and engine, every sensor and every distribution
does: finite, bounded and repeatable.
"""

from itertools import product

import numpy as np
import pytest
from given_functions import sense

import edl6dof
from edl6dof.campaign.design.sections import DISTRIBUTIONS
from edl6dof.config.dtype import fill
from edl6dof.environment.atmosphere import ATMOSPHERE, AtmosphereParams, air_inputs, fill_atmosphere
from edl6dof.environment.atmosphere_models import ATMOSPHERES, air_of_model
from edl6dof.environment.atmosphere_table import build_table
from edl6dof.environment.gas import GAS, fill_gas
from edl6dof.environment.wind import WIND, WindParams
from edl6dof.environment.wind_models import WINDS, wind_of_model
from edl6dof.interface.sensed import SENSED
from edl6dof.scenario.records import build_records, initial_plant, initial_sensors
from edl6dof.sensors.registry import (
    SENSOR_FAMILY,
    SENSOR_UNITS,
    SensorParams,
    draw_sensor_units,
    fill_sensor_params,
    sensor_problems,
)
from edl6dof.spatial.quaternion import from_axes
from edl6dof.vehicle.parachutes.canopy_models import PARACHUTE_MODELS, efficiency_of_model
from edl6dof.vehicle.parachutes.parachute import PARACHUTE_PARAMS, ParachuteParams, inflation
from edl6dof.vehicle.plant import OUTPUTS
from edl6dof.vehicle.propulsion.engine import ENGINE, EngineParams, propellant_flow, thrust_goal, thrust_rate
from edl6dof.vehicle.propulsion.engine_models import ENGINE_MODELS

#: Altitudes (m): below the ground of any planet, through the air, and far outside.
ALTITUDES = (-8000.0, -1.0, 0.0, 3e3, 25e3, 79.9e3, 150e3, 1e6)
#: What distributions need beside their kind.
GIVEN = {
    "normal": {"three_sigma": 6.0},
    "truncated_normal": {"sigma": 2.0, "low": 9.0, "high": 14.0},
    "uniform": {"half_width": 3.0},
    "log_normal": {"sigma_ln": 0.3},
    "discrete": {"choices": [1.0, 2.0, 5.0], "weights": [1.0, 2.0, 1.0]},
}


@pytest.fixture(scope="module")
def loaded():
    return edl6dof.load("tianwen1")


@pytest.fixture(scope="module")
def world(loaded):
    """Records of air, gas, wind and their table, with the numbers of every model given."""
    planet = loaded.scenario.planet
    exponential = {"density_kg_m3": 0.02, "scale_height_m": 11e3, "temperature_k": 210.0}
    table = loaded.scenario.atmosphere.table
    params = AtmosphereParams(model="seasonal", table=table, exponential=exponential)
    winds = WindParams(constant={"east_m_s": 20.0}, shear={"north_m_s": 5.0, "north_shear": 1e-3})
    atm, gas, wind = np.zeros(1, ATMOSPHERE), np.zeros(1, GAS), np.zeros(1, WIND)
    fill_gas(gas[0], planet.gas)
    fill(wind[0], winds)
    tables = build_table(air_inputs(params, planet, loaded.scenario.place))[0]
    fill_atmosphere(atm[0], params, tables)
    return atm[0], gas[0], wind[0], tables


@pytest.mark.parametrize("index", range(len(ATMOSPHERES.members)), ids=ATMOSPHERES.names)
def test_air_is_finite_not_negative_thins_upwards_and_is_repeatable(world, index):
    atm, gas, _, table = world
    found = np.array([air_of_model(index, atm, gas, table, alt) for alt in ALTITUDES])
    again = np.array([air_of_model(index, atm, gas, table, alt) for alt in ALTITUDES])
    density, pressure, temperature, sound = found.T
    assert np.all(np.isfinite(found)) and np.array_equal(found, again)
    assert np.all(density >= 0.0) and np.all(pressure >= 0.0)
    assert np.all(temperature > 0.0) and np.all(sound > 0.0)
    assert np.all(np.diff(density) <= 0.0)


@pytest.mark.parametrize("index", range(len(WINDS.members)), ids=WINDS.names)
def test_wind_is_finite_bounded_and_repeatable(world, index):
    """Bound: 2 km/s, what the steepest shear given here reaches 1,000 km up."""
    _, _, wind, table = world
    found = np.array([wind_of_model(index, wind, table, alt) for alt in ALTITUDES])
    assert found.shape == (len(ALTITUDES), 2)
    assert np.all(np.isfinite(found)) and np.all(np.abs(found) < 2e3)
    assert np.array_equal(found, [wind_of_model(index, wind, table, alt) for alt in ALTITUDES])


CANOPY = {
    "diameter_m": 16.0,
    "drag_coefficient": 0.62,
    "mortar_speed_m_s": 30.0,
    "line_length_m": 31.0,
    "confluence_m": (0.0, 0.0, 0.0),
}
BURNING = {
    "full_thrust_n": 7500.0,
    "throttle_max_n": 5000.0,
    "full_specific_impulse_s": 300.0,
    "nozzle_m": (0.0, 0.0, 0.0),
}


@pytest.mark.parametrize("name", PARACHUTE_MODELS.names)
def test_parachute_fills_from_nothing_to_its_whole_area_and_is_repeatable(name):
    chute = np.zeros(1, PARACHUTE_PARAMS)[0]
    fill(chute, ParachuteParams(name="main", model=name, **CANOPY))
    times, machs = np.linspace(-1.0, 60.0, 6101), np.linspace(0.0, 30.0, 301)
    share = np.array([inflation(chute, t) for t in times])
    drag = np.array([efficiency_of_model(chute["model"], chute, chute, mach) for mach in machs])
    assert np.all(np.isfinite(share)) and np.all((share >= 0.0) & (share < 2.0))
    assert np.all(share[times <= 0.0] == 0.0) and share[-1] == 1.0
    assert np.all((drag > 0.0) & (drag <= 1.0)) and drag[0] == 1.0
    assert np.array_equal(share, [inflation(chute, t) for t in times])


@pytest.mark.parametrize("name", [name for name in ENGINE_MODELS.names if name != "thruster_set"])
def test_engine_stays_between_none_and_full_thrust_comes_to_both_and_is_repeatable(name):
    engine = np.zeros(1, ENGINE)[0]
    fill(engine, EngineParams(name="main", model=name, **BURNING))

    def burn():
        thrust, levels = 0.0, []
        for k, command in enumerate(np.repeat([7500.0, 1500.0, 60.0, 5000.0, 7500.0, 0.0], 4000)):
            goal, _ = thrust_goal(engine, 1e-3 * k, 1e-3, command)
            thrust += 1e-3 * thrust_rate(engine, goal, thrust, command in (0.0, 7500.0))
            levels.append(thrust)
        return np.array(levels)

    levels = burn()
    assert np.all(np.isfinite(levels)) and levels.min() >= 0.0 and levels.max() <= 7500.0
    assert levels[3999] == pytest.approx(7500.0) and levels[-1] == pytest.approx(0.0, abs=1e-3)
    flows = np.array([propellant_flow(engine, level) for level in (0.0, 60.0, 7500.0)])
    assert flows[0] == 0.0 and np.all(flows[1:] > 0.0) and np.all(np.isfinite(flows))
    assert np.array_equal(levels, burn())


def test_engine_of_thrusters_gives_nothing_of_its_own():
    engine = np.zeros(1, ENGINE)[0]
    fill(engine, EngineParams(name="main", model="thruster_set", **BURNING))
    assert thrust_goal(engine, 0.0, 1e-3, 7500.0) == (0.0, 0.0)
    assert thrust_rate(engine, 0.0, 0.0, True) == 0.0 and propellant_flow(engine, 0.0) == 0.0


def looking_down(r, rng):
    """An attitude in which x of B points about to the centre of the planet."""
    x = -r / np.linalg.norm(r)
    y = np.cross(x, (0.0, 0.0, 1.0)) / np.hypot(x[0], x[1])
    attitude = np.array(from_axes(tuple(x), tuple(y), tuple(np.cross(x, y)))) + 0.05 * rng.normal(size=4)
    return attitude / np.linalg.norm(attitude)


def measured(loaded, index, seed, cycles=12):
    """What one sensor writes into a record full of a mark, over some cycles of a plant that moves."""
    case, tables, _ = build_records(loaded)
    case["sensors"] = np.zeros(1, SENSOR_UNITS)
    carried = SensorParams(carried=[SENSOR_FAMILY.names[index]])
    fill_sensor_params(case[0]["sensors"], carried)
    draw_sensor_units(case[0]["sensors"], carried, 0, 0)
    plant, outputs = initial_plant(loaded.truth, case)[0], np.zeros(1, OUTPUTS)[0]
    plant["y"][:3] *= 1.0 - 127.84e3 / np.linalg.norm(plant["y"][:3])  # 100 m above the ground
    plant["imagers"]["camera_trigger"] = plant["imagers"]["scan"] = 1
    rng, sensors, rows = np.random.default_rng(seed), initial_sensors()[0], []
    for _ in range(cycles):
        plant["t"] += 0.04
        plant["y"][:6] += rng.normal(size=6) * 10.0
        plant["y"][6:10] = looking_down(plant["y"][:3], rng)
        plant["y"][10:13] = rng.normal(size=3) * 0.02
        plant["velocity_gain"] += rng.normal(size=3)
        plant["branch_used"] += rng.uniform(0.0, 1e-3, plant["branch_used"].shape)
        outputs["specific_force_B"], outputs["height"] = rng.normal(size=3), rng.uniform(0.0, 1e4)
        outputs["wing_opening"], outputs["pads"] = rng.uniform(), rng.integers(0, 5)
        outputs["altitude"], outputs["pressure"], plant["shape"] = 120e3, rng.uniform(), rng.integers(0, 3)
        for name in SENSED.names:
            sensors["sensed"][name] = -77
        sense(case[0], tables[0], plant, outputs, sensors)
        rows.append(sensors["sensed"].copy())
    return np.array(rows, SENSED)


def plain(rows):
    """The numbers of one field, a row for each row, whether it is a number, an array or a record."""
    if rows.dtype.names is None:
        return rows.reshape(len(rows), -1)
    return np.hstack([plain(rows[name]) for name in rows.dtype.names])


@pytest.mark.parametrize("index", range(len(SENSOR_FAMILY.members)), ids=SENSOR_FAMILY.names)
def test_sensor_writes_its_part_of_the_record_finite_and_repeatable(index):
    site = ("latitude_deg=37.953", "longitude_deg=110.282")  # below the initial state
    over_site = [f"terrain.site_{name}" for name in site]
    loaded = edl6dof.load("tianwen1", ["terrain.landing_area.model=generated", *over_site])
    rows, writes = measured(loaded, index, 1), SENSOR_FAMILY.members[index].writes
    assert writes and set(writes) <= set(SENSED.names) - {"t"}
    for name in set(SENSED.names) - {"t"}:
        values = plain(rows[name])
        assert np.all(np.isfinite(values)), name
        assert np.any(values != -77, axis=1).all() == (name in writes), name
        assert name in writes or np.all(values == -77), name
    assert measured(loaded, index, 1).tobytes() == rows.tobytes()
    assert measured(loaded, index, 2).tobytes() != rows.tobytes()


def test_sensors_fly_at_once_each_with_its_memory_and_a_later_one_writes_over():
    loaded = edl6dof.load("tianwen1", ["sensors.set=perfect"])
    records = build_records(loaded)
    plant, outputs = initial_plant(loaded.truth, records.case)[0], np.zeros(1, OUTPUTS)[0]
    sensors = initial_sensors()[0]
    sense(records.case[0], records.tables[0], plant, outputs, sensors)
    assert sensors["imu"]["taken"] == 1
    assert np.array_equal(sensors["sensed"]["r_I"], plant["y"][:3])
    assert np.array_equal(sensors["sensed"]["imu_rate_B"], plant["y"][10:13])


def test_a_choice_of_sensors_that_leaves_something_unmeasured_is_refused():
    needed = SENSED.names[1:9]
    assert needed[-1] == "imu_gain_B"
    assert sensor_problems(SensorParams(), needed) == {}
    assert sensor_problems(SensorParams(carried=["imu"], set="perfect"), needed) == {}
    assert sensor_problems(SensorParams(carried=["perfect"]), needed) == {
        "sensors.carried": "measures no imu_rate_B, imu_gain_B: carry imu too"
    }
    assert "carry perfect" in sensor_problems(SensorParams(carried=["imu"]), needed)["sensors.carried"]
    twice = sensor_problems(SensorParams(carried=["imu", "perfect", "imu"]), needed)
    assert twice == {"sensors.carried": "names imu twice"}


@pytest.mark.parametrize("member", DISTRIBUTIONS.members, ids=DISTRIBUTIONS.names)
def test_distribution_rises_with_the_unit_number_and_is_finite_at_both_ends(member):
    unit = np.concatenate([[0.0], np.linspace(1e-6, 1.0 - 1e-6, 999), [np.nextafter(1.0, 0.0)]])
    params = member.params(kind=member.name, **GIVEN.get(member.name, {}))
    values = params.values(unit, 10.0).astype(float)
    assert values.shape == unit.shape and np.all(np.isfinite(values))
    assert np.all(np.diff(values) >= 0.0) and values[0] < values[-1]
    assert np.array_equal(values, params.values(unit, 10.0).astype(float))


@pytest.mark.parametrize("member, nominal", [*product(DISTRIBUTIONS.members, (7.0, 10.0))])
def test_distribution_gives_each_case_its_own_value_whatever_the_others_are(member, nominal):
    params, unit = member.params(kind=member.name, **GIVEN.get(member.name, {})), np.array([0.1, 0.5, 0.9])
    whole = params.values(unit, nominal)
    assert [params.values(unit[k : k + 1], nominal)[0] for k in range(3)] == list(whole)
