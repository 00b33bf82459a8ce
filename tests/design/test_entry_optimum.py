"""The best end of an entry against nonlinear programming on the same motion, a grid, and the simulator."""

import json

import entry_optimum
import numpy as np
import pytest
from entry_optimum import KNOTS, MET, Entry, best
from scipy.optimize import minimize

import edl6dof
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import start_of

pytest.importorskip("cvxpy")
ENTRY = "flight_software.guidance.entry"


def model(name, *overrides):
    scenario = load_scenario(name, list(overrides)).scenario
    return build_onboard(scenario), np.array(start_of(scenario))


def highest_by_slsqp(entry, first):
    """Altitude (m) of the best flight to the aim point of sequential quadratic programming."""

    def shaped(x):
        return x.reshape(KNOTS, 2)

    limits = [
        {"type": "eq", "fun": lambda x: entry.ends(shaped(x))[:2] / 1e3},
        {"type": "ineq", "fun": lambda x: 1.0 - np.square(shaped(x)).sum(1)},
        {"type": "ineq", "fun": lambda x: shaped(x)[:, 0] - entry.least_up},
    ]
    found = minimize(
        lambda x: -entry.ends(shaped(x))[2] / 1e3,
        np.tile(first, (KNOTS, 1)).ravel(),
        jac=lambda x: -entry.slopes(shaped(x))[2] / 1e3,
        method="SLSQP",
        constraints=limits,
        options={"maxiter": 200},
    )
    beyond, aside, altitude = entry.ends(shaped(found.x))
    assert np.hypot(beyond, aside) < MET
    return altitude


FIRST = {"msl": (0.7, 0.2), "tianwen1": (0.5, 0.0)}


@pytest.mark.parametrize("name", FIRST)
def test_nonlinear_programming_opens_the_parachute_no_higher(name):
    onboard, start = model(name)
    found = best(onboard[0], start)
    assert found.miss_m < MET
    assert found.altitude_m == pytest.approx(
        highest_by_slsqp(Entry(onboard[0], start), FIRST[name]), abs=25.0
    )


def test_wrong_slope_of_the_altitude_is_found(monkeypatch):
    """Planted error: without the slope of the altitude the programs only meet the aim point."""
    onboard, start = model("msl")
    entry = Entry(onboard[0], start)
    true = highest_by_slsqp(entry, FIRST["msl"])
    right = Entry.slopes
    monkeypatch.setattr(
        entry_optimum.Entry, "slopes", lambda self, lifts: right(self, lifts) * [[1.0], [1.0], [0.0]]
    )
    assert best(onboard[0], start).altitude_m < true - 200.0


@pytest.mark.parametrize("short_km", [500.0, -260.0])
def test_out_of_reach_no_constant_lift_ends_nearer(short_km):
    """Aim points moved along the equator, beyond and before the reach of ``zheng2015``."""
    onboard, start = model("zheng2015")
    site, planet = onboard[0]["site"], onboard[0]["planet"]
    site["aim_longitude"] += 1e3 * short_km / planet["equatorial_radius"]
    found, entry = best(onboard[0], start), Entry(onboard[0], start)
    assert found.miss_m > 5e3
    for up in np.linspace(max(entry.least_up, -1.0), 1.0, 21):
        for right in np.linspace(-1.0, 1.0, 21) * np.sqrt(max(1.0 - up * up, 0.0)):
            end = entry.ends(np.tile([up, right], (KNOTS, 1)))
            assert np.hypot(*end[:2]) > found.miss_m - 20.0


def test_nearest_end_is_that_of_the_simulator():
    """An aim point far ahead and aside takes all lift to one side, which a bank angle can fly."""
    away = ["terrain.site_latitude_deg=-3.5"]
    onboard, start = model("zheng2015", *away)
    onboard[0]["site"]["aim_longitude"] += np.radians(1.0)
    found = best(onboard[0], start)
    length = np.linalg.norm(found.lifts, axis=1)
    assert length.min() > 0.99
    entry = Entry(onboard[0], start)
    knots = np.linspace(entry.lowest, np.linalg.norm(start[3:]), KNOTS)
    speeds = np.linspace(knots[0], knots[-1], 30)
    up, right = (np.interp(speeds, knots, part) for part in found.lifts.T)
    banks = np.degrees(np.arctan2(right, up))
    points = [{"at": float(v), "bank_deg": float(b)} for v, b in zip(speeds, banks, strict=True)]
    own = [
        *away,
        "mission.goal=deployment",
        f"{ENTRY}.law=bank_profile",
        f"{ENTRY}.reversal.logic=own_sign",
        f"{ENTRY}.bank_min_deg=0",
        f"{ENTRY}.heading.speed_m_s=0",
        f"{ENTRY}.preset_bank_deg={banks[-1]}",
        f"{ENTRY}.bank_profile={json.dumps({'points': points})}",
    ]
    flight = edl6dof.fly("zheng2015", own)
    place = [np.radians(flight.telemetry[f"truth.{name}_deg"][-1]) for name in ("latitude", "longitude")]
    lat, lon = place
    there = (np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat))
    here = tuple(start[:3] / np.linalg.norm(start[:3]))
    flown = np.array(entry_optimum.from_aim(onboard[0], here, there))
    assert np.hypot(*(flown - (found.beyond_m, found.aside_m))) < 500.0
    assert flight.telemetry["truth.altitude_m"][-1] == pytest.approx(found.altitude_m, abs=150.0)
