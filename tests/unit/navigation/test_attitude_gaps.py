"""Attitude over a gap of the gyros, recovery of the vertical, and the guards."""

from math import cos, pi, sin

import numpy as np
import pytest
from inertial_units import DT, believed_unit
from pyquaternion import Quaternion
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import in_si
from edl6dof.fsw.navigation.gyro_gaps import RATE_BRIDGE, acceleration_of, bridge_rate, end_bridge
from edl6dof.fsw.navigation.integrity import (
    ABOVE_HORIZON,
    BELOW_GROUND,
    CHECKS,
    INTEGRITY,
    JUMP,
    SPEED,
    GuardParams,
    check_solution,
    height_while_lost,
    plausible_height,
)
from edl6dof.fsw.navigation.radar_beams import height_from_beams, velocity_from_beams
from edl6dof.fsw.navigation.recovery import RECOVERY, RecoveryParams, recover
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.onboard import CONFIGURATION, ONBOARD
from edl6dof.interface.sensed import RADAR, SENSED

#: Largest rate that is believed, rad/s: beyond all that is flown here.
MOST = 12.0

INERTIA, MASS = np.array([1150.0, 900.0, 950.0]), 1270.0
CENTRE, HUNG_AT, UNIT = (
    np.array([-0.8, 0.0, -0.03]),
    np.array([-3.9, 0.02, -0.03]),
    np.array([-0.9, 0.3, 0.1]),
)
LEVER = UNIT - CENTRE


def hanging_body(hung_at=HUNG_AT):
    """Believed configuration, shape (1,), of a capsule under a riser."""
    body = np.zeros(1, CONFIGURATION)
    body["mass"], body["centre"], body["inertia"], body["hung_at"] = MASS, CENTRE, INERTIA, hung_at
    return body


class Swing:
    """A capsule under a riser that pulls from swinging directions, followed by scipy: rate and attitude, and
    what accelerometers read between two cycles.
    """

    def __init__(self, seconds):
        start = np.concatenate([(0.05, -0.1, 0.08), (1.0, 0.0, 0.0, 0.0)])
        t = np.arange(0.0, seconds + 0.5 * DT, DT)
        found = solve_ivp(self.slope, (0.0, t[-1]), start, t_eval=t, rtol=1e-10, atol=1e-12)
        self.rate, self.q = found.y[:3].T, [Quaternion(q) for q in found.y[3:].T]

    def slope(self, t, y):
        w, q = y[:3], Quaternion(y[3:])
        return np.concatenate([self.acceleration(t, y), 0.5 * (q * Quaternion(vector=w)).elements])

    def force(self, t, y):
        """Of the riser by mass, m/s2, B."""
        pull = np.array([-1.0, 0.03 * sin(6.0 * t), 0.02 * cos(7.0 * t)])
        return (30.0 + 15.0 * t) * Quaternion(y[3:]).inverse.rotate(pull / np.linalg.norm(pull))

    def acceleration(self, t, y):
        moment = np.cross(HUNG_AT - CENTRE, MASS * self.force(t, y))
        return (moment - np.cross(y[:3], INERTIA * y[:3])) / INERTIA

    def read(self, k):
        """Velocity counted at the unit in cycle ``k``, by its value in the middle."""
        w, q = 0.5 * (self.rate[k] + self.rate[k + 1]), Quaternion.slerp(self.q[k], self.q[k + 1], 0.5)
        y = np.concatenate([w, q.elements])
        t = (k + 0.5) * DT
        swung = np.cross(self.acceleration(t, y), LEVER) + np.cross(w, np.cross(w, LEVER))
        return DT * (self.force(t, y) + swung)

    def angle(self, k):
        """Angle turned through in cycle ``k``."""
        turn = self.q[k].inverse * self.q[k + 1]
        return turn.axis * turn.radians


def test_angular_acceleration_from_what_the_unit_reads():
    swing, w = Swing(0.1), np.array([0.3, -0.5, 0.4])
    y = np.concatenate([w, (1.0, 0.0, 0.0, 0.0)])
    change = swing.acceleration(0.02, y)
    read = swing.force(0.02, y) + np.cross(change, LEVER) + np.cross(w, np.cross(w, LEVER))
    assert np.allclose(acceleration_of(hanging_body()[0], tuple(LEVER), tuple(read), tuple(w)), change)


def test_rate_without_torque_keeps_the_angular_momentum():
    body, w = hanging_body(CENTRE)[0], np.array([0.3, -0.5, 0.4])
    change = acceleration_of(body, tuple(LEVER), (-6.0, 0.5, 0.2), tuple(w))
    assert np.allclose(INERTIA * change, -np.cross(w, INERTIA * w))


@pytest.mark.parametrize(
    "beside, bound_deg", [pytest.param((0.0,) * 3, 0.1, marks=pytest.mark.long), ((0.0, 0.002, -0.002), 0.3)]
)
def test_bridge_follows_a_capsule_under_its_riser(beside, bound_deg):
    """A second; with the believed centre millimetres off, the rate is degrees a second off at its end."""
    swing, cycles = Swing(1.1), 50
    body, memory, motion = hanging_body(HUNG_AT + beside), np.zeros(1, RATE_BRIDGE), np.zeros(1, MOTION)
    motion["rate"] = swing.rate[0]
    q = held = swing.q[0]
    for k in range(cycles):
        bridge_rate(body[0], tuple(LEVER), tuple(swing.read(k)), MOST, DT, memory[0], motion[0])
        q = turned(q, motion["angle"][0])
        held = turned(held, DT * swing.rate[0])
    before = motion["rate"][0].copy()
    motion["angle"], motion["rate"] = swing.angle(cycles), swing.rate[cycles + 1]
    end_bridge(
        body[0], tuple(LEVER), tuple(swing.read(cycles)), MOST, DT, tuple(before), memory[0], motion[0]
    )
    q = turned(q, motion["angle"][0])
    true = swing.q[cycles + 1]
    assert abs((held.inverse * true).degrees) > 5.0
    assert abs((q.inverse * true).degrees) < bound_deg
    assert memory["push"][0] == 0.0 and np.array_equal(motion["rate"][0], swing.rate[cycles + 1])


def test_a_bridged_rate_that_is_off_does_not_run_away():
    """A capsule that swings fast, its unit far off the centre, bridged for three seconds from a rate that is
    40 % off: without the bound the centripetal part makes it infinite.
    """
    body, memory, motion = hanging_body(), np.zeros(1, RATE_BRIDGE), np.zeros(1, MOTION)
    motion["rate"] = (0.2, 7.0, -1.0)
    for k in range(150):
        gain = DT * np.array([-40.0, 6.0 * sin(5.0 * k * DT), 9.0 * cos(5.0 * k * DT)])
        bridge_rate(body[0], (-0.1, 0.6, 0.3), tuple(gain), MOST, DT, memory[0], motion[0])
    assert np.all(np.abs(motion["rate"][0]) <= MOST)


def turned(q, angle):
    size = np.linalg.norm(angle)
    return q * Quaternion(axis=angle / size, radians=size)


BEAMS = np.array([[cos(0.4), sin(0.4) * cos(a), sin(0.4) * sin(a)] for a in (0.8, 2.3, 3.9, 5.5)])


def radar_of(velocity, height, down):
    """``RADAR`` record, shape (1,), of four beams over level ground; ``velocity``, ``down``: B."""
    radar = np.zeros(1, RADAR)
    radar["fresh"], radar["locked"][0, :4] = 1, 1
    radar["speed"][0, :4], radar["range"][0, :4] = BEAMS @ velocity, height / (BEAMS @ down)
    return radar


def instruments():
    """Belief, shape (1,), with the beams of above."""
    known = believed_unit()
    known["n_beams"], known["beam_axis"][0, :4], known["radar_ceiling"] = 4, BEAMS, 7000.0
    return known


def in_use():
    health = np.zeros(1, INSTRUMENT_HEALTH)
    health["beam_range"] = health["beam_speed"] = 1
    return health


def test_beams_tell_velocity_and_height_and_disagree_when_one_has_failed():
    velocity, down = np.array([80.0, 12.0, -7.0]), np.array([0.96, 0.28, 0.0])
    radar = radar_of(velocity, 1500.0, down)
    found, seen = velocity_from_beams(instruments()[0], in_use()[0], radar[0])
    assert seen and np.allclose(found, velocity)
    assert height_from_beams(instruments()[0], in_use()[0], radar[0], tuple(down)) == pytest.approx(1500.0)
    radar["speed"][0, 1] = 0.0
    assert not velocity_from_beams(instruments()[0], in_use()[0], radar[0])[1]
    radar["locked"][0, 1:3] = 0
    assert not velocity_from_beams(instruments()[0], in_use()[0], radar[0])[1]


class Descent:
    """A capsule that sways and rolls under a canopy in changing wind, seen by a solution with a wrong
    attitude, velocity and height.
    """

    GRAVITY = 3.7

    def __init__(self, off):
        self.onboard, self.solution, self.sensed = (np.zeros(1, kind) for kind in (ONBOARD, SOLUTION, SENSED))
        planet = self.onboard["planet"]
        planet["mu"], planet["equatorial_radius"] = self.GRAVITY * 3.4e6**2, 3.4e6
        self.onboard["instruments"] = instruments()
        self.onboard["site"]["altitude"] = -4000.0
        self.memory, self.motion = np.zeros(1, RECOVERY), np.zeros(1, MOTION)
        self.motion["dt"], self.motion["rate_known"], self.motion["force_known"] = DT, 1, 1
        self.memory["lost"], self.off, self.t = 1, off, 0.0
        self.solution["r_I"] = (3.4e6 - 30e3, 0.0, 0.0)
        self.params = in_si(RecoveryParams())

    def attitude(self, t):
        down = Quaternion(axis=(0.0, 0.0, 1.0), degrees=180.0)
        return (
            down
            * Quaternion(axis=(0, 1, 0), radians=0.2 * sin(1.3 * t))
            * Quaternion(axis=(1, 0, 0), radians=0.2 * t)
        )

    def velocity(self, t):
        return np.array([-80.0 + 0.3 * t, 10.0 * sin(0.5 * t), 5.0 * cos(1.3 * t)])

    def cycles(self, seconds):
        for _ in range(round(seconds / DT)):
            before, self.t = self.t, self.t + DT
            q = self.attitude(self.t)
            gained = self.velocity(self.t) - self.velocity(before) + DT * np.array([self.GRAVITY, 0.0, 0.0])
            self.motion["gain"] = q.inverse.rotate(gained)
            if self.memory["lost"][0]:
                self.solution["q_I2B"] = (self.off * q).elements
            self.solution["t"] = self.sensed["t"] = self.t
            down = q.inverse.rotate(np.array([-1.0, 0.0, 0.0]))
            self.sensed["radar"] = radar_of(q.inverse.rotate(self.velocity(self.t)), 5000.0, down)
            recover(
                self.params, self.onboard[0], in_use()[0], self.sensed[0], self.motion[0], self.memory[0],
                self.solution[0],
            )  # fmt: skip
            if not self.memory["lost"][0]:
                break


@pytest.mark.parametrize("degrees", [*(pytest.param(x, marks=pytest.mark.long) for x in (1.0, 40.0)), 165.0])
def test_gravity_and_radar_find_the_vertical_velocity_and_height_again(degrees):
    descent = Descent(Quaternion(axis=(0.2, 1.0, -0.5), degrees=degrees))
    descent.cycles(12.0)
    assert descent.memory["lost"][0] == 0 and descent.memory["found_t"][0] == pytest.approx(10.0, abs=0.1)
    read = Quaternion(descent.solution["q_I2B"][0])
    up = read.rotate(descent.attitude(descent.t).inverse.rotate(np.array([1.0, 0.0, 0.0])))
    assert np.degrees(np.arccos(min(up[0], 1.0))) < 0.3
    speed = descent.velocity(descent.t)
    assert descent.solution["v_I"][0, 0] == pytest.approx(speed[0], abs=0.5)
    assert np.linalg.norm(descent.solution["v_I"]) == pytest.approx(np.linalg.norm(speed))
    assert descent.solution["r_I"][0, 0] == pytest.approx(3.4e6 + 1000.0, abs=50.0)


def test_sound_attitude_is_left_alone_and_a_long_gap_loses_it():
    descent = Descent(Quaternion(axis=(0, 1, 0), degrees=30.0))
    descent.memory["lost"], descent.motion["rate_known"] = 0, 0
    before = descent.solution.copy()
    for _ in range(200):
        recover(
            descent.params, descent.onboard[0], in_use()[0], descent.sensed[0], descent.motion[0],
            descent.memory[0], descent.solution[0],
        )  # fmt: skip
        assert descent.memory["lost"][0] == (descent.memory["gap"][0] > 3.0)
    assert np.array_equal(before, descent.solution)


def told(heights, climb=-50.0, sigma=1.0, contact=0, **settings):
    """What is told of ``heights``, cycle by cycle, and the failed checks."""
    params, memory = in_si(GuardParams(**settings)), np.zeros(1, INTEGRITY)
    found = []
    for height in heights:
        height = plausible_height(params, height, climb, sigma, contact, DT, memory[0])
        found.append((height, int(memory["failed"][0])))
    return found


FALL = 500.0 - 50.0 * DT * np.arange(200)


def test_plausible_heights_are_told_as_they_are():
    assert told(FALL) == [(height, 0) for height in FALL]


def test_height_below_the_ground_is_seen():
    found = told(np.where(np.arange(200) < 20, FALL, -300.0))
    assert [failed & BELOW_GROUND for _, failed in found] == [0] * 20 + [BELOW_GROUND] * 180


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


def test_without_guards_everything_is_told_but_the_failed_check_stays():
    assert told([100.0, -300.0], jump=False) == [
        (100.0, 0),
        (-300.0, BELOW_GROUND | JUMP),
    ]


def checked(failed=0, tilt=0.0, said=80.0, beams=4, looks=5, **settings):
    """Failed checks and memories after looks at beams that show 80 m/s straight down, the attitude ``tilt``
    off; ``failed`` is what was found of the height before.
    """
    params, sensed, recovery = in_si(GuardParams(**settings)), np.zeros(1, SENSED), np.zeros(1, RECOVERY)
    sensed["t"], sensed["radar"] = 7.0, radar_of(np.array([80.0, 0.0, 0.0]), 900.0, np.array([1.0, 0.0, 0.0]))
    sensed["radar"]["locked"][0, beams:] = 0
    down = Quaternion(axis=(0, 1, 0), radians=pi / 2 + tilt)  # x of B along -z of I, tilted
    memory = np.zeros(1, INTEGRITY)
    memory["height"] = 300.0
    for _ in range(looks):
        memory["failed"] = failed
        check_solution(
            params, instruments()[0], in_use()[0], sensed[0], said, 0.1, tuple(down.elements),
            (0.0, 0.0, 1.0), memory[0], recovery[0],
        )  # fmt: skip
    return int(memory["failed"][0]), memory, recovery


@pytest.mark.parametrize(
    "case, failed, switch",
    [
        ({"failed": BELOW_GROUND}, BELOW_GROUND, "below_ground"),
        ({"said": 200.0}, SPEED, "speed"),
        ({"tilt": pi}, ABOVE_HORIZON, "vertical"),
    ],
)
def test_what_cannot_be_true_loses_the_attitude_where_its_guard_is_on(case, failed, switch):
    found, memory, recovery = checked(**case)
    assert found == failed and recovery["lost"][0] == 1
    assert [t > 0.0 for t in memory["first_t"][0]] == [bool(failed >> k & 1) for k in range(len(CHECKS))]
    found, _, recovery = checked(**case, **{switch: False})
    assert found == failed and recovery["lost"][0] == 0


@pytest.mark.parametrize(
    "case", [{}, {"tilt": pi / 4.0}, {"tilt": pi, "beams": 1}, {"said": 200.0, "looks": 4}, {"said": 95.0}]
)
def test_what_can_be_true_is_left_alone(case):
    found, _, recovery = checked(**case)
    assert found == 0 and recovery["lost"][0] == 0


def test_while_the_attitude_is_lost_echoes_tell_the_height():
    """And as long as there is none, no less than from where the radar sees."""
    _, memory, _ = checked(failed=BELOW_GROUND)
    nothing = np.zeros(1, RADAR)
    assert height_while_lost(instruments()[0], in_use()[0], nothing[0], memory[0]) == 7000.0
    radar = radar_of(np.array([80.0, 0.0, 0.0]), 900.0, np.array([1.0, 0.0, 0.0]))
    assert height_while_lost(instruments()[0], in_use()[0], radar[0], memory[0]) == pytest.approx(900.0)
    assert height_while_lost(instruments()[0], in_use()[0], nothing[0], memory[0]) == pytest.approx(900.0)
