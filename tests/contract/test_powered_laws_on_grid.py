"""One contract for what every powered law does on a grid of states."""

from math import cos, radians

import numpy as np
import pytest
from onboard_states import nav_state
from pyquaternion import Quaternion

from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS, powered_guidance
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET, choose_target
from edl6dof.fsw.guidance.powered.terminal_descent import command_thrust
from edl6dof.fsw.hazard.site_selection import LANDING_POINT
from edl6dof.fsw.vehicle_state import VEHICLE_STATE


def given(onboard):
    """Settings, believed vehicle, and its state when its engine burns: 900 kg."""
    state = np.zeros(1, VEHICLE_STATE)[0]
    state["ignited"], state["mass"], state["engine"] = 1, 900.0, onboard[0]["vehicle"]["engines"][0]
    return onboard[0]["guidance"]["powered"], onboard[0]["vehicle"], state


@pytest.mark.parametrize("index", range(len(POWERED_LAWS.members)), ids=POWERED_LAWS.names)
def test_powered_law_is_finite_and_repeatable_and_its_thrust_points_up_within_the_tilt_limit(
    shared_onboard, whole_grid, index
):
    settings, *vehicle = given(shared_onboard)
    slow = [nav for nav in whole_grid if nav["speed"] <= 200.0]
    for nav in slow[:: 4 if POWERED_LAWS.names[index] == "convex" else 1]:  # it plans for milliseconds
        answers = []
        for _ in range(2):
            memory, guide = np.zeros(1, POWERED_LAWS.memory)[0], np.zeros(1, GUIDE)[0]
            target = np.zeros(1, POWERED_TARGET)[0]
            choose_target(settings["target"], nav, np.zeros(1, LANDING_POINT)[0], target)
            for _ in range(3):
                *acceleration, limit = powered_guidance(index, settings, *vehicle, nav, target, memory, guide)
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
def test_powered_law_at_rest_at_its_target_asks_for_an_upright_thrust_between_weight_and_the_band(
    shared_onboard, index
):
    site = shared_onboard[0]["site"]
    settings, *vehicle = given(shared_onboard)
    height = float(settings["target"]["height"])
    nav = nav_state(
        shared_onboard,
        site["latitude"],
        site["longitude"],
        -4000.0,
        (0.0, 0.0, 0.0),
        Quaternion(),
        height=height,
    )
    target, memory = np.zeros(1, POWERED_TARGET)[0], np.zeros(1, POWERED_LAWS.memory)[0]
    target["set"], target["arrival"] = 1, nav["t"]  # over the target at the end of its time
    target["point_L"], target["height"] = nav["site_L"][:2], height
    north, east, up, _ = powered_guidance(
        index, settings, *vehicle, nav, target, memory, np.zeros(1, GUIDE)[0]
    )
    assert (north, east) == pytest.approx((0.0, 0.0), abs=0.02)
    strongest = vehicle[1]["engine"]["throttle_max"] / vehicle[1]["mass"]
    assert nav["gravity"] - 0.02 <= up <= strongest
