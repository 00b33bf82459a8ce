"""One contract for what every controller, guidance law and allocator does: finite, bounded and repeatable on
a grid of states.
"""

from itertools import product
from math import cos, pi, radians, sin

import numpy as np
import pytest
from pyquaternion import Quaternion

from edl6dof.fsw.allocation.demand import DEMAND, compose_demand
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.registry import ALLOCATORS, share_out
from edl6dof.fsw.allocation.update import ALLOCATION
from edl6dof.fsw.control.inputs import CONTROL_INPUTS
from edl6dof.fsw.control.registry import CONTROLLERS, attitude_control
from edl6dof.fsw.estimation.registry import DISTURBANCE, ESTIMATORS, MEASURED, estimate
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.entry.geometry import to_target
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY, entry_guidance
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS, bank_side
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS, powered_guidance
from edl6dof.fsw.guidance.powered.terminal import command_thrust
from edl6dof.fsw.health import HEALTH
from edl6dof.fsw.navigation import NAV, navigate
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.interface.sensed import SENSED
from edl6dof.records import numbers

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
ENTRY, LANDER = 0, 0b111

X, Y, Z = np.eye(3)


def nav_state(
    onboard,
    lat,
    lon,
    altitude,
    velocity_N,
    attitude,
    rate=(0.0, 0.0, 0.0),
    force=(0.0, 0.0, 0.0),
    t=50.0,
    height=None,
):
    """Navigation of a state given by north-east-down velocity and an attitude relative to that triad."""
    planet = onboard[0]["planet"]
    spin = Quaternion(axis=Z, radians=planet["rotation_rate"] * t)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    ned = np.column_stack([np.cross(up, east), east, -up])
    e2 = planet["flattening"] * (2.0 - planet["flattening"])
    prime = planet["equatorial_radius"] / np.sqrt(1.0 - e2 * sin(lat) ** 2)
    r = spin.rotate((prime + altitude) * up - np.array([0.0, 0.0, prime * e2 * sin(lat)]))
    sensed, nav = np.zeros(1, SENSED)[0], np.zeros(1, NAV)[0]
    sensed["t"], sensed["r_I"] = t, r
    sensed["v_I"] = spin.rotate(ned @ np.asarray(velocity_N)) + np.cross((0, 0, planet["rotation_rate"]), r)
    sensed["q_I2B"] = (spin * Quaternion(matrix=ned) * attitude).elements
    sensed["w_B"], sensed["specific_force_B"] = rate, force
    sensed["height_above_ground"] = altitude - onboard[0]["site"]["altitude"] if height is None else height
    navigate(planet, onboard[0]["atmosphere"], onboard[0]["site"]["frame"], sensed, nav)
    return nav


def any_attitude(rng):
    return Quaternion(axis=rng.normal(size=3), radians=rng.uniform(0.0, 2.0 * pi))


def states(onboard):
    """Fast and slow, steep and level, over the target and far from it, any attitude, spinning or not."""
    site = onboard[0]["site"]
    rng = np.random.default_rng(11)
    for away, altitude, (speed, fpa), force in product(
        (0.0, 0.05, 0.25),
        (-3900.0, 12e3, 60e3, 124e3),
        (
            (0.0, 0.0),
            (1e-3, -0.3),
            (1.0, -pi / 2),
            (80.0, -pi / 2),
            (650.0, -0.4),
            (4800.0, -0.2),
            (900.0, 0.5),
            (4000.0, -pi / 2),
        ),
        (0.0, 60.0),
    ):
        azimuth = rng.uniform(-pi, pi)
        velocity = speed * np.array([cos(fpa) * cos(azimuth), cos(fpa) * sin(azimuth), -sin(fpa)])
        yield nav_state(
            onboard,
            site["aim_latitude"] + away,
            site["aim_longitude"],
            altitude,
            velocity,
            any_attitude(rng) if force else Quaternion(axis=Y, radians=-pi / 2),
            rng.normal(size=3) * (1.0 if force else 0.0),
            (-force, 0.0, 0.1 * force),
            t=rng.uniform(0.0, 600.0),
        )


def guided(bank=0.9, direction=(0.0, 0.0, -1.0), translating=0):
    guide = np.zeros(1, GUIDE)[0]
    guide["bank"], guide["alpha"], guide["thrust_direction_N"] = bank, radians(-10.0), direction
    guide["translating"], guide["force_N"] = translating, (200.0, -300.0)
    return guide


@pytest.fixture(scope="module")
def whole_grid(shared_onboard):
    return list(states(shared_onboard))


@pytest.fixture(scope="module")
def grid(whole_grid):
    return [nav for nav in whole_grid if nav["speed"] > 0.0]


def demand_of(index, onboard, nav, goal, configuration, cycles=3):
    """Torque and attitude error of a controller, and the force that guidance demands with it."""
    inputs, memory = np.zeros(1, CONTROL_INPUTS)[0], np.zeros(1, CONTROLLERS.memory)[0]
    inputs["inertia"] = onboard[0]["vehicle"]["configuration"][configuration]["inertia"]
    inputs["phase_time"], inputs["bandwidth"], inputs["disturbance_pole"] = 100.0, 1.0, 8.0
    for _ in range(cycles):
        torque, error = attitude_control(index, onboard[0]["control"], nav, goal, inputs, 0.04, memory)
    phase, demand = onboard[0]["mission"]["phases"][0], np.zeros(1, DEMAND)[0]
    compose_demand(phase, onboard[0]["vehicle"], 0, np.ones(32, "i8"), nav, goal, torque, error, demand)
    return np.array(demand["wrench"]), np.array(error)


@pytest.mark.parametrize("index", range(len(CONTROLLERS.members)), ids=CONTROLLERS.names)
def test_controller_demands_are_finite_bounded_and_repeatable_on_the_whole_grid(shared_onboard, grid, index):
    """Bound: 20 rad/s2 on the believed inertia, far above what any thruster set can do, far below nonsense.

    Below 50 m/s a large force turns the path itself at tens of rad/s, and the laws that follow the path ask
    for five times that.
    """
    for nav, configuration in product(grid, (ENTRY, LANDER)):
        for guide in (guided(), guided(-2.5, (0.3, -0.2, -0.93), 1)):
            demand, error = demand_of(index, shared_onboard, nav, guide, configuration)
            inertia = shared_onboard[0]["vehicle"]["configuration"][configuration]["inertia"]
            assert np.all(np.isfinite(demand)) and np.all(np.isfinite(error))
            assert np.all(np.abs(demand[3:]) < (20.0 if nav["speed"] > 50.0 else 100.0) * inertia)
            assert np.all(np.abs(demand[:3]) <= 500.0)
            assert np.all(np.abs(error) <= pi + radians(10.0) + 1e-9)  # the error of alpha is not wrapped
            again, _ = demand_of(index, shared_onboard, nav, guide, configuration)
            assert np.array_equal(demand, again)


@pytest.mark.parametrize("index", range(len(CONTROLLERS.members)), ids=CONTROLLERS.names)
def test_controller_on_its_goal_and_at_rest_demands_next_to_nothing(shared_onboard, index):
    """Entry members at the commanded attitude turning with the path; lander members upright with y south."""
    site = shared_onboard[0]["site"]
    guide = guided(bank=0.6)
    path = (
        Quaternion(axis=Z, radians=3.0) * Quaternion(axis=Y, radians=-0.2) * Quaternion(axis=X, radians=0.6)
    )
    velocity = 3000.0 * (Quaternion(axis=Z, radians=3.0) * Quaternion(axis=Y, radians=-0.2)).rotate(X)
    body = path * Quaternion(axis=Y, radians=radians(-10.0))
    name = CONTROLLERS.names[index]
    if name in ("phase_plane", "bank_to_steer", "off"):
        nav = nav_state(shared_onboard, site["latitude"], site["longitude"], 40e3, velocity, body)
        # free fall: the path turns by gravity alone
        down = body.inverse.rotate(Z) * nav["gravity"]
        v = body.inverse.rotate(velocity)
        nav["w_B"] = np.cross(v, down) / (v @ v)
        demand, error = demand_of(index, shared_onboard, nav, guide, ENTRY)
    else:
        upright = Quaternion(matrix=np.column_stack([Z, -X, np.cross(Z, -X)]))
        nav = nav_state(
            shared_onboard, site["latitude"], site["longitude"], -4000.0, (0.0, 0.0, 1.0), upright
        )
        demand, error = demand_of(index, shared_onboard, nav, guide, LANDER)
    assert np.abs(demand) == pytest.approx(np.zeros(6), abs=0.5)
    assert np.abs(error) == pytest.approx(np.zeros(3), abs=1e-6)


@pytest.mark.parametrize("name", ["phase_plane", "thrust_vector"])
def test_controller_pushes_towards_its_goal_on_each_axis(shared_onboard, name):
    """A rotation away from the goal about one body axis is answered by a torque against it."""
    site = shared_onboard[0]["site"]
    index = CONTROLLERS.names.index(name)
    for axis, sign in product(range(3), (1.0, -1.0)):
        off = Quaternion(axis=np.eye(3)[axis], degrees=sign * 8.0)
        if name == "phase_plane":
            velocity = 4000.0 * Quaternion(axis=Y, radians=-0.2).rotate(X)
            goal = (
                Quaternion(axis=Y, radians=-0.2)
                * Quaternion(axis=X, radians=0.6)
                * Quaternion(axis=Y, radians=radians(-10.0))
            )
            nav = nav_state(shared_onboard, site["latitude"], site["longitude"], 110e3, velocity, goal * off)
            demand, error = demand_of(index, shared_onboard, nav, guided(0.6), ENTRY, 1)
        else:
            goal = Quaternion(matrix=np.column_stack([Z, -X, np.cross(Z, -X)]))
            nav = nav_state(
                shared_onboard, site["latitude"], site["longitude"], -3000.0, (0.0, 0.0, 20.0), goal * off
            )
            demand, error = demand_of(index, shared_onboard, nav, guided(), LANDER, 1)
        assert sign * demand[3 + axis] < -10.0
        assert error[axis] == pytest.approx(-sign * radians(8.0), abs=1e-3)
        others = [i for i in range(3) if i != axis]
        assert np.all(np.abs(demand[3:][others]) < 0.3 * abs(demand[3 + axis]))


@pytest.mark.parametrize("index", range(len(ENTRY_LAWS.members)), ids=ENTRY_LAWS.names)
def test_entry_law_bank_is_finite_within_half_a_turn_and_repeatable_on_the_whole_grid(
    shared_onboard, whole_grid, index
):
    for nav in whole_grid:
        answers = []
        for _ in range(2):
            memory, guide = np.zeros(1, ENTRY_MEMORY)[0], np.zeros(1, GUIDE)[0]
            for _ in range(3):
                entry_guidance(index, shared_onboard[0], nav, memory, guide)
            answers.append((float(guide["bank"]), float(guide["range_to_go"]), float(guide["crossrange"])))
        assert np.all(np.isfinite(answers[0]))
        assert -pi <= answers[0][0] <= pi
        assert answers[0][1] >= 0.0
        assert abs(answers[0][2]) <= answers[0][1] + 1e-6
        assert answers[0] == answers[1]


@pytest.mark.parametrize("index", range(len(ENTRY_LAWS.members)), ids=ENTRY_LAWS.names)
def test_entry_law_levels_the_wings_below_the_alignment_speed(shared_onboard, index):
    site = shared_onboard[0]["site"]
    speed = 0.9 * shared_onboard[0]["guidance"]["entry"]["align_speed"]
    nav = nav_state(
        shared_onboard,
        site["latitude"] + 0.01,
        site["longitude"],
        12e3,
        (-speed, 0.0, 0.0),
        Quaternion(),
        force=(-9.0, 0, 0),
    )
    guide = guided()
    entry_guidance(index, shared_onboard[0], nav, np.zeros(1, ENTRY_MEMORY)[0], guide)
    assert guide["bank"] == 0.0


@pytest.mark.parametrize("index", range(len(REVERSALS.members)), ids=REVERSALS.names)
def test_reversal_logic_names_a_side_and_the_same_one_again_on_the_whole_grid(
    shared_onboard, whole_grid, index
):
    params = shared_onboard[0]["guidance"]["entry"]["reversal"]
    for nav, sign, wanted in product(whole_grid[::3], (1.0, -1.0), (0.9, -0.4)):
        answers = []
        for _ in range(2):
            memory, out = np.zeros(1, REVERSALS.memory)[0], np.zeros(1, GUIDE)[0]
            out["drag_ratio"], out["lift_ratio"] = 1.0, 1.0
            out["range_to_go"], out["crossrange"] = to_target(shared_onboard[0], nav)
            answers.append(
                [
                    bank_side(index, params, shared_onboard[0], nav, memory, out, wanted, sign)
                    for _ in range(3)
                ]
            )
        assert set(answers[0]) <= {1.0, -1.0}
        assert answers[0] == answers[1]


@pytest.mark.parametrize("index", range(len(POWERED_LAWS.members)), ids=POWERED_LAWS.names)
def test_powered_law_is_finite_and_repeatable_and_its_thrust_points_up_within_the_tilt_limit(
    shared_onboard, whole_grid, index
):
    given = shared_onboard[0]["guidance"]["powered"], shared_onboard[0]["vehicle"]
    for nav in whole_grid:
        if nav["speed"] > 200.0:
            continue
        answers = []
        for _ in range(2):
            memory, guide = np.zeros(1, POWERED_LAWS.memory)[0], np.zeros(1, GUIDE)[0]
            for _ in range(3):
                *acceleration, limit = powered_guidance(index, *given, nav, memory, guide)
            command_thrust(900.0, tuple(acceleration), limit, guide)
            answers.append(
                (*acceleration, limit, *map(float, guide["thrust_direction_N"]), float(guide["thrust"]))
            )
        assert np.all(np.isfinite(answers[0]))
        assert 0.0 < limit <= radians(60.0)
        assert answers[0][2] > 0.0  # never asks for a push downwards
        assert -answers[0][6] >= cos(limit) - 1e-9
        assert answers[0] == answers[1]


@pytest.mark.parametrize("index", range(len(POWERED_LAWS.members)), ids=POWERED_LAWS.names)
def test_powered_law_at_rest_over_its_final_height_asks_for_little_more_than_weight(shared_onboard, index):
    site = shared_onboard[0]["site"]
    member = POWERED_LAWS.members[index]
    height = float(shared_onboard[0]["guidance"]["powered"][member.name]["final_height"])
    nav = nav_state(
        shared_onboard,
        site["latitude"],
        site["longitude"],
        -4000.0,
        (0.0, 0.0, 0.0),
        Quaternion(),
        height=height,
    )
    memory = np.zeros(1, POWERED_LAWS.memory)[0]
    if member.name == "polynomial":  # target reached: over the target at the end of its time
        memory["polynomial"]["started"], memory["polynomial"]["end"] = 1, nav["t"]
        memory["polynomial"]["target_L"] = nav["site_L"][:2]
    given = shared_onboard[0]["guidance"]["powered"], shared_onboard[0]["vehicle"]
    north, east, up, _ = powered_guidance(index, *given, nav, memory, np.zeros(1, GUIDE)[0])
    assert (north, east, up) == pytest.approx((0.0, 0.0, float(nav["gravity"])), abs=0.02)


@pytest.mark.parametrize("index", range(len(CONTROLLERS.names)), ids=CONTROLLERS.names)
def test_controller_of_a_vehicle_exactly_at_rest_is_finite(shared_onboard, whole_grid, index):
    resting = [nav for nav in whole_grid if nav["speed"] == 0.0]
    assert resting
    for nav in resting:
        demand, error = demand_of(index, shared_onboard, nav, guided(), LANDER)
        assert np.all(np.isfinite(demand)) and np.all(np.isfinite(error))


@pytest.mark.parametrize("index", range(len(ALLOCATORS.members)), ids=ALLOCATORS.names)
@pytest.mark.parametrize("sound", [0, 1], ids=["all dead", "all sound"])
def test_duties_are_bounded_and_repeatable_whatever_is_demanded(shared_onboard, index, sound):
    """From nothing to a million newton, along every axis and between them, with all thrusters and with
    none.
    """
    vehicle, params = shared_onboard[0]["vehicle"], shared_onboard[0]["allocation"]
    count, healthy = int(vehicle["n_thrusters"]), np.full(32, sound, "i8")
    rng = np.random.default_rng(5)
    demands = [
        size * direction
        for size in (0.0, 1e-9, 1.0, 300.0, 1e6)
        for direction in (*np.eye(6), *-np.eye(6), rng.normal(size=6))
    ]
    demand, effectiveness = np.zeros(1, DEMAND)[0], np.zeros(1, EFFECTIVENESS)[0]
    demand["groups"] = 0b1111
    for wrench, configuration, translating in product(demands, (ENTRY, LANDER), (0, 1)):
        demand["wrench"], demand["translating"], answers = wrench, translating, []
        for _ in range(2):
            found = np.zeros(1, ALLOCATION)[0]
            update_effectiveness(vehicle, configuration, effectiveness)
            given = params, params, vehicle, healthy, effectiveness, demand
            share_out(index, *given, found["method"], found["duty"], found["unallocated"])
            answers.append(found)
        duty = found["duty"][:count]
        assert np.all((duty >= 0.0) & (duty <= sound))
        assert found["unallocated"] == pytest.approx(
            wrench - duty @ effectiveness["matrix"][:count], rel=1e-9, abs=1e-8
        )
        assert answers[0].tobytes() == answers[1].tobytes()


@pytest.mark.parametrize("index", range(len(ESTIMATORS.members)), ids=ESTIMATORS.names)
def test_estimate_is_finite_bounded_repeatable_and_comes_to_rest_on_a_constant_disturbance(
    shared_onboard, index
):
    """Unexplained forces and torques from nothing to a million newton: after a minute of the same, the force
    is that, and the torque is that or its own bound.
    """
    params, rng, dt = shared_onboard[0]["estimation"], np.random.default_rng(6), 0.04
    limit = float(params[ESTIMATORS.names[index]]["torque_limit"])
    for size in (0.0, 1e-9, 1.0, 300.0, 1e6):
        measured = np.zeros(1, MEASURED)[0]
        measured["unexplained"] = size * rng.normal(size=6)
        answers = []
        for _ in range(2):
            memory, out = np.zeros(1, ESTIMATORS.memory)[0], np.zeros(1, DISTURBANCE)[0]
            for _ in range(round(60.0 / dt)):
                estimate(index, params, measured, dt, memory, out)
                assert np.all(np.isfinite(out["force"])) and np.all(np.abs(out["torque"]) <= limit)
            answers.append(out)
        assert out["force"] == pytest.approx(measured["unexplained"][:3], rel=1e-9)
        assert out["torque"] == pytest.approx(np.clip(measured["unexplained"][3:], -limit, limit), rel=1e-9)
        assert out["pole"] > 0.0
        assert answers[0].tobytes() == answers[1].tobytes()


def filled(dtype, seed=8):
    """A record of which every number is something: flags and indices one, the rest between a half and one."""
    record = np.zeros(1, dtype)
    rng = np.random.default_rng(seed)
    for numbers_ in numbers(record):
        numbers_.values[...] = 1 if numbers_.is_whole else rng.uniform(0.5, 1.0, numbers_.values.shape)
    return record[0]


def written(records, call):
    """Names of the records whose bytes a call changes."""
    before = {name: record.tobytes() for name, record in records.items()}
    call(*records.values())
    return {name for name, record in records.items() if record.tobytes() != before[name]}


CALLS = {
    **{
        f"{CONTROLLERS.title}: {name}": (
            {"params": ONBOARD["control"], "nav": NAV, "goal": GUIDE, "inputs": CONTROL_INPUTS}
            | {"memory": CONTROLLERS.memory},
            lambda p, nav, goal, inputs, memory, i=i: attitude_control(i, p, nav, goal, inputs, 0.04, memory),
            {"memory"},
        )
        for i, name in enumerate(CONTROLLERS.names)
    },
    **{
        f"{ALLOCATORS.title}: {name}": (
            {"params": ONBOARD["allocation"], "vehicle": ONBOARD["vehicle"], "health": HEALTH}
            | {"effectiveness": EFFECTIVENESS, "demand": DEMAND, "out": ALLOCATION},
            lambda p, vehicle, health, effectiveness, demand, out, i=i: share_out(
                *(i, p, p, vehicle, health["thruster"], effectiveness, demand),
                *(out["method"], out["duty"], out["unallocated"]),
            ),
            {"out"},
        )
        for i, name in enumerate(ALLOCATORS.names)
    },
    **{
        f"{ESTIMATORS.title}: {name}": (
            {"params": ONBOARD["estimation"], "measured": MEASURED, "memory": ESTIMATORS.memory}
            | {"out": DISTURBANCE},
            lambda p, measured, memory, out, i=i: estimate(i, p, measured, 0.04, memory, out),
            {"memory", "out"},
        )
        for i, name in enumerate(ESTIMATORS.names)
    },
    **{
        f"{POWERED_LAWS.title}: {name}": (
            {"params": ONBOARD["guidance"]["powered"], "vehicle": ONBOARD["vehicle"], "nav": NAV}
            | {"memory": POWERED_LAWS.memory, "out": GUIDE},
            lambda p, vehicle, nav, memory, out, i=i: powered_guidance(i, p, vehicle, nav, memory, out),
            {"memory", "out"},
        )
        for i, name in enumerate(POWERED_LAWS.names)
    },
}


@pytest.mark.parametrize("records, call, own", CALLS.values(), ids=CALLS)
def test_member_writes_its_memory_and_its_outputs_and_nothing_else(records, call, own):
    assert written({name: filled(dtype) for name, dtype in records.items()}, call) <= own


@pytest.mark.parametrize("index", range(len(ENTRY_LAWS.members)), ids=ENTRY_LAWS.names)
def test_entry_law_does_not_write_what_the_flight_computer_believes(shared_onboard, whole_grid, index):
    records = {"onboard": shared_onboard[0], "nav": whole_grid[100]}
    memory, out = np.zeros(1, ENTRY_MEMORY)[0], np.zeros(1, GUIDE)[0]
    assert written(records, lambda onboard, nav: entry_guidance(index, onboard, nav, memory, out)) == set()


def test_planted_write_into_an_input_is_found():
    records = {"nav": filled(NAV), "memory": filled(POWERED_LAWS.memory)}
    assert written(records, lambda nav, memory: nav["v_N"].fill(0.0)) == {"nav"}


def test_grid_reaches_the_extremes(whole_grid):
    grid = whole_grid
    assert min(nav["speed"] for nav in grid) == 0.0
    assert 0.0 < sorted(nav["speed"] for nav in grid if nav["speed"] > 0.0)[0] < 2e-3
    assert any(abs(nav["flight_path_angle"]) > 1.57 for nav in grid)
    assert any(nav["drag"] > 30.0 for nav in grid) and any(nav["drag"] < -1.0 for nav in grid)
    assert len(grid) == 192
