"""The stage all entry laws share: limits, side, heading alignment, levelling, rate of the commanded bank
angle.
"""

from math import atan2, cos, pi, radians, sin

import numpy as np
import pytest
from given_functions import steer_bank

from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS, STEERING
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

FAST = 1000.0  # bank rate, rad/s, that hides the rate limit


@pytest.fixture
def settings(onboard):
    p = onboard[0]["guidance"]["entry"]
    p["bank_min"], p["bank_max"], p["bank_rate"] = radians(15.0), radians(105.0), FAST
    p["align_speed"], p["heading"]["speed"] = 600.0, 0.0
    p["reversal"]["logic"] = REVERSALS.names.index("crossrange_corridor")
    return p


class Steering:
    """Steering with its memory; one call a second."""

    def __init__(self, onboard):
        self.onboard, self.memory = onboard[0], np.zeros(1, STEERING)[0]
        self.out, self.nav = np.zeros(1, GUIDE)[0], np.zeros(1, NAV)[0]
        self.out["least_bank"] = self.onboard["guidance"]["entry"]["bank_min"]

    def __call__(self, wanted, crossrange, speed, range_to_go=500e3, dt=1.0):
        self.nav["t"] += dt
        self.nav["speed"] = speed
        self.out["range_to_go"], self.out["crossrange"] = range_to_go, crossrange
        steer_bank(self.onboard, self.nav, self.memory, self.out, wanted)
        return float(self.out["bank"])


def corridor(settings, c0, c1, c2):
    own = settings["reversal"]["crossrange_corridor"]
    own["c0"], own["c1"], own["c2"] = c0, c1, c2


def test_first_bank_turns_towards_the_target(onboard, settings):
    for crossrange, sign in ((5000.0, -1.0), (-5000.0, 1.0)):
        assert Steering(onboard)(1.0, crossrange, 4000.0) == sign * 1.0


def test_first_bank_stays_on_the_side_of_the_preset_one(onboard, settings):
    """What little crossrange the preset bank has made until then is no reason to reverse at once."""
    for preset in (0.9, -0.9):
        steer = Steering(onboard)
        steer.out["bank"] = preset
        assert np.sign(steer(1.0, np.sign(preset) * 200.0, 4000.0)) == np.sign(preset)
        assert steer.memory["count"] == 0


def test_bank_reverses_only_past_the_corridor_on_the_side_it_turns_to(onboard, settings):
    corridor(settings, 1000.0, 1.0, 5e-4)
    edge = 1000.0 * (1.0 + 3.0 + 0.5 * 9.0)  # at 3 km/s
    steer = Steering(onboard)
    assert steer(1.0, -0.1, 3000.0) == 1.0
    assert steer(1.0, 0.99 * edge, 3000.0) == 1.0
    assert steer(1.0, -5.0 * edge, 3000.0) == 1.0  # far left of the target and turning right: go on
    assert steer(1.0, 1.01 * edge, 3000.0) == -1.0
    assert steer(1.0, 1.01 * edge, 3000.0) == -1.0  # no chatter
    assert steer.memory["count"] == 1
    assert steer(1.0, -1.01 * edge, 3000.0) == 1.0
    assert steer.memory["count"] == 2


def test_corridor_narrows_with_speed_and_brings_a_turning_vehicle_to_the_target(onboard, settings):
    """Point mass turning at constant lateral acceleration, its side from the logic: the miss ends inside the
    final corridor.
    """
    corridor(settings, 1000.0, 1.0, 4e-4)
    for start in (-12e3, -2e3, 0.0, 9e3):
        steer = Steering(onboard)
        x, y, heading, speed, dt = 0.0, start, 0.0, 4500.0, 0.5
        goal = 600e3
        while goal - x > 5e3:
            # of the track at the target, right positive
            crossrange = (goal - x) * sin(heading) + y * cos(heading)
            sign = np.sign(steer(1.0, crossrange, max(speed, 601.0)))
            heading += sign * 5.0 / speed * dt
            x, y = x + speed * cos(heading) * dt, y + speed * sin(heading) * dt
            speed = max(speed - 15.0 * dt, 500.0)
        assert abs(y) < 4000.0  # half width at 500 m/s is 1.6 km, plus the turn itself
        assert 1 <= steer.memory["count"] <= 12


@pytest.mark.parametrize(
    "wanted_deg, commanded_deg", [(0.0, 15.0), (14.0, 15.0), (60.0, 60.0), (106.0, 105.0), (180.0, 105.0)]
)
def test_magnitude_stays_within_the_limits_of_all_laws(onboard, settings, wanted_deg, commanded_deg):
    assert Steering(onboard)(radians(wanted_deg), -1.0, 3000.0) == pytest.approx(radians(commanded_deg))


def test_own_sign_follows_the_law_and_ignores_crossrange(onboard, settings):
    settings["reversal"]["logic"] = REVERSALS.names.index("own_sign")
    steer = Steering(onboard)
    assert [steer(w, 9e5, 3000.0) for w in (1.0, -1.0, -0.5, 0.5)] == [1.0, -1.0, -0.5, 0.5]


def test_command_turns_at_the_rate_limit_through_lift_up(onboard, settings):
    """From 100 deg right to 100 deg left in 10 s at 20 deg/s, by way of zero, never past the larger of both
    ends.
    """
    settings["bank_rate"] = radians(20.0)
    corridor(settings, 1000.0, 0.0, 0.0)
    steer = Steering(onboard)
    assert steer(radians(100.0), -1.0, 3000.0) == pytest.approx(radians(100.0))  # nothing to turn from yet
    path = [steer(radians(100.0), 2000.0, 3000.0, dt=0.2) for _ in range(60)]
    assert np.diff([radians(100.0), *path])[:50] == pytest.approx(np.full(50, radians(-4.0)))
    assert path[24] == pytest.approx(0.0, abs=1e-9)
    assert path[49:] == pytest.approx(np.full(11, radians(-100.0)))


def test_heading_alignment_banks_against_the_heading_error_within_its_limit(onboard, settings):
    settings["heading"]["speed"], settings["heading"]["gain"], settings["heading"]["limit"] = 1100.0, 2.0, 0.5
    steer = Steering(onboard)
    assert abs(steer(1.2, 300.0, 1101.0)) == pytest.approx(1.2)  # still the law's
    assert steer(1.2, 3000.0, 1099.0, 30e3) == pytest.approx(-2.0 * atan2(3.0, 30.0))
    assert steer(1.2, -3000.0, 1099.0, 30e3) == pytest.approx(2.0 * atan2(3.0, 30.0))
    assert steer(1.2, -30e3, 1099.0, 30e3) == pytest.approx(0.5)
    assert steer(1.2, 0.0, 1099.0, 0.0) == 0.0


def test_heading_alignment_nulls_the_heading_error_of_a_turning_vehicle(onboard, settings):
    """Lateral acceleration L sin(bank) with L = 2 m/s2: the track ends pointing at the target."""
    settings["heading"]["speed"] = 2000.0
    steer = Steering(onboard)
    x, y, heading, speed, dt = 0.0, 1500.0, 0.0, 1000.0, 0.2
    while x < 55e3:
        to_go = np.hypot(60e3 - x, y)
        error = heading - atan2(-y, 60e3 - x)
        bank = steer(1.0, to_go * sin(error), speed, to_go, dt)
        heading += 2.0 * sin(bank) / speed * dt
        x, y = x + speed * cos(heading) * dt, y + speed * sin(heading) * dt
    assert abs((60e3 - x) * np.tan(heading) + y) < 200.0  # miss if it flew on straight: from 1500 m


def test_wings_are_level_below_the_alignment_speed(onboard, settings):
    settings["heading"]["speed"] = 1100.0
    assert Steering(onboard)(1.2, 9000.0, 599.0, 9000.0) == 0.0
    assert abs(Steering(onboard)(pi / 2, 9000.0, 1101.0)) == pytest.approx(pi / 2)
