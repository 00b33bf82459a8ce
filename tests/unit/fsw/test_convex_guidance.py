"""Verifies: the kernels of convex guidance, against brute force, finite differences and Clarabel.

Sources: Acikmese & Ploen 2007; Yu, Elango, Acikmese 2021.  The interior-point method of Clarabel shares no
line with the projected gradients of the flight computer, nor its elimination of velocity and position.
"""

import sys
from dataclasses import replace
from math import cos, radians, tan
from pathlib import Path

import numpy as np
import pytest
from powered_flight import Guided, PointMass

from edl6dof.fsw.guidance import guidance_command
from edl6dof.fsw.guidance.powered.convex.flight_time import growth
from edl6dof.fsw.guidance.powered.convex.landing_plan import (
    CONTROLS,
    PLAN,
    control_at,
    lay_grid,
    shift_controls,
)
from edl6dof.fsw.guidance.powered.convex.pipg import nearest_thrust, outside, solve

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "tools"))
import point_mass_landing as conic
from point_mass_landing import (
    Landing,
    classic_mars,
    first_guess,
    held_controls,
    landing_record,
    plan_onboard,
    solve_onboard,
)

LANDER = Landing(
    mass=950.0,
    thrust=(1500.0, 4500.0),
    exhaust_speed=2942.0,
    gravity=3.72,
    position=(230.0, 420.0, 1090.0),
    velocity=(4.7, 8.5, -58.8),
    glide_slope=radians(10.0),
    tilt=radians(25.0),
    end_tilt=radians(3.0),
    full_thrust=7500.0,
)


def size(plan):
    return np.linalg.norm(plan["w"], axis=1)


@pytest.mark.parametrize(
    "tilt_deg", [pytest.param(25.0, marks=pytest.mark.long), 60.0, pytest.param(90.0, marks=pytest.mark.long)]
)
def test_nearest_thrust_is_the_cheapest_of_all_that_the_engine_can_give(tilt_deg):
    """Against a grid in the plane of the vertical and the start, where the answer lies by symmetry."""
    rng, tilt, low, high = np.random.default_rng(1), radians(tilt_deg), 1.5, 5.0
    side, up = np.meshgrid(np.linspace(0.0, high, 501), np.linspace(0.0, high, 501))
    bound = np.maximum(np.hypot(side, up), low)
    allowed = (bound <= high) & (up >= cos(tilt) * bound)
    for _ in range(60):
        start, price = rng.normal(0.0, 4.0, 3), rng.uniform(0.0, 2.0)
        far = 0.5 * ((side - np.hypot(*start[:2])) ** 2 + (up - start[2]) ** 2)
        least = np.min((price * bound + far)[allowed])
        u = np.array(nearest_thrust(tuple(start), price, low, high, cos(tilt)))
        size = max(np.linalg.norm(u), low)
        assert size <= high + 1e-12 and u[2] >= cos(tilt) * size - 1e-12
        worth = price * size + 0.5 * np.sum((u - start) ** 2)
        assert least - 0.2 < worth <= least + 1e-9


def test_control_at_a_time_is_that_of_its_interval_and_after_the_end_the_last():
    plan = np.zeros(1, PLAN).view(np.recarray)[0]
    plan["step"] = np.linspace(0.5, 1.5, CONTROLS)
    ends = np.cumsum(plan["step"])
    for end, step, k in zip(ends, plan["step"], range(CONTROLS), strict=True):
        assert [control_at.py_func(plan, end - share * step) for share in (0.99, 0.01)] == [k, k]
    assert control_at.py_func(plan, ends[-1] + 5.0) == CONTROLS - 1


def test_what_is_outside_the_cone_is_its_polar_part():
    """Moreau: a point is the sum of its projections on a cone and on the polar cone, orthogonal to each
    other.
    """
    rng, slope = np.random.default_rng(2), tan(radians(10.0))
    for point in rng.normal(size=(200, 3)):
        beyond = np.array(outside(tuple(point), slope))
        inside = point - beyond
        assert inside[2] >= slope * np.hypot(*inside[:2]) - 1e-12
        assert abs(inside @ beyond) < 1e-12
        assert beyond[2] <= -np.hypot(*beyond[:2]) / slope + 1e-12 or np.allclose(beyond, 0.0)


@pytest.mark.parametrize("full_time", [0.0, 5.0])
def test_basis_functions_of_the_end_are_orthonormal(full_time):
    plan = np.zeros(1, PLAN)
    plan["time"], plan["full_time"] = 40.0, full_time
    mean, norm = lay_grid(plan[0])
    step, slant = plan[0]["step"], plan[0]["slant"]
    assert np.sum(step) == pytest.approx(40.0)
    assert np.sum(step * slant**2) == pytest.approx(1.0)
    assert np.sum(step * slant) == pytest.approx(0.0, abs=1e-12)
    assert plan[0]["to_go"] == pytest.approx(mean + norm * slant)


def test_moved_plan_keeps_the_thrust_of_each_moment():
    plan = solve_onboard(replace(LANDER, full_time=6.0), 46.0)
    before, times = plan[0]["u"].copy(), 46.0 - plan[0]["to_go"]
    shift_controls(plan[0], 4.0, 42.0, 2.0)
    now = 4.0 + 42.0 - plan[0]["to_go"]
    for u, t in zip(plan[0]["u"], now, strict=True):
        nearest = np.argsort(np.abs(times - t))[:2]
        assert any(np.array_equal(u, before[i]) for i in nearest)


@pytest.mark.parametrize("state", [0, 1, 2, *(pytest.param(n, marks=pytest.mark.long) for n in range(3, 12))])
def test_fuel_is_that_of_an_interior_point_method(state):
    pytest.importorskip("clarabel")
    rng = np.random.default_rng(state)
    landing = replace(
        LANDER,
        position=(*rng.uniform(-600.0, 600.0, 2), rng.uniform(900.0, 1800.0)),
        velocity=(*rng.normal(0.0, 10.0, 2), rng.uniform(-90.0, -40.0)),
    )
    plan = plan_onboard(landing, 8.0, -2.0 * landing.position[2] / landing.velocity[2])[0]
    time, full = float(plan["time"]), float(plan["full_time"])
    landing = replace(landing, full_time=full)
    # a little later than the best, where strict equality at the end has a solution in any case
    cold = solve_onboard(landing, 1.01 * time)[0]
    reference = conic.solve(landing, held_controls(1.01 * time, CONTROLS, full))
    assert reference is not None
    assert cold["fuel"] == pytest.approx(reference.fuel, rel=1e-3)
    assert cold["miss"] + cold["height_error"] < 1.0 and np.linalg.norm(cold["end_velocity"]) < 0.05
    assert plan["fuel"] <= reference.fuel


@pytest.mark.parametrize(("slope_deg", "time"), [(0.0, 75.0), (4.0, 78.0), (4.0, 85.0)])
def test_glide_slope_costs_what_the_interior_point_method_says(slope_deg, time):
    pytest.importorskip("clarabel")
    landing = classic_mars(slope_deg)
    plan = solve_onboard(landing, time)[0]
    assert plan["converged"] == 1
    assert plan["fuel"] == pytest.approx(conic.solve(landing, held_controls(time, CONTROLS)).fuel, rel=1e-3)
    assert plan["fuel"] > 1.004 * solve_onboard(replace(landing, glide_slope=-2.0), time)[0]["fuel"]


def test_thrust_is_at_its_largest_at_its_least_and_at_its_largest_again():
    """Pontryagin: at most two switches; a control that holds one of them lies between."""
    landing = classic_mars()
    plan = solve_onboard(landing, 72.5)[0]
    thrust = size(plan) * plan["mass"]
    low, high = landing.thrust
    level = np.where(thrust > 0.99 * high, 1, np.where(thrust < 1.01 * low, -1, 0))
    assert np.sum(level == 0) <= 2
    assert [int(a) for a, b in zip(level, [0, *level], strict=False) if a != b and a != 0] == [1, -1, 1]


def test_growth_of_the_cost_with_time_is_what_two_solutions_say():
    landing = replace(LANDER, glide_slope=-2.0, end_tilt=LANDER.tilt, velocity=(4.7, 8.5, -30.0))
    record = landing_record(landing)
    for time in (50.0, 55.0, 60.0):
        plans = [solve_onboard(landing, t)[0] for t in (time - 1.0, time, time + 1.0)]
        slope = 0.5 * (plans[2]["cost"] - plans[0]["cost"])
        assert growth(record[0], plans[1]) == pytest.approx(slope, abs=0.25)


def test_best_time_beats_every_other():
    plan = plan_onboard(LANDER, 8.0, 37.0)[0]
    for full in np.arange(0.0, 20.0, 2.0):
        for time in np.arange(36.0, 56.0, 1.0):
            other = solve_onboard(replace(LANDER, full_time=full), time, most=300)
            if time - full >= 8.0:
                assert plan["cost"] < other[0]["cost"] + 0.3
    again = plan_onboard(LANDER, 8.0, 60.0)[0]
    assert again["cost"] == pytest.approx(plan["cost"], rel=5e-3)


def test_multipliers_that_have_died_away_are_nothing():
    """Handed on from plan to plan they would shrink into the subnormal numbers, where an iteration took 25 us
    in the place of 1.
    """
    landing, plan = landing_record(LANDER)[0], first_guess(LANDER, 40.0)[0]
    plan["glide"][:-1] = 1e-290
    solve(landing, 300, plan)
    assert (np.abs(plan["glide"][plan["glide"] != 0.0]) > 1e-100).all()


def test_unreachable_target_gives_the_least_landing_error():
    pytest.importorskip("clarabel")
    landing = replace(LANDER, position=(1500.0, 0.0, 1090.0), full_time=8.0, glide_slope=-2.0)
    plan = solve_onboard(landing, 48.0)[0]
    reference = conic.solve(landing, held_controls(48.0, CONTROLS, 8.0), miss_weight=1.0)
    assert reference is not None and reference.miss > 50.0
    assert plan["miss"] == pytest.approx(reference.miss, abs=1.0)
    assert plan["height_error"] < 0.5 and np.linalg.norm(plan["end_velocity"]) < 0.05


def test_what_cannot_be_stopped_is_flagged():
    plan = plan_onboard(replace(LANDER, position=(0.0, 0.0, 300.0), velocity=(0.0, 0.0, -95.0)), 8.0, 12.0)[0]
    assert plan["height_error"] + np.linalg.norm(plan["end_velocity"]) > 10.0
    assert np.all(np.isfinite(plan["w"]))


def test_constraints_are_relaxed_in_their_order_the_lower_the_start_the_more(onboard):
    relaxed = []
    for height in (1200.0, 520.0, 480.0, 440.0, 250.0):
        body = PointMass(height, (9.0, 6.0, 58.0))
        guided = Guided(onboard[0], "convex", body)
        guided(body)
        memory, target = guided.memory["convex"], guided.target
        relaxed.append(int(body.out["relaxed"]))
        assert body.out["landing_error"] == memory["landing_error"]
        assert memory["landing_error"] < 5.0 or relaxed[-1] == guidance_command.TARGET
        lowest = target["least_height"] if relaxed[-1] >= guidance_command.ARRIVAL else target["height"]
        assert memory["landing"]["position"][2] == pytest.approx(height - lowest)
    assert relaxed == sorted(relaxed)
    assert relaxed[0] == 0 and relaxed[-1] == guidance_command.TARGET
    assert len(set(relaxed)) > 2  # not all at once
