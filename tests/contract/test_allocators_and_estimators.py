"""One contract for what every allocator and every disturbance estimator does, whatever it is given."""

from itertools import product

import numpy as np
import pytest
from onboard_states import ENTRY, LANDER

from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.registry import ALLOCATION, ALLOCATORS, DEMAND, share_out
from edl6dof.fsw.estimation.registry import DISTURBANCE, ESTIMATORS, MEASURED, estimate
from edl6dof.interface.capacities import MAX_THRUSTERS


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
            update_effectiveness(vehicle, configuration, np.zeros(MAX_THRUSTERS), effectiveness)
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
