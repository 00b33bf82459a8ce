"""An inertial unit with failed and saturated instruments: the motion is still that of the body."""

import numpy as np
import pytest
from inertial_units import DT, believed_unit, cone

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.filters.registry import NavigationParams
from edl6dof.fsw.navigation.inertial import INERTIAL_MEMORY, read_motion, take_reading
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.onboard import CONFIGURATION
from edl6dof.interface.sensed import INERTIAL

RATE, FORCE = np.array([0.2, -0.1, 0.05]), np.array([-30.0, 1.0, -4.0])
CENTRE = (-0.6, 0.02, 0.0)


class Bench:
    """Six gyros and six accelerometers on an evenly turning, evenly pulled body."""

    def __init__(self, seed=0, begin=0.0):
        self.params = np.zeros(1, dtype_of(NavigationParams))
        fill(self.params[0], NavigationParams())
        self.known, self.rng = believed_unit(), np.random.default_rng(seed)
        self.known["unit_position"] = CENTRE
        self.body = np.zeros(1, CONFIGURATION)
        self.body["mass"], self.body["inertia"] = 1000.0, 900.0
        self.body["centre"] = self.body["hung_at"] = CENTRE
        self.reading, self.memory = np.zeros(1, INERTIAL), np.zeros(1, INERTIAL_MEMORY)
        self.health, self.motion = np.zeros(1, INSTRUMENT_HEALTH), np.zeros(1, MOTION)
        self.solution = np.zeros(1, SOLUTION)
        self.health["gyro"] = self.health["accelerometer"] = 1
        self.t = begin
        take_reading(self.known[0], begin, self.reading[0], self.memory[0])

    def cycles(self, number, gyro=(), accelerometer=(), rate=RATE, noise=1.0):
        """Go on; ``gyro``, ``accelerometer``: what fails as (index, error of its rate)."""
        for _ in range(number):
            self.t += DT
            w, f = cone() @ rate, cone() @ FORCE
            for i, error in gyro:
                w[i] += error
            for i, error in accelerometer:
                f[i] += error
            white = noise * self.rng.normal(size=(2, 6)) * DT**0.5
            self.reading["angle"][0, :6] += w * DT + self.known["gyro_noise"] * white[0]
            self.reading["rate"][0, :6] = w
            self.reading["gain"][0, :6] += f * DT + self.known["accelerometer_noise"] * white[1]
            dt = take_reading(self.known[0], self.t, self.reading[0], self.memory[0])
            read_motion(
                self.params[0], self.known[0], self.body[0], dt, self.reading[0], self.solution[0],
                self.health[0], self.memory[0], self.motion[0],
            )  # fmt: skip

    def excluded(self, kind):
        return [i for i in range(6) if not self.health[kind][0, i]]


def test_sound_unit_reads_the_motion():
    bench = Bench()
    bench.cycles(500, noise=0.0)
    assert np.allclose(bench.motion["angle"][0], RATE * DT, atol=1e-12)
    assert np.allclose(bench.motion["gain"][0], FORCE * DT, atol=1e-12)
    assert np.allclose(bench.motion["rate"][0], RATE, atol=1e-12)


def test_lever_arm_is_taken_off():
    bench = Bench()
    arm = np.array([0.3, -0.4, 0.2])
    bench.known["unit_position"] = np.array(CENTRE) + arm
    bench.cycles(3, noise=0.0)
    centrifugal = np.cross(RATE, np.cross(RATE, arm))
    assert np.allclose(bench.motion["gain"][0], (FORCE - centrifugal) * DT, atol=1e-12)
    before = RATE
    bench.cycles(1, rate=(after := RATE + np.array([0.01, 0.0, -0.02])), noise=0.0)
    turned = np.cross(after - before, arm) + DT * np.cross(after, np.cross(after, arm))
    assert np.allclose(bench.motion["gain"][0], FORCE * DT - turned, atol=1e-12)


def test_biases_of_the_solution_are_taken_off():
    bench = Bench()
    bench.solution["gyro_bias"], bench.solution["accelerometer_bias"] = (1e-3, 0.0, -2e-3), (0.0, 0.1, 0.0)
    bench.cycles(3, noise=0.0)
    assert np.allclose(bench.motion["angle"][0], DT * (RATE - bench.solution["gyro_bias"][0]), atol=1e-12)
    assert np.allclose(
        bench.motion["gain"][0], DT * (FORCE - bench.solution["accelerometer_bias"][0]), atol=1e-12
    )


@pytest.mark.parametrize("i", [0, 4, *(pytest.param(i, marks=pytest.mark.long) for i in (1, 2, 3, 5))])
@pytest.mark.parametrize("kind, error", [("gyro", 5.0), ("gyro", -0.01), ("accelerometer", 300.0)])
def test_failed_one_spoils_no_cycle_and_is_excluded(i, kind, error):
    bench = Bench(i)
    bench.cycles(100)
    fault = {kind: [(i, error)]}
    for cycle in range(5):
        bench.cycles(1, **fault)
        assert bench.excluded(kind) == ([i] if cycle == 4 else [])
        assert np.allclose(bench.motion["angle"][0], RATE * DT, atol=5e-6)
        assert np.allclose(bench.motion["rate"][0], RATE, atol=5e-4)
        assert np.allclose(bench.motion["gain"][0], FORCE * DT, atol=5e-4)
    bench.cycles(1, **fault)
    other = "accelerometer" if kind == "gyro" else "gyro"
    assert bench.excluded(kind) == [i] and bench.excluded(other) == []


@pytest.mark.parametrize("first, second", [(0, 3), (1, 2), (4, 5), (5, 0)])
@pytest.mark.parametrize("kind", ["gyro", "accelerometer"])
def test_two_lost_in_turn_are_both_named(kind, first, second):
    bench = Bench()
    bench.cycles(100)
    bench.cycles(20, **{kind: [(first, 0.5)]})
    bench.cycles(20, **{kind: [(first, 0.5), (second, -0.5)]})
    assert bench.excluded(kind) == sorted([first, second])
    bench.cycles(1, noise=0.0, **{kind: [(first, 0.5), (second, -0.5)]})
    assert np.allclose(bench.motion["angle"][0], RATE * DT, atol=1e-12)
    assert np.allclose(bench.motion["gain"][0], FORCE * DT, atol=1e-9)


@pytest.mark.parametrize("kind", ["gyro", "accelerometer"])
def test_believed_biases_walk_from_the_first_reading_on(kind):
    """Whenever that was: their spread grows with the root of the time since."""
    spreads = []
    for begin in (0.0, 1000.0):
        bench = Bench(begin=begin)
        for name, value in (("bias", 0.0), ("scale", 0.0), ("bias_walk", 1e-4)):
            bench.known[f"{kind}_{name}"] = value
        bench.cycles(2000)
        spreads.append(bench.memory[f"{kind}_parity"]["mean_lasting"][0])
    # a mean over the last part of the 40 s
    assert 1e-4 * np.sqrt(20.0) < spreads[0] < 1e-4 * np.sqrt(40.0)
    assert spreads[1] == pytest.approx(spreads[0], rel=1e-6)


def test_saturated_gyros_are_left_out_while_they_are():
    bench = Bench()
    bench.cycles(10)
    bench.reading["gyro_saturated"][0, [1, 4]] = 1
    bench.cycles(10, gyro=[(1, -3.0), (4, 2.0)])
    assert bench.motion["rate_known"][0] == 1 and bench.excluded("gyro") == []
    assert np.allclose(bench.motion["angle"][0], RATE * DT, atol=5e-6)


def test_without_gyros_the_force_carries_the_attitude_and_the_rate_comes_back():
    bench = Bench()
    bench.cycles(10)
    bench.reading["gyro_saturated"] = 1
    bench.cycles(10, gyro=[(i, 3.0) for i in range(6)])
    assert bench.motion["rate_known"][0] == 0
    assert bench.motion["angle"][0, 0] == pytest.approx(RATE[0] * DT, abs=1e-4)
    bench.reading["gyro_saturated"] = 0
    bench.cycles(2, noise=0.0)
    assert bench.motion["rate_known"][0] == 1 and bench.excluded("gyro") == []
    assert np.allclose(bench.motion["angle"][0], RATE * DT, atol=1e-12)


def test_without_accelerometers_the_last_gain_is_held():
    bench = Bench()
    bench.cycles(10, noise=0.0)
    bench.reading["accelerometer_saturated"] = 1
    bench.cycles(5, accelerometer=[(i, 50.0) for i in range(6)], noise=0.0)
    assert bench.motion["force_known"][0] == 0
    assert np.allclose(bench.motion["gain"][0], FORCE * DT, atol=1e-12)


def test_first_reading_is_handed_out_until_an_older_one_has_arrived():
    known, memory = believed_unit(), np.zeros(1, INERTIAL_MEMORY)
    known["unit_delay"] = 2.0 * DT
    reading = np.zeros(1, INERTIAL)
    steps = [take_reading(known[0], k * DT, reading[0], memory[0]) for k in range(5)]
    assert np.allclose(steps, [0.0, 0.0, 0.0, DT, DT])
