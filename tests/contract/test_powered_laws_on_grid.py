"""One contract for what every powered law does on a grid of states."""

from math import cos, radians

import numpy as np
import pytest
from onboard_states import nav_state
from pyquaternion import Quaternion

from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS, powered_guidance
from edl6dof.fsw.guidance.powered.terminal import command_thrust


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
