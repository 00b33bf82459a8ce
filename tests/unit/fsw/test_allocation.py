"""Thruster allocation against scipy's bounded least squares."""

from itertools import product

import numpy as np
import pytest
from given_functions import allocate
from scipy.optimize import lsq_linear
from thruster_wrenches import ENTRY, LANDER, wrenches

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.least_squares import LeastSquaresParams
from edl6dof.fsw.allocation.registry import ALLOCATION, ALLOCATORS, DEMAND, AllocationParams, compose_demand
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.effectors import ATTITUDE, AXIAL, ENGINE_FULL, ENGINE_THROTTLE, FINE, THRUSTER_GROUPS

ALL = 0b1111
HEALTHY = np.zeros(1, FSW["health"])[0]
HEALTHY["thruster"] = 1


def params(**changes):
    record = np.zeros(1, dtype_of(AllocationParams))
    fill(record[0], AllocationParams(least_squares=LeastSquaresParams(**changes)))
    return record[0]


def exact():
    """Settings with which the iteration runs until it stands still."""
    return params(steps=400000, tolerance=1e-13, translating_tolerance=1e-13)


def random_layout(rng, template, count=14):
    thrusters = template.copy()
    for i in range(count):
        direction = rng.normal(size=3)
        thrusters[i]["direction"] = direction / np.linalg.norm(direction)
        thrusters[i]["position"] = rng.uniform(-1.5, 1.5, 3)
        thrusters[i]["thrust"] = rng.choice([25.0, 100.0, 250.0])
        thrusters[i]["group"] = rng.integers(3)
    return thrusters


def solve(p, thrusters, count, centre, demand, allowed=ALL, translating=False, rounds=1, memory=None):
    memory = np.zeros(1, ALLOCATION)[0] if memory is None else memory
    vehicle, asked = np.zeros(1, ONBOARD["vehicle"])[0], np.zeros(1, DEMAND)[0]
    vehicle["thrusters"], vehicle["n_thrusters"] = thrusters, count
    asked["wrench"], asked["groups"], asked["translating"] = demand, allowed, translating
    effectiveness = np.zeros(1, EFFECTIVENESS)[0]
    vehicle["configuration"][LANDER]["centre"] = centre
    update_effectiveness(vehicle, LANDER, HEALTHY["loss"], effectiveness)
    assert p["method"] == ALLOCATORS.names.index("least_squares")
    for _ in range(rounds):
        allocate(p, vehicle, HEALTHY, effectiveness, asked, memory)
    return memory


def test_a_known_loss_is_made_up_for_by_the_duty(shared_onboard):
    """A thruster that has lost 40 % gets 1 / 0.6 of the duty for the same torque, and saturates at 0.6 of it.
    The torque of each duty is that of the true thruster.
    """
    believed = shared_onboard[0]["vehicle"]
    jets, count, sound = believed["thrusters"], int(believed["n_thrusters"]), np.zeros(1, EFFECTIVENESS)[0]
    update_effectiveness(believed, LANDER, np.zeros(len(HEALTHY["loss"])), sound)
    fine = [i for i in range(count) if jets[i]["group"] == FINE]
    number, loss, lost = fine[0], np.zeros(len(HEALTHY["loss"])), sound.copy()
    loss[number] = 0.4
    update_effectiveness(believed, LANDER, loss, lost)
    left = np.where(np.arange(len(loss)) == number, 0.6, 1.0)[:, np.newaxis]
    assert lost["matrix"] == pytest.approx(left * sound["matrix"], rel=1e-14)
    alone, asked = HEALTHY.copy(), np.zeros(1, DEMAND)[0]
    alone["thruster"] = 0
    alone["thruster"][number] = 1
    asked["groups"], p = ALL, exact()
    p["least_squares"]["use_cost"] = 0.0
    for part, duty in ((0.3, 0.5), (0.9, 1.0)):
        asked["wrench"] = part * sound["matrix"][number]
        asked["wrench"][:3] = 0.0
        p["least_squares"]["stray_force_scale"] = 1e9
        memory = np.zeros(1, ALLOCATION)[0]
        allocate(p, believed, alone, lost, asked, memory)
        assert memory["duty"][number] == pytest.approx(duty, abs=1e-6)
        missing = asked["wrench"] - 0.6 * duty * sound["matrix"][number]
        assert memory["unallocated"][3:] == pytest.approx(missing[3:], abs=1e-6)
    # known again as sound, it is as before
    update_effectiveness(believed, LANDER, np.zeros(len(loss)), lost)
    assert lost.tobytes() == sound.tobytes()


def weights(p, translating):
    force = 1.0 / (
        p["least_squares"]["force_scale"] if translating else p["least_squares"]["stray_force_scale"]
    )
    return np.array([0.0, force, force] + 3 * [1.0 / p["torque_scale"]])


def cost(p, effect, thrust, demand, duty, translating=False):
    """What the docstring says is minimised: |W (B u - d)|^2 + c u."""
    return (
        np.sum((weights(p, translating) * (effect @ duty - demand)) ** 2)
        + p["least_squares"]["use_cost"] * thrust @ duty / 250.0
    )


def best_cost(p, effect, thrust, demand, translating=False):
    return cost(p, effect, thrust, demand, best_duty(p, effect, thrust, demand, translating), translating)


def best_duty(p, effect, thrust, demand, translating=False):
    """Least cost over 0 <= u <= 1 by scipy; the linear cost enters as rows s (u + M) with 2 M s^2 = c and M
    large.
    """
    big = 1e4
    w = weights(p, translating)
    s = np.sqrt(p["least_squares"]["use_cost"] * thrust / 250.0 / (2.0 * big))
    rows = np.vstack([w[:, None] * effect, np.diag(s)])
    return lsq_linear(rows, np.concatenate([w * demand, -big * s]), (0.0, 1.0), tol=1e-13, method="bvls").x


def random_demand(rng, size=300.0):
    demand = rng.uniform(-size, size, 6)
    demand[0] = 0.0
    return demand


@pytest.mark.parametrize("translating", [False, True])
def test_converged_allocation_is_the_bounded_least_squares_optimum_on_random_layouts(
    shared_onboard, translating
):
    rng = np.random.default_rng(3)
    p = exact()
    for _ in range(25):
        count = 14
        thrusters = random_layout(rng, shared_onboard[0]["vehicle"]["thrusters"], count)
        demand = random_demand(rng)
        memory = solve(p, thrusters, count, (0.1, 0.0, -0.1), demand, translating=translating, rounds=1)
        effect = wrenches(thrusters, count, (0.1, 0.0, -0.1))
        thrust = thrusters["thrust"][:count]
        best = best_cost(p, effect, thrust, demand, translating)
        assert (
            cost(p, effect, thrust, demand, memory["duty"][:count], translating) <= best * (1.0 + 1e-3) + 1e-7
        )


@pytest.mark.parametrize("translating", [False, True])
def test_one_control_cycle_from_cold_delivers_the_torque_of_the_optimum_with_the_flown_settings(
    shared_onboard, translating
):
    """A few steps find the torque; what is left to gain is propellant, less than a sixth of one 250 N
    thruster at 100 N m.
    """
    rng = np.random.default_rng(4)
    vehicle = shared_onboard[0]["vehicle"]
    p, count, centre = (
        shared_onboard[0]["allocation"],
        vehicle["n_thrusters"],
        vehicle["configuration"][LANDER]["centre"],
    )
    effect, thrust = wrenches(vehicle["thrusters"], count, centre), vehicle["thrusters"]["thrust"][:count]
    keep = vehicle["thrusters"]["group"][:count] != THRUSTER_GROUPS.index("axial")
    for _ in range(40):
        demand = random_demand(rng, 100.0)
        memory = solve(
            p, vehicle["thrusters"], count, centre, demand, allowed=0b1101, translating=translating
        )
        best = best_cost(p, effect[:, keep], thrust[keep], demand, translating)
        assert (
            best - 1e-7
            <= cost(p, effect, thrust, demand, memory["duty"][:count], translating)
            <= best + 0.045**2
        )
        assert np.all(np.abs(demand[3:] - effect[3:] @ memory["duty"][:count]) < 2.0)


def test_demand_beyond_all_authority_saturates_valves_at_the_bounds_and_never_past_them(shared_onboard):
    rng = np.random.default_rng(5)
    vehicle = shared_onboard[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][ENTRY]["centre"]
    memory = np.zeros(1, ALLOCATION)[0]
    at_bound = 0
    for _ in range(60):
        solve(
            shared_onboard[0]["allocation"],
            vehicle["thrusters"],
            count,
            centre,
            random_demand(rng, 5000.0),
            memory=memory,
        )
        assert np.all((memory["duty"] >= 0.0) & (memory["duty"] <= 1.0))
        at_bound += np.sum(memory["duty"] == 1.0)
    assert at_bound > 60


def test_unallocated_is_demand_minus_what_the_duties_produce_also_from_a_warm_start(shared_onboard):
    rng = np.random.default_rng(6)
    vehicle = shared_onboard[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    effect = wrenches(vehicle["thrusters"], count, centre)
    memory = np.zeros(1, ALLOCATION)[0]
    for step in range(60):
        demand = random_demand(rng, 10.0 ** rng.uniform(0.0, 3.5))
        allowed = [ALL, 0b1101, 0b1000][step % 3]
        solve(
            shared_onboard[0]["allocation"],
            vehicle["thrusters"],
            count,
            centre,
            demand,
            allowed,
            step % 2 == 0,
            1,
            memory,
        )
        assert np.allclose(
            memory["unallocated"], demand - effect @ memory["duty"][:count], rtol=0.0, atol=1e-9 * 5000.0
        )
        outside = [(allowed >> g) & 1 == 0 for g in vehicle["thrusters"]["group"][:count]]
        assert np.all(memory["duty"][:count][outside] == 0.0)


def test_small_torque_demand_fires_the_fine_thrusters_alone_and_a_large_one_does_not(shared_onboard):
    vehicle = shared_onboard[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    fine = vehicle["thrusters"]["group"][:count] == FINE
    effect = wrenches(vehicle["thrusters"], count, centre)
    for axis, sign in product(range(3), (1.0, -1.0)):
        authority = np.sum(np.maximum(sign * effect[3 + axis, fine], 0.0))
        assert authority > 5.0
        for share, alone in ((0.4, True), (3.0, False)):
            demand = np.zeros(6)
            demand[3 + axis] = sign * share * authority
            duty = solve(
                shared_onboard[0]["allocation"], vehicle["thrusters"], count, centre, demand, 0b1101
            )["duty"][:count]
            assert np.any(duty[fine] > 0.0)
            assert np.all(duty[~fine] == 0.0) == alone
            delivered = sign * effect[3 + axis] @ duty
            assert delivered > 0.6 * share * authority


@pytest.mark.parametrize("direction", [(0, 1), (0, -1), (1, 0), (-1, 0), (0.6, -0.8)])
def test_lateral_force_demand_of_the_lander_is_delivered_without_roll(shared_onboard, direction):
    """Hazard avoidance: two horizontal thrusters work together in one direction; S1 section 6.3."""
    vehicle = shared_onboard[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    demand = np.array([0.0, *np.multiply(direction, 300.0), 0.0, 0.0, 0.0])
    p = exact()
    duty = solve(p, vehicle["thrusters"], count, centre, demand, 0b1101, True, 30)["duty"][:count]
    achieved = wrenches(vehicle["thrusters"], count, centre) @ duty
    assert np.allclose(achieved[1:3], demand[1:3], atol=15.0)  # the cost of use takes a few newtons
    assert np.all(np.abs(achieved[3:]) < 15.0)
    assert np.sum(duty[vehicle["thrusters"]["group"][:count] == 0] > 0.05) >= 2


def test_torque_demand_alone_produces_little_stray_force_where_couples_exist(shared_onboard):
    vehicle = shared_onboard[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    roll = np.array([0.0, 0.0, 0.0, 300.0, 0.0, 0.0])
    duty = solve(exact(), vehicle["thrusters"], count, centre, roll, 0b0001, False, 30)["duty"][:count]
    achieved = wrenches(vehicle["thrusters"], count, centre) @ duty
    assert achieved[3] == pytest.approx(300.0, rel=0.1)
    assert np.all(np.abs(achieved[1:3]) < 0.2 * np.sum(duty) * 250.0)


@pytest.mark.parametrize(
    "failed", [0, 9, *(pytest.param(n, marks=pytest.mark.long) for n in range(16) if n not in (0, 9))]
)
def test_allocation_without_one_thruster_still_meets_the_optimum_of_what_is_left(shared_onboard, failed):
    vehicle = shared_onboard.copy()[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    vehicle["thrusters"][failed]["thrust"] = 0.0
    rng = np.random.default_rng(failed)
    p = exact()
    demand = random_demand(rng, 150.0)
    effect, thrust = wrenches(vehicle["thrusters"], count, centre), vehicle["thrusters"]["thrust"][:count]
    memory = solve(p, vehicle["thrusters"], count, centre, demand, rounds=30)
    keep = np.arange(count) != failed
    best = best_cost(p, effect[:, keep], thrust[keep], demand)
    assert memory["duty"][failed] == 0.0
    assert cost(p, effect, thrust, demand, memory["duty"][:count]) <= best * (1.0 + 1e-3) + 1e-6


def test_changing_demand_does_not_leave_opposing_thrusters_running(shared_onboard):
    """Propellant over a sequence of unrelated demands, against the optimum of each by scipy."""
    rng = np.random.default_rng(8)
    vehicle = shared_onboard[0]["vehicle"]
    p, count, centre = (
        shared_onboard[0]["allocation"],
        vehicle["n_thrusters"],
        vehicle["configuration"][LANDER]["centre"],
    )
    effect, thrust = wrenches(vehicle["thrusters"], count, centre), vehicle["thrusters"]["thrust"][:count]
    keep = vehicle["thrusters"]["group"][:count] != THRUSTER_GROUPS.index("axial")
    memory, used, least = np.zeros(1, ALLOCATION)[0], 0.0, 0.0
    for _ in range(80):
        demand = random_demand(rng, 100.0)
        solve(p, vehicle["thrusters"], count, centre, demand, 0b1101, memory=memory)
        used += thrust @ memory["duty"][:count]
        least += thrust[keep] @ best_duty(p, effect[:, keep], thrust[keep], demand)
    assert used < 1.5 * least


def test_thruster_declared_dead_in_flight_is_no_longer_commanded(shared_onboard):
    """A diagnosis that sets the believed thrust to zero must close the valve that was open the cycle
    before.
    """
    vehicle = shared_onboard.copy()[0]["vehicle"]
    count, centre = vehicle["n_thrusters"], vehicle["configuration"][LANDER]["centre"]
    demand = np.array([0.0, 0.0, 0.0, 400.0, 0.0, 0.0])
    memory = solve(exact(), vehicle["thrusters"], count, centre, demand)
    used = int(np.argmax(memory["duty"]))
    assert memory["duty"][used] > 0.1
    vehicle["thrusters"][used]["thrust"] = 0.0
    solve(exact(), vehicle["thrusters"], count, centre, demand, memory=memory)
    assert memory["duty"][used] == 0.0


def test_of_two_that_turn_alike_the_fine_thruster_gives_all_it_can_first(shared_onboard):
    """110 N asked of 100 N and 25 N at the same place: the coarse one gets what the fine one leaves."""
    thrusters = shared_onboard[0]["vehicle"]["thrusters"].copy()
    for one, group, thrust in zip(thrusters[:2], (ATTITUDE, FINE), (100.0, 25.0), strict=True):
        one["direction"], one["position"] = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
        one["group"], one["thrust"] = group, thrust
    effect = wrenches(thrusters, 2, np.zeros(3))
    duty = solve(params(use_cost=0.0), thrusters, 2, (0.0, 0.0, 0.0), 1.1 * effect[:, 0])["duty"]
    assert duty[:2] == pytest.approx([0.85, 1.0], abs=1e-9)


@pytest.mark.parametrize("mode, wanted", [(ENGINE_FULL, -5000.0), (ENGINE_THROTTLE, 0.0)])
def test_the_axial_thrusters_are_asked_for_all_they_give_while_the_engine_is_to_give_all(mode, wanted):
    """A demand of their whole force: they help as far as the torque allows."""
    vehicle, (fsw,), matrix = np.zeros(1, ONBOARD["vehicle"])[0], np.zeros(1, FSW), np.zeros((32, 6))
    vehicle["n_thrusters"], vehicle["thrusters"]["group"][:5] = 5, [AXIAL, AXIAL, ATTITUDE, FINE, AXIAL]
    matrix[:5, 0] = [-2000.0, -2000.0, -7.0, -3.0, -1000.0]
    fsw["vehicle"]["ignited"], fsw["guide"]["engine_mode"] = 1, mode
    phase, none = np.zeros(1, ONBOARD["mission"])[0]["phases"][0], (0.0, 0.0, 0.0)
    given = (phase, vehicle, matrix, fsw["vehicle"], HEALTHY["thruster"], fsw["nav"], fsw["guide"])
    compose_demand(*given, none, none, fsw["demand"])
    assert fsw["demand"]["wrench"].tolist() == [wanted, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert fsw["demand"]["boosting"] == (wanted != 0.0)
