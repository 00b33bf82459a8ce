"""What the bridge lacked over a gap of the gyros, against motions that scipy integrates."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from edl6dof.fsw.navigation.gyro_gaps import GAP_SMOOTHING, bridge_rate, end_bridge, smooth_gap
from edl6dof.fsw.navigation.inertial import INERTIAL_MEMORY
from edl6dof.fsw.navigation.solution import MOTION, SOLUTION
from edl6dof.fsw.navigation.strapdown import turn_by
from edl6dof.fsw.onboard import CONFIGURATION

H = 0.02
#: Largest rate that is believed, rad/s: beyond all that is flown here.
MOST = 12.0
INERTIA = np.array([1148.0, 816.0, 866.0])
NOTHING = np.zeros(3)
LEVER = np.array([-0.1, 0.3, 0.03])


def body():
    record = np.zeros(1, CONFIGURATION)[0]
    record["mass"], record["inertia"] = 1246.0, INERTIA
    record["centre"], record["hung_at"] = (-0.806, 0.0, -0.034), (-3.9, 0.0, -0.034)
    return record


def force(t):
    """Of a riser that pulls and swings, m/s2, B."""
    return np.array([-45.0 + 4.0 * t, 0.25 * np.sin(5.0 * t), 0.35 * np.cos(6.0 * t)])


def error_after_gap(centre_error=NOTHING, air=lambda t: NOTHING, gap=1.0, begins=1.0, ends=4.0):
    """Angle (deg) by which the attitude is off at the end: right after the gap and in hindsight."""
    known = body()
    arm = known["hung_at"] - known["centre"] - centre_error

    def spin(t, w):
        return (known["mass"] * np.cross(arm, force(t)) + air(t) - np.cross(w, INERTIA * w)) / INERTIA

    times = np.arange(0.0, ends, H)
    rates = solve_ivp(spin, (0.0, ends), [0.02, -0.05, 0.04], t_eval=times, rtol=1e-10, atol=1e-12).y.T
    motion, solution = np.zeros(1, MOTION)[0], np.zeros(1, SOLUTION)[0]
    inertial, memory = np.zeros(1, INERTIAL_MEMORY)[0], np.zeros(1, GAP_SMOOTHING)[0]
    bridging = inertial["rate_bridge"]
    solution["q_I2B"] = true = np.array([1.0, 0.0, 0.0, 0.0])
    motion["dt"], off = H, []
    for t, w0, w1 in zip(times, rates, rates[1:], strict=False):
        turn = (w1 - w0) / H
        angle, middle = 0.5 * H * (w0 + w1), 0.5 * (w0 + w1)
        at_unit = force(t + 0.5 * H) + np.cross(turn, LEVER) + np.cross(middle, np.cross(middle, LEVER))
        gain = inertial["gain"] = H * at_unit
        before, was_known = motion["rate"].copy(), motion["rate_known"]
        motion["rate_known"] = int(not begins <= t < begins + gap)
        if not motion["rate_known"]:
            bridge_rate(known, tuple(LEVER), tuple(gain), MOST, H, bridging, motion)
        else:
            motion["angle"], motion["rate"] = angle, w1
            if not was_known and bridging["push"] > 0.0:
                end_bridge(known, tuple(LEVER), tuple(gain), MOST, H, tuple(before), bridging, motion)
        true = np.array(turn_by(tuple(true), tuple(angle)))
        solution["q_I2B"] = turn_by(tuple(solution["q_I2B"]), tuple(motion["angle"]))
        smooth_gap(known, tuple(LEVER), inertial, motion, memory, solution)
        turned = Rotation.from_quat(true, scalar_first=True).inv()
        turned = turned * Rotation.from_quat(solution["q_I2B"], scalar_first=True)
        off.append(np.degrees(turned.magnitude()))
    arrived = int((begins + gap) / H) + 3
    return off[arrived], off[-1]


def rising(t):
    """Torque of the air on a body that pitches up more and more, N m."""
    return np.array([0.0, -60.0 - 80.0 * t, 25.0 + 30.0 * t])


def test_a_sound_model_is_left_alone():
    soon, late = error_after_gap()
    assert soon < 0.02 and late < 0.02


@pytest.mark.parametrize("gap", [0.3, pytest.param(1.0, marks=pytest.mark.long)])
def test_centre_of_mass_elsewhere_and_the_torque_of_the_air_are_found_in_hindsight(gap):
    soon, late = [], []
    for seed in range(5):
        rng = np.random.default_rng(seed)
        centre_error, size = rng.normal(0.0, 0.002, 3), rng.uniform(0.5, 1.5, 3)
        one, other = error_after_gap(centre_error, lambda t, size=size: size * rising(t), gap, ends=gap + 2.0)
        soon.append(one)
        late.append(other)
    assert np.mean(late) < 0.35 * np.mean(soon)
    assert max(late) < 0.6 * max(soon)


def test_gap_that_began_before_the_riser_pulled_is_not_looked_at():
    memory, motion, solution = np.zeros(1, GAP_SMOOTHING)[0], np.zeros(1, MOTION)[0], np.zeros(1, SOLUTION)[0]
    inertial = np.zeros(1, INERTIAL_MEMORY)[0]
    free, hung = body(), body()
    free["hung_at"] = free["centre"]
    solution["q_I2B"], motion["dt"] = (1.0, 0.0, 0.0, 0.0), H
    rng = np.random.default_rng(1)
    for k in range(200):
        motion["rate_known"] = int(not 20 <= k < 70)
        inertial["gain"], motion["rate"] = H * force(k * H), rng.normal(0.0, 0.05, 3)
        smooth_gap(free if k < 40 else hung, tuple(LEVER), inertial, motion, memory, solution)
    assert solution["q_I2B"].tolist() == [1.0, 0.0, 0.0, 0.0]
