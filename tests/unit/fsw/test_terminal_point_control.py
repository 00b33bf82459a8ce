"""Influence coefficients against differences of flown trajectories and the adjoint equations by another
integrator, and the linear range law against its own formula.
"""

from math import acos, cos, degrees, exp, pi, radians, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.fsw.guidance.entry.laws.etpc import INFLUENCE, fill_influence, guide, lay_plan
from edl6dof.fsw.guidance.entry.reference import PLANNED
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

START = (125e3, 4800.0, radians(-11.58))


@pytest.fixture(scope="module")
def plain(shared_onboard):
    """One airframe for all Mach numbers and no trim wing, so that only the bank angle jumps, at a set
    speed.
    """
    onboard = shared_onboard.copy()
    for name in ("drag", "lift", "drag_with_wing"):
        onboard[0]["vehicle"]["airframe"][name] = 1.0
    onboard[0]["vehicle"]["airframe"]["wing_mach"] = 0.0
    return onboard


@pytest.fixture(scope="module")
def rows(plain):
    """The reference as scipy flies it over a sphere at rest."""
    by_time, final = rates(plain[0]), float(plain[0]["guidance"]["entry"]["final_speed"])

    def slow(t, x):
        return x[3] - final

    slow.terminal = True
    altitude, speed, gamma = START
    flight = solve_ivp(
        lambda t, x: by_time(x[3], x, 0.0)[0],
        (0.0, 900.0),
        [altitude, gamma, 0.0, speed],
        events=slow,
        rtol=1e-9,
        atol=1e-9,
        max_step=0.2,
    )
    found = np.zeros(len(flight.t), PLANNED)
    found["altitude"], found["path_angle"], found["beyond"], found["speed"] = flight.y
    found["drag"] = [by_time(x[3], x, 0.0)[1] for x in flight.y.T]
    return found


@pytest.fixture(scope="module")
def table(plain, rows):
    influence = np.zeros(1, INFLUENCE)[0]
    fill_influence(plain, rows, influence)
    return influence


def rates(record):
    """Rates of (altitude, path angle, range, speed) of the reference flight over a sphere at rest with ``u``
    added to its vertical L/D, and the drag.
    """
    planet, vehicle, air, entry = (
        record["planet"],
        record["vehicle"],
        record["atmosphere"],
        record["guidance"]["entry"],
    )
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    radius, mu = float(planet["equatorial_radius"]), float(planet["mu"])
    bank = acos(cos(entry["reference_bank"]["points"]["bank"][0]) + record["reference"]["shift"])

    def by_time(v, x, u):
        h, gamma = x[:2]
        r = radius + h
        g = mu / r**2
        drag = (
            0.5
            * exp(np.interp(h, nodes, air["ln_density"]))
            * v**2
            * vehicle["drag_area"]
            / vehicle["entry_mass"]
        )
        steered = v > entry["align_speed"]
        lift = drag * (vehicle["lift_to_drag"] * (cos(bank) if steered else 1.0) + (u if steered else 0.0))
        turn = lift / v + (v / r - g / v) * cos(gamma)
        slowing = -drag - g * sin(gamma)
        return np.array([v * sin(gamma), turn, v * cos(gamma) * radius / r, slowing]), drag

    return by_time


def motion(record):
    """d(altitude, path angle, range)/d(speed) of it."""
    by_time = rates(record)

    def by_speed(v, x, u):
        rate, _ = by_time(v, x, u)
        return rate[:3] / rate[3]

    return by_speed


def node_at(record, table, speed):
    """Number, speed, altitude and path angle of the node next to a speed, from its own drag and altitude
    rate.
    """
    air, vehicle = record["atmosphere"], record["vehicle"]
    k = round((speed - table["first"]) / table["spacing"])
    v = float(table["first"] + k * table["spacing"])
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    density = table["drag"][k] / (0.5 * v**2 * vehicle["drag_area"] / vehicle["entry_mass"])
    h = float(np.interp(-np.log(density), -air["ln_density"], nodes))
    return k, v, h, float(np.arcsin(table["climb"][k] / v))


def scale_height(air, h):
    """Density scale height (m) of the believed air at an altitude."""
    return -air["spacing"] / np.diff(air["ln_density"])[int((h - air["bottom"]) / air["spacing"])]


@pytest.mark.parametrize(
    "speed",
    [
        pytest.param(900.0, marks=pytest.mark.long),
        1800.0,
        pytest.param(3000.0, marks=pytest.mark.long),
        pytest.param(4200.0, marks=pytest.mark.long),
    ],
)
def test_influence_coefficients_are_differences_of_flown_ranges(plain, table, speed):
    record = plain[0]
    f, final = motion(record), float(record["guidance"]["entry"]["final_speed"])
    k, v0, h0, gamma0 = node_at(record, table, speed)

    def flown(h, gamma, u):
        way = solve_ivp(
            lambda v, x: f(v, x, u), (v0, final), [h, gamma, 0.0], rtol=1e-9, atol=1e-9, max_step=5
        )
        return way.y[2, -1]

    by_altitude = (flown(h0 + 100.0, gamma0, 0.0) - flown(h0 - 100.0, gamma0, 0.0)) / 200.0
    by_path = (flown(h0, gamma0 + 2e-4, 0.0) - flown(h0, gamma0 - 2e-4, 0.0)) / 4e-4
    by_lift = (flown(h0, gamma0, 2e-3) - flown(h0, gamma0, -2e-3)) / 4e-3
    by_drag = -by_altitude * scale_height(record["atmosphere"], h0) / table["drag"][k]
    assert table["by_drag"][k] == pytest.approx(by_drag, rel=0.01)
    assert table["by_climb"][k] == pytest.approx(by_path / (v0 * cos(gamma0)), rel=0.01)
    assert table["by_lift"][k] == pytest.approx(by_lift, rel=0.01)


@pytest.mark.parametrize(
    "speed",
    [
        pytest.param(900.0, marks=pytest.mark.long),
        pytest.param(1800.0, marks=pytest.mark.long),
        pytest.param(3000.0, marks=pytest.mark.long),
        4200.0,
    ],
)
def test_influence_coefficients_are_the_adjoints_of_the_reference(plain, table, speed):
    """Adjoint of J = range to go, speed as independent variable: l' = -(f_x l + s_x), m' = -(f_u l + s_u),
    both zero at the end.

    Source: Bryson & Ho 1975, section 2.3.  The Jacobians are differences of the rates, the reference comes
    from scipy.
    """
    record = plain[0]
    f = motion(record)
    final = float(record["guidance"]["entry"]["final_speed"])
    k, v0, h0, gamma0 = node_at(record, table, speed)

    flight = solve_ivp(
        lambda v, x: f(v, x, 0.0),
        (v0, final),
        [h0, gamma0, 0.0],
        rtol=1e-9,
        atol=1e-9,
        max_step=10.0,
        dense_output=True,
    )
    assert flight.y[2, -1] == pytest.approx(table["range"][k], abs=100.0)

    def adjoint(v, y):
        x = flight.sol(v)
        by_h = (f(v, x + [50.0, 0, 0], 0.0) - f(v, x - [50.0, 0, 0], 0.0)) / 100.0
        by_gamma = (f(v, x + [0, 1e-5, 0], 0.0) - f(v, x - [0, 1e-5, 0], 0.0)) / 2e-5
        by_u = (f(v, x, 1e-4) - f(v, x, -1e-4)) / 2e-4
        costate = np.array([y[0], y[1], 1.0])
        return [-by_h @ costate, -by_gamma @ costate, -by_u @ costate]

    out = solve_ivp(adjoint, (final, v0), [0.0, 0.0, 0.0], rtol=1e-7, atol=1e-7, max_step=10.0)
    by_altitude, by_path, by_lift = out.y[:, -1]
    by_drag = -by_altitude * scale_height(record["atmosphere"], h0) / table["drag"][k]
    assert table["by_drag"][k] == pytest.approx(by_drag, rel=0.01)
    assert table["by_climb"][k] == pytest.approx(by_path / (v0 * cos(gamma0)), rel=0.01)
    assert table["by_lift"][k] == pytest.approx(by_lift, rel=0.01)


def test_lift_has_authority_over_range_only_while_it_controls_it(plain, rows, table):
    """Heading alignment takes the bank angle over, and nothing is left to correct the range with."""
    onboard, found = plain.copy(), np.zeros(1, INFLUENCE)[0]
    onboard[0]["guidance"]["entry"]["heading"]["speed"] = 1500.0
    fill_influence(onboard, rows, found)
    speeds = found["first"] + found["spacing"] * np.arange(len(found["by_lift"]))
    assert np.all(found["by_lift"][speeds < 1500.0 - found["spacing"]] == 0.0)
    assert np.all(found["by_lift"][speeds > 1500.0 + found["spacing"]] > 1000.0)
    assert np.all(found["by_lift"] <= table["by_lift"] + 1.0)


def test_more_drag_shortens_and_more_lift_or_climb_lengthens_the_range(table):
    controlled = table["first"] + table["spacing"] * np.arange(len(table["drag"])) > 800.0
    assert np.all(table["by_drag"][controlled] < 0.0)
    assert np.all(table["by_climb"][controlled] > 0.0)
    assert np.all(np.diff(table["by_lift"][controlled]) > 0.0)  # authority is used up on the way


def wanted(onboard, speed, drag_error=0.0, climb_error=0.0, range_error=0.0):
    """Wanted cos(bank) at a node of the plan with measured departures."""
    influence, params = onboard[0]["plan"]["etpc"], onboard[0]["guidance"]["entry"]["etpc"]
    k = round((speed - influence["first"]) / influence["spacing"])
    nav, out = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
    nav["speed"] = influence["first"] + k * influence["spacing"]
    nav["drag"] = influence["drag"][k] + drag_error
    nav["flight_path_angle"] = np.arcsin((influence["climb"][k] + climb_error) / nav["speed"])
    nav["mach"], out["lift_ratio"] = 15.0, 1.0
    out["range_to_go"] = influence["range"][k] + range_error
    return cos(guide(params, influence, onboard[0], nav, None, out)), influence, k


@pytest.fixture(scope="module")
def planned(plain, rows):
    onboard = plain.copy()
    lay_plan(onboard, rows)
    return onboard


def test_on_the_reference_the_reference_lift_is_wanted(planned):
    cosine, influence, k = wanted(planned, 3000.0)
    assert cosine == pytest.approx(influence["lift"][k] / planned[0]["vehicle"]["lift_to_drag"], rel=1e-6)
    bank = acos(cos(pi / 2) + planned[0]["reference"]["shift"])
    assert degrees(acos(cosine)) == pytest.approx(degrees(bank), abs=0.05)


@pytest.mark.parametrize("departure", [{"range_error": 500.0}, {"drag_error": -0.3}, {"climb_error": 2.0}])
def test_departures_change_the_lift_by_the_predicted_miss_over_its_authority(planned, departure):
    base, influence, k = wanted(planned, 3000.0)
    cosine, _, _ = wanted(planned, 3000.0, **departure)
    miss = (
        departure.get("range_error", 0.0)
        - influence["by_drag"][k] * departure.get("drag_error", 0.0)
        - influence["by_climb"][k] * departure.get("climb_error", 0.0)
    )
    gain = planned[0]["guidance"]["entry"]["etpc"]["overcontrol"]
    change = gain * miss / influence["by_lift"][k] / planned[0]["vehicle"]["lift_to_drag"]
    assert cosine - base == pytest.approx(change, rel=1e-3)
