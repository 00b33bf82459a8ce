"""One contract for what every entry law and bank-reversal logic does on a grid of states."""

from itertools import product
from math import pi

import numpy as np
import pytest
from given_functions import entry_guidance
from onboard_states import guided, nav_state
from pyquaternion import Quaternion

from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS, bank_side
from edl6dof.fsw.guidance.guidance_command import GUIDE


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
            out["range_to_go"], out["crossrange"], out["downrange_to_go"] = to_target(shared_onboard[0], nav)
            answers.append(
                [
                    bank_side(index, params, shared_onboard[0], nav, memory, out, wanted, sign)
                    for _ in range(3)
                ]
            )
        assert set(answers[0]) <= {1.0, -1.0}
        assert answers[0] == answers[1]


def test_grid_reaches_the_extremes(whole_grid):
    grid = whole_grid
    assert min(nav["speed"] for nav in grid) == 0.0
    assert 0.0 < sorted(nav["speed"] for nav in grid if nav["speed"] > 0.0)[0] < 2e-3
    assert any(abs(nav["flight_path_angle"]) > 1.57 for nav in grid)
    assert any(nav["drag"] > 30.0 for nav in grid) and any(nav["drag"] < -1.0 for nav in grid)
    assert len(grid) == 192
