"""The controllers closed around a rigid body with ideal torque: predictions in closed form for each."""

from math import degrees, exp, radians

import numpy as np
import pytest
from pyquaternion import Quaternion

from edl6dof.fsw.control.registry import CONTROL_INPUTS, CONTROLLERS, attitude_control
from edl6dof.fsw.control.thrust_vector import DECOUPLED, SHORTEST_PATH, compensation
from edl6dof.fsw.control.thrust_vector import MEMORY as THRUST_VECTOR
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
ENTRY, LANDER = 0, 0b111

DT = 0.02
X, Y, Z = np.eye(3)
NORTH, EAST, UP = X, Y, -Z


class Control:
    """What a controller has beside navigation and the goal: its inputs and its memory; and its last error."""

    def __init__(self, configuration, phase_start=-100.0):
        self.configuration, self.phase_start, self.error = configuration, phase_start, None
        self.inputs, self.memory = np.zeros(1, CONTROL_INPUTS)[0], np.zeros(1, CONTROLLERS.memory)[0]


def memory(configuration, phase_start=-100.0):
    return Control(configuration, phase_start)


def demand(name, onboard, nav, guide, own, dt=DT):
    own.inputs["inertia"] = inertia(onboard, own.configuration)
    own.inputs["phase_time"] = nav["t"] - own.phase_start
    own.inputs["bandwidth"] = onboard[0]["mission"]["phases"][0]["bandwidth"]
    torque, own.error = attitude_control(
        CONTROLLERS.names.index(name), onboard[0]["control"], nav, guide, own.inputs, dt, own.memory
    )
    return np.array(torque)


def inertia(onboard, configuration):
    return np.array(onboard[0]["vehicle"]["configuration"][configuration]["inertia"])


# ---- bank to steer (S1 section 4) --------------------------------------------------------------------------


def flying(alpha_deg=-10.0, beta_deg=0.0, bank_deg=0.0, rate=(0.0, 0.0, 0.0)):
    """Straight flight along north without gravity, so that the path does not turn."""
    nav = np.zeros(1, NAV)[0]
    path = Quaternion(axis=X, degrees=bank_deg)
    q = path * Quaternion(axis=Z, degrees=-beta_deg) * Quaternion(axis=Y, degrees=alpha_deg)
    nav["q_I2B"], nav["w_B"], nav["imu_rate_B"] = q.elements, rate, rate
    nav["v_rel_I"], nav["speed"], nav["up_I"], nav["north_I"], nav["east_I"] = (
        3000.0 * X,
        3000.0,
        UP,
        NORTH,
        EAST,
    )
    nav["alpha"], nav["beta"], nav["bank"] = radians(alpha_deg), radians(beta_deg), radians(bank_deg)
    nav["alpha_in_air"], nav["beta_in_air"] = nav["alpha"], nav["beta"]
    nav["wing_open"] = 1
    return nav


def commanded(bank_deg=0.0, alpha_deg=-10.0):
    guide = np.zeros(1, GUIDE)[0]
    guide["bank"], guide["alpha"], guide["thrust_direction_N"] = (
        radians(bank_deg),
        radians(alpha_deg),
        (0.0, 0.0, -1.0),
    )
    return guide


def test_bank_torque_turns_the_vehicle_about_the_velocity(onboard):
    torque = demand(
        "bank_to_steer", onboard, flying(alpha_deg=-12.0, beta_deg=3.0), commanded(60.0, -12.0), memory(ENTRY)
    )
    turning = torque / inertia(onboard, ENTRY)
    velocity_B = flying(-12.0, 3.0)
    q = Quaternion(velocity_B["q_I2B"])
    assert turning / np.linalg.norm(turning) == pytest.approx(q.inverse.rotate(X), abs=1e-9)


def test_after_the_trim_wing_bank_torque_turns_about_the_body_axis(onboard):
    fsw = memory(ENTRY)
    fsw.inputs["wing_commanded"] = 1
    torque = demand("bank_to_steer", onboard, flying(alpha_deg=-6.0), commanded(60.0), fsw)
    assert torque[0] > 100.0
    assert torque[1:] == pytest.approx(0.0, abs=1e-9)


def test_along_the_velocity_the_axes_after_the_trim_wing_are_those_before(onboard):
    """At no angle of attack and sideslip the velocity axes are the body axes: one torque, whatever turns."""
    p = onboard[0]["control"]["bank_to_steer"]
    p["damping_after_wing"] = p["damping"]
    nav, goal = flying(0.0, 0.0, 58.0, rate=(0.01, -0.05, 0.04)), commanded(60.0, 0.0)
    before, after = memory(ENTRY), memory(ENTRY)
    after.inputs["wing_commanded"] = 1
    torque = demand("bank_to_steer", onboard, nav, goal, before)
    assert np.all(np.abs(torque) > 1.0)
    assert demand("bank_to_steer", onboard, nav, goal, after) == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize("error_deg", [-14.0, -9.9, 0.0, 9.9, 13.0])
def test_angle_loops_of_attack_and_sideslip_close_beyond_ten_degrees_only(onboard, error_deg):
    p = onboard[0]["control"]["bank_to_steer"]
    outside = np.sign(error_deg) * max(abs(error_deg) - degrees(p["angle_limit"]), 0.0)
    torque = demand("bank_to_steer", onboard, flying(alpha_deg=-10.0 + error_deg), commanded(), memory(ENTRY))
    assert torque[1] == pytest.approx(
        -p["angle_gain"] * radians(outside) * inertia(onboard, ENTRY)[1], abs=1e-6
    )
    torque = demand("bank_to_steer", onboard, flying(beta_deg=error_deg), commanded(), memory(ENTRY))
    about = Quaternion(flying(beta_deg=error_deg)["q_I2B"]).rotate(torque / inertia(onboard, ENTRY))
    # about z of V, to the right
    assert about[2] == pytest.approx(p["angle_gain"] * radians(outside), abs=1e-9)


@pytest.mark.parametrize("wing", [0, 1])
def test_rate_of_the_angle_of_attack_decays_with_the_damping_gain(onboard, wing):
    """w' = -k w beyond the deadband d: w - d falls as exp(-k t), one factor 1 - k T each cycle."""
    p = onboard[0]["control"]["bank_to_steer"]
    gain = p["damping_after_wing"] if wing else p["damping"]
    rate, start, fsw = radians(6.0), radians(6.0), memory(ENTRY)
    fsw.inputs["wing_commanded"] = wing
    for _ in range(round(0.5 / DT)):
        torque = demand(
            "bank_to_steer", onboard, flying(0.0 if wing else -10.0, rate=(0.0, rate, 0.0)), commanded(), fsw
        )
        rate += DT * torque[1] / inertia(onboard, ENTRY)[1]
    dead = p["rate_deadband"]
    assert rate - dead == pytest.approx((start - dead) * exp(-0.5 * gain), rel=0.03)


@pytest.mark.parametrize("integrates", [True, False])
def test_integral_takes_out_the_bank_error_of_an_aerodynamic_bank_moment(onboard, integrates):
    """100 N m about the velocity: without the integral the error stays at moment / (inertia P), with it next
    to nothing is left.
    """
    zone, moment, roll_inertia = (
        onboard[0]["control"]["bank_to_steer"]["bank"],
        100.0,
        inertia(onboard, ENTRY)[0],
    )
    if not integrates:
        zone["integral"] = 0.0
    bank, rate, fsw = 0.0, 0.0, memory(ENTRY)
    for _ in range(round(12.0 / DT)):
        nav = flying(0.0, bank_deg=degrees(bank), rate=(rate, 0.0, 0.0))
        rate += (
            DT * (demand("bank_to_steer", onboard, nav, commanded(0.0, 0.0), fsw)[0] + moment) / roll_inertia
        )
        bank += DT * rate
    expected = 0.0 if integrates else degrees(moment / (roll_inertia * zone["proportional"]))
    assert degrees(bank) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize("held", [0, 1])
def test_angle_of_attack_is_closed_around_zero_where_the_phase_holds_it(onboard, held):
    fsw = memory(ENTRY)
    fsw.inputs["wing_commanded"], fsw.inputs["hold_alpha"] = 1, held
    torque = demand("bank_to_steer", onboard, flying(alpha_deg=-8.0), commanded(), fsw)
    assert (torque[1] > 50.0) == bool(held)


@pytest.mark.parametrize(
    ("alpha_deg", "beta_deg"),
    [
        pytest.param(-6.0, 0.0, marks=pytest.mark.long),
        pytest.param(0.0, 6.0, marks=pytest.mark.long),
        (-4.0, -5.0),
    ],
)
def test_held_angles_go_to_zero_in_the_expected_wind_against_a_moment_that_stays(
    onboard, alpha_deg, beta_deg
):
    """A thruster that is stuck on holds the nose 6 deg off, where the air balances it; the integrals take its
    moment out of both angles.

    The wind that is expected is 3 deg of sideslip: the angles of the planet-relative velocity are left with
    it.
    """
    stiffness = 1700.0  # N m/rad, of the air at 530 Pa
    fsw, stuck = memory(ENTRY), np.array([0.0, 180.0, -180.0])
    fsw.inputs["wing_commanded"], fsw.inputs["hold_alpha"] = 1, 1
    alpha, beta, w, wind = radians(alpha_deg), radians(beta_deg), np.zeros(3), radians(3.0)
    for _ in range(round(25.0 / DT)):
        nav = flying(degrees(alpha), degrees(beta + wind), rate=tuple(w))
        nav["alpha_in_air"], nav["beta_in_air"] = alpha, beta
        torque = demand("bank_to_steer", onboard, nav, commanded(), fsw) + stuck
        w += DT * (torque + stiffness * np.array([0.0, -alpha, beta])) / inertia(onboard, ENTRY)
        alpha, beta = alpha + DT * w[1], beta - DT * w[2]
    assert np.degrees([alpha, beta]) == pytest.approx(0.0, abs=0.1)


# ---- rate damping under the parachute (S1 section 5) -------------------------------------------------------


def hanging(roll_deg=0.0, rate=(0.0, 0.0, 0.0), t=0.0):
    """Upright, y of B south but for a roll error; ``roll_to_south`` is goal minus actual."""
    nav = flying()
    upright = Quaternion(matrix=np.column_stack([-UP, -NORTH, -EAST]))
    nav["q_I2B"] = (upright * Quaternion(axis=X, degrees=-roll_deg)).elements
    nav["w_B"], nav["roll_to_south"], nav["t"] = rate, radians(roll_deg), t
    return nav


def test_nothing_is_done_for_thirteen_seconds_and_small_rates_are_left_alone_afterwards(onboard):
    p = onboard[0]["control"]["rate_damping"]
    swinging = np.radians([0.0, 9.0, -9.0])
    assert p["rest"] == 13.0
    assert demand(
        "rate_damping", onboard, hanging(50.0, swinging, 12.9), commanded(), memory(ENTRY, 0.0)
    ) == pytest.approx(0.0)
    torque = demand("rate_damping", onboard, hanging(50.0, swinging, 13.1), commanded(), memory(ENTRY, 0.0))
    beyond = np.radians(9.0) - p["rate_deadband"]
    assert torque[1:] == pytest.approx(
        np.array([-1.0, 1.0]) * p["damping"] * beyond * inertia(onboard, ENTRY)[1:]
    )
    quiet = 0.99 * np.array([0.0, p["rate_deadband"], -p["rate_deadband"]])
    assert demand(
        "rate_damping", onboard, hanging(0.0, quiet, 20.0), commanded(), memory(ENTRY, 0.0)
    ) == pytest.approx(0.0, abs=1e-9)


def test_roll_under_the_parachute_takes_the_time_of_its_rate(onboard):
    zone = onboard[0]["control"]["rate_damping"]["roll"]
    error, rate, fsw, t = radians(40.0), 0.0, memory(ENTRY, -100.0), 0.0
    while error > zone["near"]:
        torque = demand(
            "rate_damping", onboard, hanging(degrees(error), (rate, 0.0, 0.0), t), commanded(), fsw
        )
        rate += DT * torque[0] / inertia(onboard, ENTRY)[0]
        error -= DT * rate
        t += DT
    assert t == pytest.approx(
        (radians(40.0) - zone["near"]) / zone["rate"] + 1.0 / zone["rate_gain"], rel=0.03
    )


# ---- thrust vector (S1 section 6) --------------------------------------------------------------------------


def slewed(onboard, goal_tilt, formulation, roll_deg=0.0, duration=8.0):
    """Thrust axis in I and roll error, by cycle, of a lander slewed from a tilt towards the vertical."""
    onboard[0]["control"]["thrust_vector"]["error"] = formulation
    fsw, guide = memory(LANDER), commanded()
    upright = Quaternion(matrix=np.column_stack([-UP, -NORTH, -EAST]))
    q = upright * Quaternion(axis=goal_tilt, degrees=60.0) * Quaternion(axis=X, degrees=roll_deg)
    rate, principal = np.zeros(3), inertia(onboard, LANDER)
    axes, errors = [], []
    for _ in range(round(duration / DT)):
        nav = hanging(rate=rate)
        nav["q_I2B"] = q.elements
        torque = demand("thrust_vector", onboard, nav, guide, fsw)
        rate = rate + DT * (torque - np.cross(rate, principal * rate)) / principal
        q = (q * Quaternion(axis=rate, radians=np.linalg.norm(rate) * DT)).normalised
        axes.append(q.rotate(-X))
        errors.append(np.array(fsw.error))
    return np.array(axes), np.array(errors)


@pytest.mark.parametrize(
    "towards_deg",
    [pytest.param(0.0, marks=pytest.mark.long), pytest.param(30.0, marks=pytest.mark.long), 117.0],
)
def test_decoupled_slew_moves_the_thrust_axis_along_one_great_circle_whatever_the_roll_error(
    onboard, towards_deg
):
    """Eq. 8: pitch and yaw are driven as one rotation; the thrust never leaves the plane of its first and its
    wanted direction.
    """
    tilt = np.array([0.0, np.cos(radians(towards_deg)), np.sin(radians(towards_deg))])
    axes, errors = slewed(onboard, tilt, DECOUPLED, roll_deg=70.0, duration=14.0)
    normal = np.cross(axes[0], UP) / np.linalg.norm(np.cross(axes[0], UP))
    # of 60: the rate loop lags while the body rolls under the command
    assert np.max(np.abs(np.degrees(axes @ normal))) < 3.0
    assert np.linalg.norm(errors[-1]) < radians(1.0)


def test_shortest_path_slew_leads_the_thrust_astray_when_there_is_a_roll_error(onboard):
    tilt = np.array([0.0, 1.0, 0.0])
    off = {}
    for formulation in (DECOUPLED, SHORTEST_PATH):
        axes, _ = slewed(onboard, tilt, formulation, roll_deg=110.0)
        normal = np.cross(axes[0], UP) / np.linalg.norm(np.cross(axes[0], UP))
        off[formulation] = np.max(np.abs(np.degrees(axes @ normal)))
    assert off[SHORTEST_PATH] > 5.0 * off[DECOUPLED]


def test_slew_of_the_thrust_axis_takes_the_time_of_its_rate_limit(onboard):
    zone = onboard[0]["control"]["thrust_vector"]["pitch_yaw"]
    axes, errors = slewed(onboard, Y, DECOUPLED)
    angle = np.arccos(np.clip(axes @ UP, -1.0, 1.0))
    inner = zone["proportional"] / zone["derivative"] * zone["near"]
    start = zone["near"] + (zone["rate"] ** 2 - inner**2) / (2.0 * zone["deceleration"])
    predicted = (radians(60.0) - start) / zone["rate"] + (zone["rate"] - inner) / zone["deceleration"]
    assert DT * np.argmax(angle < zone["near"]) == pytest.approx(predicted, abs=0.15)
    assert np.max(np.abs(np.diff(angle))) / DT < 1.01 * zone["rate"]


def test_bandwidth_of_a_phase_scales_the_natural_frequency(onboard):
    """Half the bandwidth: a quarter of the stiffness, half the damping, the same damping ratio."""
    small = hanging(roll_deg=2.0)
    full = demand("thrust_vector", onboard, small, commanded(), memory(LANDER))[0]
    damped = demand("thrust_vector", onboard, hanging(rate=(0.01, 0.0, 0.0)), commanded(), memory(LANDER))[0]
    onboard[0]["mission"]["phases"][0]["bandwidth"] = 0.5
    assert demand("thrust_vector", onboard, small, commanded(), memory(LANDER))[0] == pytest.approx(
        0.25 * full
    )
    slower = demand("thrust_vector", onboard, hanging(rate=(0.01, 0.0, 0.0)), commanded(), memory(LANDER))[0]
    assert slower == pytest.approx(0.5 * damped)


@pytest.mark.parametrize("bandwidth", [0.25, 0.7, 1.0])
def test_compensation_lags_the_disturbance_by_the_pole_and_the_bandwidth(bandwidth):
    """Behind an estimator of pole l a filter of pole l b / (1 - b): on a ramp their delays, 1/l and
    (1 - b)/(l b), add up to 1/(l b).
    """
    pole, dt = 2.0, 0.001
    inputs, own = np.zeros(1, CONTROL_INPUTS)[0], np.zeros(1, THRUST_VECTOR)[0]
    inputs["disturbance_pole"], inputs["bandwidth"] = pole, bandwidth
    for k in range(12_000):
        t = k * dt
        inputs["disturbance_torque"] = (t - (1.0 - exp(-pole * t)) / pole) * np.array([1.0, -2.0, 0.5])
        found = compensation(inputs, dt, own)
    lag = t - np.array(found) / (1.0, -2.0, 0.5)
    assert lag == pytest.approx(1.0 / (pole * bandwidth), abs=2.0 * dt)


def test_what_modulation_gave_beyond_its_duties_is_filtered_with_the_pole_of_the_estimator():
    inputs, own = np.zeros(1, CONTROL_INPUTS)[0], np.zeros(1, THRUST_VECTOR)[0]
    inputs["disturbance_pole"], inputs["bandwidth"], inputs["modulation_torque"] = 1.5, 1.0, (3.0, -4.0, 5.0)
    for _ in range(40):
        found = compensation(inputs, DT, own)
    assert found == pytest.approx((1.0 - exp(-1.5 * 40 * DT)) * np.array([3.0, -4.0, 5.0]), rel=1e-12)
