"""The derivative is a function: whatever was evaluated before, the same time, state and inputs give the same
bits.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.config.dtype import duplicate
from edl6dof.kernels import kernel
from edl6dof.scenario import records
from edl6dof.sim.flight_state import RunningFlight
from edl6dof.vehicle.motion.body import derivatives
from edl6dof.vehicle.motion.runge_kutta import evaluate, step
from edl6dof.vehicle.parachutes.parachute import canopy_force
from edl6dof.vehicle.plant import CANOPY_POSITION, CANOPY_VELOCITY, OUTPUTS, WORKSPACE
from edl6dof.vehicle.surroundings import planet_rotation, surroundings

#: Coasting, in lift, while the parachute inflates, below it, under power, on the ground.
MOMENTS = (20.0, 150.0, 278.5, 300.0, 440.0, 524.0)


@pytest.fixture(scope="module")
def points():
    """Case, tables, plant, time and state of points on six stretches of flight, some of them millimetres
    apart, and of a point mass.
    """
    rng = np.random.default_rng(1)
    found = []
    for name, times in (("tianwen1", MOMENTS), ("zheng2015", (60.0,))):
        loaded = edl6dof.load(name, ["wind.gust.enabled=true"])
        case, tables, _ = records.build_records(loaded)
        running = RunningFlight(loaded)
        for t in times:
            running.advance(round(t * loaded.scenario.flight_software.rates.base_hz) - running.cycle)
            plant = running.state().plant
            for away in (0.0, 1e-3, 1.0, 1e4):
                y = plant["y"][0].copy()
                y[:3] += away * rng.normal(size=3)
                found.append((case[0], tables[0], plant, t + away, y))
    return found


@kernel
def derivatives_at(case, tables, plant, t, outputs, work):
    """Of the state in ``work.stage``, into ``work.k[0]``: arrays of a flight, for which it is compiled."""
    derivatives(case, tables, plant, t, planet_rotation(case.planet, t), work.stage, outputs, work.k[0])


def derivative(case, tables, plant, t, y, outputs):
    """Of a state, which it must leave alone like the plant."""
    work, before = np.zeros(1, WORKSPACE), plant.tobytes()
    work["stage"] = y
    derivatives_at(case, tables, plant[0], t, outputs[0], work[0])
    assert plant.tobytes() == before and work["stage"].tobytes() == y.tobytes()
    return work["k"][0, 0]


def evaluated(point, outputs):
    return derivative(*point, outputs).tobytes(), outputs.tobytes()


def test_any_order_any_number_of_times_same_bits(points):
    first = [evaluated(point, np.zeros(1, OUTPUTS)) for point in points]
    assert len({dy for dy, _ in first}) == len(points)
    rng, shared = np.random.default_rng(2), np.zeros(1, OUTPUTS)
    for k in (*rng.permutation(len(points)), *rng.permutation(len(points))):
        assert evaluated(points[k], shared)[0] == first[k][0]
        assert evaluated(points[k], shared)[0] == first[k][0]


def test_step_starts_from_the_state_and_from_nothing_in_the_workspace(points):
    for case, tables, plant, _, _ in points[::4]:
        ends = []
        for scribble in (0.0, np.nan):
            one, outputs, work = duplicate(plant), np.zeros(1, OUTPUTS), np.zeros(1, WORKSPACE)
            for name in WORKSPACE.names:
                work[name] = scribble
            evaluate(case, tables, one[0], outputs[0], work[0])
            step(case, tables, one[0], outputs[0], work[0], float(plant["t"][0]) + 0.01)
            ends.append((one.tobytes(), outputs.tobytes()))
        assert ends[0] == ends[1]


def test_the_canopy_flies_in_the_air_at_its_own_height(points):
    """Its force without the riser's, from the air there; that at the vehicle is 0.1 % denser or more."""
    case, tables, plant, t, y = next(point for point in points if point[3] == 300.0)
    outputs = np.zeros(1, OUTPUTS)
    derivative(case, tables, plant, t, y, outputs)
    out, place = outputs[0], y[CANOPY_POSITION : CANOPY_POSITION + 3]
    areoid, rotation = plant["inputs"]["areoid"][0], planet_rotation(case["planet"], t)
    _, gas, _, air = surroundings(case, tables, areoid, rotation, place)
    assert gas[0] < 0.999 * out["density"]

    chute, mass = case["vehicle"]["parachutes"][0], case["vehicle"]["parts"][2]["mass"]
    canopy = mass / out["canopy_weight"]
    accelerated = canopy * out["canopy_acceleration_I"]
    v_air = y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] - air
    w, x, i, j = y[6:10]
    turn = Rotation.from_quat([x, i, j, w])
    line = place - y[:3] - turn.apply(chute["confluence"] - out["centre"])
    line /= np.linalg.norm(line)
    mach = np.linalg.norm(v_air) / gas[3]
    force = canopy_force(chute, 1.0, gas[0], mach, t, tuple(v_air), tuple(-line))
    assert accelerated + out["riser_tension"] * line == pytest.approx(force, rel=1e-9, abs=1e-6)


def test_aerodynamic_moment_moves_with_the_centre_of_mass_by_arm_times_force(points):
    """M(c) = M(0) - c x F: closed capsule, and with the trim wing out."""
    for case, tables, plant, t, y in (next(p for p in points if p[3] == at) for at in (150.0, 278.5)):
        found = []
        for away in ((0.0, 0.0, 0.0), (0.1, 0.05, -0.03)):
            moved, outputs = duplicate(plant), np.zeros(1, OUTPUTS)
            moved["dry"]["centre"] += away
            derivative(case, tables, moved, t, y, outputs)
            found.append(outputs[0])
        before, after = found
        arm = after["centre"] - before["centre"]
        assert np.abs(arm).min() > 0.01 and np.abs(before["aero_force_B"]).min() > 1e-3
        assert np.array_equal(before["aero_force_B"], after["aero_force_B"])
        turned = after["aero_moment_B"] - before["aero_moment_B"]
        assert turned == pytest.approx(-np.cross(arm, before["aero_force_B"]), rel=1e-6, abs=1e-9)
