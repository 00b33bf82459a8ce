"""The filter that puts the radar into the loop, and gyros that are taken at their word: against what the
signs and projections must be.
"""

from math import cos, radians, sin

import numpy as np
import pytest

from edl6dof.config.dtype import in_si
from edl6dof.fsw.navigation.filters.radar_in_loop import MEMBER, RADAR_IN_LOOP, RadarInLoopParams
from edl6dof.fsw.navigation.redundancy import REDUNDANT, SaturationParams, usable_gyros
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.interface.sensed import INERTIAL, SENSED

RADIUS, HEIGHT, DESCENT, DT = 3.4e6, 4000.0, 70.0, 0.1
BEAMS = np.array([[cos(0.35), sin(0.35) * cos(a), sin(0.35) * sin(a)] for a in (0.0, 1.6, 3.1, 4.7)])
correct, start = MEMBER.kernels["correct"], MEMBER.kernels["start"]


def flight(off_deg, higher=0.0, **params):
    """A lander that hangs upright over the equator at ``HEIGHT`` and believes itself turned about north by
    ``off_deg`` and ``higher`` metres up: what the filter needs, and a function that looks once.
    """
    onboard, sensed, solution = np.zeros(1, ONBOARD), np.zeros(1, SENSED), np.zeros(1, SOLUTION)
    motion, health, memory = np.zeros(1, MOTION), np.zeros(1, INSTRUMENT_HEALTH), np.zeros(1, RADAR_IN_LOOP)
    planet, instruments = onboard["planet"], onboard["instruments"]
    planet["equatorial_radius"], planet["mu"] = RADIUS, 3.72 * RADIUS**2
    instruments["beam_axis"][0, :4], instruments["n_beams"] = BEAMS, 4
    health["beam_range"] = health["beam_speed"] = 1
    solution["r_I"] = (RADIUS + HEIGHT + higher, 0.0, 0.0)
    solution["v_I"] = (-DESCENT, 0.0, 0.0)
    # upright: x of B points down, that is along -x of I; turned about z of I, which is north
    half = 0.5 * (np.pi + radians(off_deg))
    solution["q_I2B"] = (cos(half), 0.0, 0.0, sin(half))
    motion["dt"] = DT
    radar = sensed["radar"]
    radar["fresh"], radar["locked"][0, :4] = 1, 1
    radar["range"][0, :4], radar["speed"][0, :4] = HEIGHT / BEAMS[:, 0], DESCENT * BEAMS[:, 0]
    given = in_si(RadarInLoopParams(**{"settle_s": 1.0, "agree_s": 1.0, "patience_s": 2.0} | params))
    start(given, onboard[0], sensed[0], solution[0], memory[0])

    def look():
        correct(given, onboard[0], health[0], sensed[0], motion[0], solution[0], memory[0])

    return look, solution, memory


def height(solution):
    return np.linalg.norm(solution["r_I"][0]) - RADIUS


def test_it_comes_into_the_loop_when_both_agree_and_follows_the_radar():
    look, solution, memory = flight(0.0, higher=100.0)
    for _ in range(15):
        look()
        assert memory["in_loop"][0] == 0 and height(solution) == pytest.approx(HEIGHT + 100.0)
    for _ in range(10):
        look()
    assert memory["in_loop"][0] == 1 and memory["forced"][0] == 0
    assert height(solution) == pytest.approx(HEIGHT, abs=1.0)


@pytest.mark.parametrize("off_deg", [120.0, 165.0])
def test_it_is_forced_in_after_patience_and_projects_with_the_wrong_attitude(off_deg):
    """Slant range times the cosine of an angle beyond 90 deg: the height is negative, the velocity upward."""
    look, solution, memory = flight(off_deg)
    for _ in range(28):
        look()
    assert memory["in_loop"][0] == 0 and height(solution) == pytest.approx(HEIGHT)
    for _ in range(10):
        look()
    assert memory["forced"][0] == 1
    slant = np.mean(HEIGHT / BEAMS[:, 0] * (BEAMS @ (cos(radians(off_deg)), -sin(radians(off_deg)), 0.0)))
    assert height(solution) == pytest.approx(slant, abs=2.0) and slant < -1000.0
    assert solution["v_I"][0, 0] == pytest.approx(-DESCENT * cos(radians(off_deg)), abs=0.1)


def test_a_flagged_gyro_is_held_at_the_end_that_it_met_until_its_flag_goes():
    """To and fro in truth, constant on board; the next time it may be the other end."""
    onboard, inertial, redundant = np.zeros(1, ONBOARD), np.zeros(1, INERTIAL), np.zeros(1, REDUNDANT)
    instruments, healthy = onboard["instruments"], np.ones(8, "i8")
    instruments["n_gyros"], instruments["gyro_range"] = 3, 2.0
    taken_at_its_word = in_si(SaturationParams(left_out=False))
    seen = []
    for flag, moved in ((0, 0.01), (1, 0.04), (1, -0.03), (1, 0.0), (0, -0.01), (1, -0.04), (1, 0.02)):
        inertial["gyro_saturated"][0, 1], redundant["increment"][0, 1] = flag, moved
        bits = usable_gyros(taken_at_its_word, instruments[0], 0.02, healthy, inertial[0], redundant[0])
        seen.append(redundant["increment"][0, 1])
        assert bits == 0b111
    assert np.allclose(seen, [0.01, 0.04, 0.04, 0.04, -0.01, -0.04, -0.04])
