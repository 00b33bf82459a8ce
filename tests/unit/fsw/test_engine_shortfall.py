"""What engines are believed to lack, against a thrust that is known."""

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.estimation.engine_thrust import ENGINE_SHORTFALL, EngineShortfallParams, engine_shortfall

DT = 0.04


def believed(commanded, left, noise=0.0, seed=1):
    """Belief after each control cycle of an engine that gives a share ``left`` of what is commanded (N)."""
    params, memory = (
        np.zeros(1, dtype_of(EngineShortfallParams))[0],
        np.zeros(1, ENGINE_SHORTFALL)[0],
    )
    fill(params, EngineShortfallParams())
    rng = np.random.default_rng(seed)
    return np.array(
        [
            engine_shortfall(params, thrust, left * thrust + noise * rng.standard_normal(), DT, memory)
            for thrust in commanded
        ]
    )


@pytest.mark.parametrize("seed", range(5))
def test_dispersed_sound_engine_is_believed_sound(seed):
    assert not believed(np.full(1000, 5000.0), 0.96, noise=300.0, seed=seed).any()


@pytest.mark.parametrize("left", [0.85, 0.8, 0.7, 0.6])
def test_loss_is_found_while_the_command_rests(left):
    found = believed(np.full(100, 5000.0), left, noise=100.0)
    assert found[-1] == pytest.approx(1.0 - left, abs=0.01)
    assert not found[: int(1.0 / DT)].any()  # the thrust that still builds up after ignition is not looked at


def test_nothing_is_concluded_while_the_command_moves():
    steps = 4000.0 * 1.06 ** (np.arange(400) // 20 % 2)  # by 6 %, every 0.8 s
    assert not believed(steps, 0.7).any()


def test_belief_is_bounded_and_ends_with_the_burn():
    found = believed(np.array([5000.0] * 100 + [0.0] * 10 + [5000.0] * 10), 0.1)
    assert found[99] == pytest.approx(0.5)
    assert not found[100:].any()
