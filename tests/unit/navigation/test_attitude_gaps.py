"""Attitude over a gap of the gyros, its recovery afterwards, and the guards."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from inertial_units import DT, believed_unit
from pyquaternion import Quaternion

from edl6dof.config.dtype import in_si
from edl6dof.fsw.navigation.bridge import BRIDGE, bridge, bridged_roll
from edl6dof.fsw.navigation.guard import (
    ABOVE_HORIZON,
    BELOW_GROUND,
    GUARD,
    JUMP,
    GuardParams,
    guard_vertical,
    guarded_height,
)
from edl6dof.fsw.navigation.recovery import RECOVERY, RecoveryParams, recover
from edl6dof.fsw.navigation.solution import MOTION, SOLUTION
from edl6dof.interface.sensed import RADAR

PULL = np.array([-0.45, 0.6, 0.66])  # direction of the riser, I
SWAY = radians(25.0)


def body_at(t):
    """A capsule that wobbles about the riser and rolls evenly."""
    nose = Quaternion(matrix=np.column_stack([-PULL / np.linalg.norm(PULL), *across(PULL)]))
    wobble = Quaternion(axis=(0, 1, 0), radians=SWAY * sin(5.0 * t)) * Quaternion(
        axis=(0, 0, 1), radians=SWAY * cos(6.0 * t)
    )
    return nose * wobble * Quaternion(axis=(1, 0, 0), radians=0.5 * t)


def across(v):
    """Two unit vectors that make a right-handed triad with minus ``v``."""
    x = -v / np.linalg.norm(v)
    y = np.cross(x, (0.0, 0.0, 1.0))
    y /= np.linalg.norm(y)
    return y, np.cross(x, y)


def rate_at(t, step=1e-4):
    """Rate in B, rad/s."""
    turn = body_at(t - step).inverse * body_at(t + step)
    return turn.axis * turn.radians / (2.0 * step)


def test_bridge_follows_the_force_through_a_wobble():
    """One second: held, the rate of the beginning is tens of degrees off."""
    force = 50.0 * PULL / np.linalg.norm(PULL)
    motion, memory = np.zeros(1, MOTION), np.zeros(1, BRIDGE)
    motion["force_known"], motion["rate"] = 1, rate_at(1.0)
    q = held = body_at(1.0)
    last = None
    for k in range(52):
        t = 1.0 + (k - 0.5) * DT
        gain = DT * body_at(t).inverse.rotate(force)
        if k > 0:
            bridge(tuple(gain), tuple(last), DT, memory[0], motion[0])
            q = q * Quaternion(axis=motion["angle"][0], radians=np.linalg.norm(motion["angle"][0]))
            held = held * Quaternion(axis=rate_at(1.0), radians=DT * np.linalg.norm(rate_at(1.0)))
        last = gain
    true = body_at(1.0 + 51 * DT)
    assert memory["followed"][0] == 1 and memory["duration"][0] == pytest.approx(51 * DT)
    assert abs((held.inverse * true).radians) > radians(20.0)
    pulled = q.rotate(true.inverse.rotate(force)) @ force / (force @ force)
    assert np.arccos(pulled) < radians(1.5)
    nose = np.array([1.0, 0.0, 0.0])
    assert np.arccos(q.rotate(nose) @ true.rotate(nose)) < radians(6.0)  # the roll rate is not held exactly


def test_half_the_change_of_the_roll_rate_is_made_up_for():
    memory = np.zeros(1, BRIDGE)
    memory["roll_rate"], memory["duration"] = 0.1, 2.0
    assert bridged_roll(0.3, memory[0]) == pytest.approx(0.2)
    assert memory["duration"][0] == 0.0


def test_weak_force_has_the_last_rate_held():
    motion, memory = np.zeros(1, MOTION), np.zeros(1, BRIDGE)
    motion["force_known"], motion["rate"] = 1, (0.1, -0.2, 0.3)
    for _ in range(10):
        bridge((-1e-4, 0.0, 0.0), (-1e-4, 1e-5, 0.0), DT, memory[0], motion[0])
        assert np.allclose(motion["angle"][0], DT * np.array([0.1, -0.2, 0.3]))
    assert memory["followed"][0] == 0


class Descent:
    """A capsule that falls on its parachute in a steady wind, seen by a solution with a wrong attitude."""

    WIND = np.array([15.0, -20.0, 0.0])

    def __init__(self, **settings):
        self.params = in_si(RecoveryParams(**settings))
        self.memory, self.solution = np.zeros(1, RECOVERY), np.zeros(1, SOLUTION)
        self.motion = np.zeros(1, MOTION)
        self.motion["dt"], self.motion["rate_known"], self.motion["force_known"] = DT, 1, 1
        self.v = np.array([200.0, -150.0, 100.0])
        self.solution["r_I"], self.solution["v_I"] = (3.4e6, 0.0, 0.0), self.v
        air = self.v - self.WIND
        self.force = -30.0 * air / np.linalg.norm(air)
        self.q = Quaternion(0.4, 0.3, -0.7, 0.5).normalised
        self.off(Quaternion())

    def off(self, turn):
        """Let the attitude of the solution be turned by ``turn`` (I)."""
        self.solution["q_I2B"] = (turn * self.q).elements

    def cycles(self, seconds, ignited=0):
        self.motion["gain"] = DT * self.q.inverse.rotate(self.force)
        for _ in range(round(seconds / DT)):
            recover(self.params, 0.0, ignited, self.motion[0], self.memory[0], self.solution[0])

    def error(self):
        """Angle (rad) of the direction of the force."""
        read = Quaternion(self.solution["q_I2B"][0]).rotate(self.q.inverse.rotate(self.force))
        return np.arccos(np.clip(read @ self.force / (self.force @ self.force), -1.0, 1.0))

    def gap(self, seconds):
        self.motion["rate_known"] = 0
        self.cycles(seconds)
        self.motion["rate_known"] = 1


@pytest.mark.parametrize("degrees", [3.0, 20.0, 90.0, 179.0])
def test_attitude_is_turned_back_after_a_gap_in_spite_of_the_wind(degrees):
    descent = Descent()
    descent.cycles(20.0)
    axis = np.cross(descent.force, (0.0, 0.0, 1.0))
    descent.gap(1.0)
    descent.off(Quaternion(axis=axis, degrees=degrees))
    descent.cycles(20.0)
    assert descent.error() < radians(min(degrees, 6.0) + degrees / 10.0)


def test_sound_attitude_is_left_alone():
    descent = Descent()
    descent.off(Quaternion(axis=(0, 1, 0), degrees=30.0))
    before = descent.solution["q_I2B"].copy()
    descent.cycles(10.0)
    assert np.array_equal(descent.solution["q_I2B"], before)


@pytest.mark.parametrize("settings, ignited", [({"enabled": False}, 0), ({}, 1)])
def test_nothing_is_turned_when_switched_off_or_under_thrust(settings, ignited):
    descent = Descent(**settings)
    descent.cycles(10.0)
    descent.gap(1.0)
    descent.off(Quaternion(axis=(0, 1, 0), degrees=30.0))
    before = descent.solution["q_I2B"].copy()
    descent.cycles(10.0, ignited)
    assert np.array_equal(descent.solution["q_I2B"], before)
    assert descent.memory["variance"][0] == pytest.approx(radians(5.0) ** 2)


def told(heights, climb=-50.0, sigma=1.0, contact=0, **settings):
    """What is told of ``heights``, cycle by cycle, and the verdicts."""
    params, memory = in_si(GuardParams(**settings)), np.zeros(1, GUARD)
    found = []
    for height in heights:
        height = guarded_height(params, height, climb, sigma, contact, DT, memory[0])
        found.append((height, int(memory["verdict"][0])))
    return found


FALL = 500.0 - 50.0 * DT * np.arange(200)


def test_plausible_heights_are_told_as_they_are():
    assert told(FALL) == [(height, 0) for height in FALL]


def test_negative_height_is_withheld_for_as_long_as_it_lasts():
    heights = np.where(np.arange(200) < 20, FALL, -300.0)
    found = told(heights)
    assert [verdict for _, verdict in found[20:]] == [BELOW_GROUND | JUMP] * 180
    assert np.allclose([height for height, _ in found], FALL)


def test_contact_makes_a_height_below_the_ground_possible():
    assert told([-30.0], contact=1) == [(-30.0, 0)]


def test_jump_is_withheld_and_believed_when_it_lasts():
    heights = np.where(np.arange(200) < 20, FALL, FALL - 200.0)
    found = told(heights)
    after = round(3.0 / DT)
    assert np.allclose([height for height, _ in found[: 20 + after - 2]], FALL[: 20 + after - 2])
    assert np.allclose([height for height, _ in found[22 + after :]], FALL[22 + after :] - 200.0)


def test_correction_within_what_the_filter_claimed_is_no_jump():
    heights = np.where(np.arange(200) < 20, FALL, FALL - 200.0)
    assert told(heights, sigma=60.0) == [(height, 0) for height in heights]


def test_without_guards_everything_is_told_but_the_verdict_stays():
    assert told([100.0, -300.0], below_ground=False, jump=False) == [
        (100.0, 0),
        (-300.0, BELOW_GROUND | JUMP),
    ]


@pytest.mark.parametrize("tilt, wrong", [(0.0, False), (pi / 4.0, False), (radians(100.0), True), (pi, True)])
@pytest.mark.parametrize("enabled, beams", [(True, 2), (False, 2), (True, 1)])
def test_echoes_from_above_the_horizon_have_the_vertical_recovered(tilt, wrong, enabled, beams):
    """A single beam may have failed itself."""
    wrong = wrong and beams > 1
    known, radar = believed_unit(), np.zeros(1, RADAR)
    known["n_beams"], known["beam_axis"][0, :2] = 2, (1.0, 0.0, 0.0)
    radar["fresh"], radar["locked"][0, :beams] = 1, 1
    memory, recovery = np.zeros(1, GUARD), np.zeros(1, RECOVERY)
    down = Quaternion(axis=(0, 1, 0), radians=pi / 2 + tilt)  # x of B along -z of I, tilted
    params = in_si(GuardParams(vertical=enabled))
    guard_vertical(params, known[0], radar[0], tuple(down.elements), (0.0, 0.0, 1.0), memory[0], recovery[0])
    assert (memory["verdict"][0] == ABOVE_HORIZON) == wrong
    assert (recovery["variance"][0] > 0.0) == (wrong and enabled)
