"""The polynomial drag-energy profile against numpy's polynomials, adaptive quadrature and flights of a point
mass.
"""

from math import asin, atan2, cos, degrees, pi, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from edl6dof.fsw.guidance.entry.drag_energy import PROFILE, evaluate, polynomial_goal, refit
from edl6dof.fsw.guidance.entry.reference import REFERENCE
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS, bank_side
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import fly

FIRST, LAST = 450.0, 4900.0


def profile(energy):
    """Drag of an entry at constant path angle over energy (Allen & Eggers): E ln(E0/E) and a little."""
    return 4.0 + 2.3e-5 * energy * np.log(1.3e7 / energy)


def ground(energy):
    return 0.97 + 0.02 * np.cos(np.sqrt(2.0 * energy) / 900.0)


def reference():
    table = np.zeros(1, REFERENCE)[0]
    n = len(table["drag"])
    table["first"], table["spacing"] = FIRST, (LAST - FIRST) / (n - 1)
    table["handover"] = FIRST
    energy = 0.5 * (FIRST + table["spacing"] * np.arange(n)) ** 2
    table["drag"], table["ground"] = profile(energy), ground(energy)
    return table


def drag_of(memory, energy):
    x = (energy - 0.5 * FIRST**2) / (memory["energy"] - 0.5 * FIRST**2)
    return np.polynomial.polynomial.polyval(x, memory["coefficient"])


def range_of(drag, energy):
    return quad(lambda e: ground(e) / drag(e), 0.5 * FIRST**2, energy, epsrel=1e-10, limit=200)[0]


def test_value_and_derivatives_are_those_of_numpy():
    coefficient = np.random.default_rng(3).normal(size=7)
    poly = np.polynomial.Polynomial(coefficient)
    for x in (0.0, 0.3, 1.0):
        assert evaluate(coefficient, x) == pytest.approx((poly(x), poly.deriv()(x), poly.deriv(2)(x)))


@pytest.mark.parametrize("speed", [4700.0, 3000.0, 1200.0])
def test_first_fit_follows_the_reference(speed):
    memory, energy = np.zeros(1, PROFILE)[0], 0.5 * speed**2
    refit(reference(), energy, 0.0, 0.0, memory)
    e = np.linspace(0.5 * FIRST**2, energy, 200)
    assert drag_of(memory, e) == pytest.approx(profile(e), abs=0.02 * np.max(profile(e)))


@pytest.mark.parametrize("factor", [0.85, 0.97, 1.0, 1.1])
@pytest.mark.parametrize("speed", [4700.0, 2500.0, 1000.0])
def test_refitted_profile_predicts_the_wanted_range(factor, speed):
    """By adaptive quadrature along the fitted polynomial; update after update on less and less energy."""
    table, memory = reference(), np.zeros(1, PROFILE)[0]
    for share in (1.0, 0.8, 0.6):
        energy = 0.5 * (speed * share) ** 2
        wanted = factor * range_of(profile, energy)
        refit(table, energy, wanted, 0.4, memory)
        assert range_of(lambda e: drag_of(memory, e), energy) == pytest.approx(wanted, rel=2e-3)


@pytest.mark.parametrize("factor", [0.9, 1.0, 1.1])
def test_profile_ends_where_range_control_ends_and_the_planned_range_from_there_is_added(factor):
    """By adaptive quadrature down to there; the rest is inversely proportional to the drag at that energy."""
    table, memory, end = reference(), np.zeros(1, PROFILE)[0], 1100.0
    table["handover"], table["coast"], energy = end, 75e3, 0.5 * 4000.0**2
    for share in (1.0, 0.7, 0.4):
        energy *= share
        rest = range_of(profile, energy) - range_of(profile, 0.5 * end**2)
        wanted = factor * (75e3 + rest)
        refit(table, energy, wanted, 0.4, memory)

        def drag(e, span=float(memory["energy"]) - 0.5 * end**2):
            return np.polynomial.polynomial.polyval((e - 0.5 * end**2) / span, memory["coefficient"])

        followed = quad(lambda e: ground(e) / drag(e), 0.5 * end**2, energy, epsrel=1e-10, limit=200)[0]
        coast = 75e3 * profile(0.5 * end**2) / drag(0.5 * end**2)
        assert followed + coast == pytest.approx(wanted, rel=2e-3)


def test_aim_point_out_of_reach_does_not_drive_the_profile_away():
    table, memory = reference(), np.zeros(1, PROFILE)[0]
    for speed in np.arange(4500.0, 1000.0, -50.0):
        refit(table, 0.5 * speed**2, 0.0, 0.4, memory)
    e = np.linspace(0.5 * FIRST**2, 0.5 * speed**2, 50)
    assert np.all(drag_of(memory, e) < 1.8 * 1.8 * profile(e))
    assert np.all(drag_of(memory, e) > profile(e))


def test_goal_derivatives_are_those_along_the_flight(onboard):
    """Energy changes as dE = -V D dt along a short flight with constant D''; five-point differences of the
    goal.
    """
    record, params = onboard[0], onboard[0]["guidance"]["entry"]["fl"]["profile"]
    record["guidance"]["entry"]["tracking"]["update"] = 0
    memory, out, nav = np.zeros(1, PROFILE)[0], np.zeros(1, GUIDE)[0], np.zeros(1, NAV)[0]
    v0, gamma, g, d0, d1, d2 = 3300.0, radians(-9.0), 3.6, 40.0, 1.1, -0.03

    def at(t):
        """Speed, drag, and energy with V' = -D - g sin(gamma), E' = -V D, g and gamma held."""
        drag = d0 + d1 * t + 0.5 * d2 * t * t
        steps = np.linspace(0.0, t, 201)
        speed = np.array([v0 - (d0 * s + d1 * s * s / 2 + d2 * s**3 / 6) - g * sin(gamma) * s for s in steps])
        power = speed * (d0 + d1 * steps + 0.5 * d2 * steps**2)
        return speed[-1], drag, 5.9e6 - np.trapezoid(power, steps)

    def goal(t):
        nav["speed"], nav["drag"], nav["energy"] = at(t)
        nav["flight_path_angle"], nav["gravity"] = gamma, g
        return polynomial_goal(record, nav, params, memory, nav["drag"], d1 + d2 * t, out)

    goal(-10.0)  # the first call fits the energy that is left
    h = 0.2
    value, rate, acceleration = goal(0.0)
    m2, m1, p1, p2 = (goal(k * h)[0] for k in (-2, -1, 1, 2))
    assert rate == pytest.approx((8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * h), rel=1e-4)
    assert acceleration == pytest.approx(
        (16.0 * (p1 + m1) - (p2 + m2) - 30.0 * value) / (12.0 * h * h), rel=1e-3, abs=1e-6
    )


# ---- heading corridor --------------------------------------------------------------------------------------


def test_heading_corridor_compares_the_angle_at_the_vehicle(onboard):
    """The heading error recovered from range and crossrange is the one of vector geometry; reversal only past
    the corridor.
    """
    record, logic = onboard[0], REVERSALS.names.index("heading_corridor")
    corridor = record["guidance"]["entry"]["reversal"]["heading_corridor"]
    radius = record["planet"]["equatorial_radius"]
    corridor["near"], corridor["far"], corridor["far_range"] = radians(1.0), radians(9.0), 200e3
    nav, memory, out = np.zeros(1, NAV)[0], np.zeros(1, REVERSALS.memory)[0], np.zeros(1, GUIDE)[0]
    for distance, limit in ((0.0, 1.0), (50e3, 3.0), (200e3, 9.0), (500e3, 9.0)):
        arc = max(distance, 1.0) / radius
        for error in (0.99 * limit, 1.01 * limit):
            target = np.array([cos(arc), 0.0, sin(arc)])  # due north of a vehicle at (1, 0, 0)
            # turned east: target on its left
            heading = np.array([0.0, sin(radians(error)), cos(radians(error))])
            left = np.cross([1.0, 0.0, 0.0], heading)
            out["range_to_go"], out["crossrange"] = (
                radius * atan2(target[2], target[0]),
                radius * asin(target @ left),
            )
            for sign in (1.0, -1.0):
                out["crossrange"] *= sign
                turned = bank_side(
                    logic, record["guidance"]["entry"]["reversal"], record, nav, memory, out, 1.0, sign
                )
                assert turned == (-sign if error > limit else sign)
                assert (
                    bank_side(
                        logic, record["guidance"]["entry"]["reversal"], record, nav, memory, out, 1.0, -sign
                    )
                    == -sign
                )  # already turning back
                out["crossrange"] *= sign


# ---- closed loop -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["fl", "ehgo_fl"])
@pytest.mark.parametrize(
    "density_factor",
    [pytest.param(0.9, marks=pytest.mark.long), pytest.param(1.0, marks=pytest.mark.long), 1.1],
)
def test_laws_fly_a_point_mass_to_the_parachute_target(law, density_factor):
    """Tianwen-1 as a point mass in the Mars-GRAM atmosphere with wind; the flight computer believes the
    nominal density.
    """
    flight = fly(
        load_scenario(
            "tianwen1",
            [
                "dynamics=point_mass",
                "mission.goal=deployment",
                f"flight_software.guidance.entry.law={law}",
                f"truth={{atmosphere.density_factor: {density_factor}}}",
            ],
        )
    )
    assert flight.figures["parachute_miss_m"] < 4000.0
    banks = flight.telemetry["guide.bank_deg"]
    assert np.max(np.abs(banks)) <= degrees(pi) and sqrt(np.mean(banks**2)) > 10.0
