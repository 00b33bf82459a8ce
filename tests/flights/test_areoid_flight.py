"""A flight over the areoid: air and ground count from it, positions from the ellipsoid."""

import json
from math import radians

import numpy as np
import pytest

import edl6dof
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.atmosphere import air
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.scenario import records
from edl6dof.sim.flight import fly

ON = ("planet.areoid=mars_gmm3_degree12",)
START = 3_513_696.0  # m from the centre: Tianwen-1 at entry


@pytest.fixture(scope="module")
def flown():
    return edl6dof.fly("tianwen1", ON)


def areoid_below(flight, rows):
    """Height (m) of the areoid above the ellipsoid, under each of some rows."""
    table = flight.telemetry
    return np.array(
        [
            areoid_height(
                flight.scenario.planet,
                radians(table["truth.latitude_deg"][i]),
                radians(table["truth.longitude_deg"][i]),
            )
            for i in rows
        ]
    )


def test_the_entry_state_stays_where_it_is_in_space(flown):
    table = edl6dof.load("tianwen1").scenario
    places = [
        records.initial_plant(s, records.build_case(s, records.build_tables(s)))["y"][0, :6]
        for s in (table, flown.scenario)
    ]
    assert np.array_equal(*places)
    assert np.linalg.norm(places[0][:3]) == pytest.approx(START, abs=1.0)


def test_height_above_the_areoid_may_be_given_instead(flown):
    initial = flown.scenario.initial
    areoid = areoid_height(
        flown.scenario.planet, radians(initial.latitude_deg), radians(initial.longitude_deg)
    )
    given = {**initial.model_dump(exclude_none=True), "height_above_areoid_m": initial.altitude_m - areoid}
    del given["altitude_m"]
    scenario = edl6dof.load("tianwen1", [*ON, f"initial={json.dumps(given)}"]).scenario
    assert abs(areoid) > 100.0
    assert scenario.initial_altitude_m == pytest.approx(initial.altitude_m, abs=1e-6)


def test_the_four_heights_agree_all_the_way_down(flown):
    table, rows = flown.telemetry, range(0, len(flown.telemetry["t_s"]), 250)
    areoid = areoid_below(flown, rows)
    altitude, above, elevation, height = (
        table[f"truth.{name}_m"][:: rows.step]
        for name in ("altitude", "height_above_areoid", "elevation", "height")
    )
    assert np.abs(areoid).max() > 400.0 and np.ptp(areoid) > 50.0
    assert altitude - above == pytest.approx(areoid, abs=0.02)  # the plane is a cycle old at most
    assert above - height == pytest.approx(elevation, abs=0.02)
    assert elevation[-1] == pytest.approx(flown.scenario.terrain.site_elevation_m, abs=500.0)


def test_the_air_is_that_at_the_height_above_the_areoid(flown):
    tables = records.build_tables(flown.scenario)[0]["atmosphere"]
    case, table = flown.case[0], flown.telemetry
    for i in range(0, len(table["t_s"]), 1000):
        density, *_ = air(
            case["atmosphere"], case["planet"]["gas"], tables, table["truth.height_above_areoid_m"][i]
        )
        assert table["truth.density_kg_m3"][i] == density


def test_it_lands_on_the_ground_and_debris_rests_on_it(flown):
    assert flown.termination.reached
    above_site = flown.telemetry["truth.site_up_m"][-1] - flown.telemetry["truth.elevation_m"][-1]
    drop = np.hypot(flown.telemetry["truth.site_east_m"][-1], flown.telemetry["truth.site_north_m"][-1]) ** 2
    assert above_site - 4099.4 + drop / 2.0 / 3.39e6 == pytest.approx(0.0, abs=20.0)


def test_the_flight_computer_takes_the_areoid_to_stand_where_it_does_at_the_site(flown):
    table = "atmosphere.model=table"  # the same at the same height, whatever its gravity
    scenarios = [edl6dof.load("tianwen1", [table, planet]).scenario for planet in ("planet.areoid=''", *ON)]
    areoid = flown.scenario.site_areoid_m
    believed = [records.build_onboard(scenario)[0] for scenario in scenarios]
    assert areoid == pytest.approx(466.0, abs=30.0)
    assert believed[1]["site"]["altitude"] - believed[0]["site"]["altitude"] == pytest.approx(areoid)
    for height in (-4000.0, 8000.0, 60e3):
        assert model_atmosphere(believed[1]["atmosphere"], height + areoid) == pytest.approx(
            model_atmosphere(believed[0]["atmosphere"], height), rel=1e-9
        )


@pytest.mark.long  # of the suite: test_repeatable.py
def test_a_flight_goes_on_from_a_saved_state_with_the_same_bits(flown):
    saved = fly(flown.loaded, save_at_s=200.0).saved
    rest = fly(flown.loaded, start=saved)
    rows = len(rest.log)
    assert 1000 < rows < len(flown.log)
    assert rest.log.tobytes() == flown.log[-rows:].tobytes()
