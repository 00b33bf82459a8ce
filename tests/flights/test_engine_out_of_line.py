"""An engine out of line: its standing lateral force is fed forward, so the lander comes down upright and
without lateral speed; and so it does on the imbalance of its tank.
"""

import numpy as np
import pytest

import edl6dof


@pytest.fixture(
    scope="module",
    params=[
        *(pytest.param(turn, marks=pytest.mark.long) for turn in ((1.5, 0.0), (0.0, -1.5), (2.0, 2.0))),
        (-2.0, 2.0),
    ],
)
def misaligned(request):
    y, z = request.param
    engine = "vehicle.engines.main"
    return edl6dof.fly(
        "tianwen1", [f"truth={{{engine}.misalignment_y_deg: {y}, {engine}.misalignment_z_deg: {z}}}"]
    )


def test_lander_with_a_misaligned_engine_comes_down_without_lateral_speed(misaligned):
    assert misaligned.outcome == "landed within limits" and misaligned.isolated_faults == []
    assert misaligned.figures["touchdown_horizontal_m_s"] < 0.4
    assert misaligned.figures["touchdown_tilt_deg"] < 0.6


def test_estimated_force_is_that_of_the_misaligned_engine(misaligned):
    """In hover, where the air does next to nothing: T sin(angle) across the axis of the thrust."""
    engine = misaligned.loaded.truth.vehicle.engines[0]
    y, z = np.radians(engine.misalignment_y_deg), np.radians(engine.misalignment_z_deg)
    table, late = misaligned.telemetry, misaligned.during("hover_imaging")
    late &= np.cumsum(late) > 300
    thrust = table["truth.engine_thrust_n"][late].mean()
    lateral = thrust * np.array([-np.cos(y) * np.sin(z), np.sin(y)])  # x of B turned about y, then about z
    found = [table[f"estimate.force_{axis}_n"][late].mean() for axis in "yz"]
    assert found == pytest.approx(lateral, abs=12.0)


def test_thrusters_that_hold_against_the_imbalance_of_the_tank_do_not_tilt_the_lander(nominal):
    """Where force is not asked for beside torque, it leans by 0.28 deg against their lateral force."""
    assert nominal.figures["touchdown_tilt_deg"] < 0.2
    assert nominal.figures["touchdown_horizontal_m_s"] < 0.1
