"""The designed bank profile against a brute-force scan, its limits, and the flight; and its command."""

import numpy as np
import pytest
from scipy.optimize import brentq

import edl6dof
from edl6dof.cli.designs import design_entry as design_entry_command
from edl6dof.config.errors import ConfigError
from edl6dof.design.entry_profile import CLOSE, design_entry, figures, with_points
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.planned_entry import fly_shifted, planned_again
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import start_of

LIMITS = "flight_software.guidance.entry.limits"


def msl(*overrides):
    return load_scenario("msl", list(overrides)).scenario


@pytest.fixture(scope="module")
def highest():
    return design_entry(msl(), "parachute_altitude", 6, 10.0)


def test_no_profile_of_two_points_opens_the_parachute_higher():
    """Every bank angle at the low speed in steps of 3 deg, with the one at the high speed that meets the
    range.
    """
    scenario = msl()
    onboard, start = build_onboard(scenario), start_of(scenario)
    found = design_entry(scenario, "parachute_altitude", 2, 10.0)
    (slow, _), (fast, _) = found.after.points

    def rows(banks):
        return fly_shifted(with_points(onboard, list(zip((slow, fast), banks, strict=True)))[0], start, 0.0)

    best = -np.inf
    for low in np.arange(25.0, 95.1, 3.0):

        def beyond(high, low=low):
            return float(rows((low, high))["beyond"][-1])

        if beyond(25.0) * beyond(95.0) < 0.0:
            best = max(best, float(rows((low, brentq(beyond, 25.0, 95.0, xtol=0.01)))["altitude"][-1]))
    assert found.after.altitude_m > best - 40.0  # reversals, a cycle apart, are worth as much
    assert not found.broken


def test_design_is_higher_within_all_limits_and_lies_on_some(highest):
    assert highest.after.altitude_m > highest.before.altitude_m + 200.0
    assert not highest.broken and abs(highest.after.beyond_m) < CLOSE
    slack = highest.limits.slack(highest.after)
    assert min(slack.values()) > -1e-3
    assert slack["reserve"] == pytest.approx(0.0, abs=1e-6)  # full lift late, as far as the reserve lets


@pytest.mark.parametrize("name", ["msl", pytest.param("zheng2015", marks=pytest.mark.long)])
def test_what_the_design_is_beside_is_the_plan_of_the_scenario(name):
    """However few the points of the design: it is flown through the same rows."""
    scenario = load_scenario(name).scenario
    plan = planned_again(build_onboard(scenario), scenario)
    before = design_entry(scenario, "parachute_altitude", 2, 10.0).before
    assert before.beyond_m == pytest.approx(float(plan["beyond"][-1]), abs=1.0)
    assert before.altitude_m == pytest.approx(float(plan["altitude"][-1]), abs=1.0)


def test_a_load_limit_presses_the_load_down_to_it(highest):
    pressed = design_entry(msl(f"{LIMITS}.load_g0=13.4"), "parachute_altitude", 6, 10.0)
    limit = 0.9 * 13.4
    assert pressed.before.load_g0 > limit
    assert 0.97 * limit < pressed.after.load_g0 < 1.001 * limit
    assert pressed.after.altitude_m < highest.after.altitude_m + 40.0


def test_least_dispersion_misses_by_less_without_guidance(highest):
    calm = design_entry(msl(), "dispersion", 6, 10.0)
    assert calm.after.dispersion_m < calm.before.dispersion_m - 100.0
    assert calm.after.dispersion_m < highest.after.dispersion_m


def test_planned_loads_and_misses_are_those_of_the_flight(highest):
    """The rigid body's own loads under guidance; and the mean of both signs of a sensitivity."""
    flight = edl6dof.fly("msl", ["sensors.set=perfect"])
    assert highest.before.load_g0 == pytest.approx(flight.figures["peak_load_g0"], rel=0.03)
    onboard, start = build_onboard(msl()), start_of(msl())
    thin, dense = onboard.copy(), onboard.copy()
    thin[0]["atmosphere"]["ln_density"] -= np.log(1.0 + 0.2 / 3.0)
    dense[0]["atmosphere"]["ln_density"] += np.log(1.0 + 0.2 / 3.0)
    points, shift = highest.before.points, float(onboard[0]["reference"]["shift"])
    ends = [figures(record, start, points, shift).beyond_m for record in (thin, dense)]
    assert highest.before.misses_m[0] == pytest.approx(0.5 * (ends[1] - ends[0]), rel=0.3)


def run_design_entry(scenario="msl", **options):
    """Status of the command."""
    return design_entry_command(scenario, **({"points": 3} | options))


def test_command_writes_a_scenario_whose_plan_is_the_designed_one_with_what_was_set(tmp_path, capsys):
    target = tmp_path / "designed.yaml"
    steeper = ("initial.flight_path_angle_deg=-15.6", "vehicle.rcs.thrusters.0.thrust_n=250.0")
    assert run_design_entry(out=target, sets=list(steeper)) == 0
    assert "altitude of the parachute" in capsys.readouterr().out
    scenario = load_scenario(str(target)).scenario
    points = scenario.flight_software.guidance.entry.reference_bank.points
    assert scenario.name == "msl_designed" and len(points) == 3
    assert scenario.initial.flight_path_angle_deg == -15.6
    assert scenario.vehicle.rcs.thrusters[0].thrust_n == 250.0
    assert abs(float(build_onboard(scenario)[0]["reference"]["shift"])) < 0.02
    with pytest.raises(ConfigError, match="exists; name another file"):
        run_design_entry(out=target)


def test_a_plan_out_of_reach_says_what_to_change(capsys):
    far = "terrain.site_longitude_deg=140.5"
    assert run_design_entry(sets=[far], points=2) == 1
    assert "move the landing site" in capsys.readouterr().out


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"minimise": "load"}, "--minimise: must be 'dispersion'"),
        ({"maximise": "dispersion"}, "--maximise: must be 'parachute_altitude'"),
        ({"maximise": "parachute_altitude", "minimise": "dispersion"}, "cannot both be given"),
        ({"scenario": "earth_drop"}, "no phase with guidance: entry"),
        ({"reserve": 46.0}, "leaves nothing between"),
    ],
)
def test_bad_options_are_refused(changes, message):
    with pytest.raises(ConfigError, match=message):
        run_design_entry(**changes)


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="must end in"):
        run_design_entry(out=tmp_path / "plan.csv")
