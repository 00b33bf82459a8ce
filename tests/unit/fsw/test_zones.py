"""Four-zone control of one axis, closed around a double integrator."""

from math import cos, degrees, exp, radians, sin, sqrt

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.control.phase_plane_zones import (
    AXIS,
    CONSTANT,
    LIMITER,
    PARABOLA,
    PID,
    ZoneParams,
    follow,
    target_rate,
)

DT = 0.04


def zone_record(**changes):
    record = np.zeros(1, dtype_of(ZoneParams))
    fill(record[0], ZoneParams(**changes))
    return record[0]


def flown_zones(onboard):
    control = onboard[0]["control"]
    return {
        "bank": control["bank_to_steer"]["bank"],
        "chute roll": control["rate_damping"]["roll"],
        "pitch and yaw": control["thrust_vector"]["pitch_yaw"],
        "lander roll": control["thrust_vector"]["roll"],
        "default": zone_record(),
    }


def slew(zone, angle, duration, dt=DT, rate=0.0, disturbance=0.0, saturated=False):
    """Histories of time, error and rate; the acceleration is constant over a control cycle, so the step is
    exact.
    """
    memory = np.zeros(1, AXIS)[0]
    error, history = angle, []
    for k in range(int(duration / dt)):
        history.append((k * dt, error, rate, memory["zone"]))
        a = follow(zone, memory, error, rate, dt, saturated) + disturbance
        error -= rate * dt + 0.5 * a * dt * dt
        rate += a * dt
    return np.array(history).T


BANK = {"rate_deg_s": 20.0, "far_deg": 40.0, "near_deg": 5.0, "deceleration_deg_s2": 9.0}


def predicted_slew(zone, angle):
    """Time until the error enters the PID zone.

    Constant rate, then constant deceleration down the parabola to the rate at which the PID law meets the
    boundary. The rate loop lags by 1/rate_gain on both slopes: lost at spin-up, won back at slowing down.
    """
    inner = zone["proportional"] / zone["derivative"] * zone["near"]
    start = zone["near"] + (zone["rate"] ** 2 - inner**2) / (2.0 * zone["deceleration"])
    return (angle - start) / zone["rate"] + (zone["rate"] - inner) / zone["deceleration"]


@pytest.mark.parametrize("angle", [90.0, 120.0, -120.0, 170.0])
@pytest.mark.parametrize("name", ["flown", "textbook"])
def test_slew_time_of_a_large_manoeuvre_is_the_rate_limited_prediction(onboard, name, angle):
    zone = flown_zones(onboard)["bank"] if name == "flown" else zone_record(**BANK)
    t, error, _, _ = slew(zone, radians(angle), 30.0)
    arrived = t[np.argmax(np.abs(error) < zone["near"])]
    assert arrived == pytest.approx(predicted_slew(zone, radians(abs(angle))), abs=0.15)
    assert arrived > (radians(abs(angle)) - zone["near"]) / zone["rate"]  # no faster than the limit allows


@pytest.mark.parametrize("name", ["bank", "chute roll", "pitch and yaw", "lander roll", "default"])
def test_large_slew_overshoots_by_less_than_1_percent_and_a_fifth_of_the_inner_zone_never_exceeds_the_rate(
    onboard, name
):
    zone = flown_zones(onboard)[name]
    angle = radians(120.0)
    t, error, rate, _ = slew(zone, angle, 30.0 + 1.5 * angle / zone["rate"])
    assert np.min(error) > -min(0.2 * zone["near"], 0.01 * angle)
    assert np.max(np.abs(rate)) <= zone["rate"] * (1.0 + 1e-9)
    assert abs(error[-1]) < 0.02 * zone["near"]
    assert np.all(np.diff(error[: np.argmax(np.abs(error) < zone["near"])]) <= 1e-12)  # always on its way


@pytest.mark.parametrize("name", ["bank", "chute roll", "pitch and yaw", "lander roll", "default"])
def test_target_rate_is_continuous_over_zone_boundaries_and_odd(onboard, name):
    zone = flown_zones(onboard)[name]
    grid = np.linspace(zone["near"], 1.5 * zone["far"], 4001)
    rate = np.array([target_rate(zone, e, 1.0) for e in grid])
    step = grid[1] - grid[0]
    inner = zone["proportional"] / zone["derivative"] * zone["near"]
    steepest = zone["deceleration"] / min(inner, zone["rate"])  # d rate / d error = deceleration / rate
    assert np.max(np.abs(np.diff(rate))) <= 1.01 * steepest * step
    assert rate[0] == pytest.approx(min(inner, zone["rate"]))
    assert rate[-1] == pytest.approx(zone["rate"])
    assert np.all(np.diff(rate) >= -1e-12)
    assert [target_rate(zone, -e, 1.0) for e in grid[::400]] == pytest.approx(list(-rate[::400]))


def test_demand_is_continuous_into_the_pid_zone_on_the_parabola(onboard):
    """On the commanded rate, the demand just outside the boundary and just inside it are both zero (the
    integral left aside).
    """
    for zone in flown_zones(onboard).values():
        memory = np.zeros(1, AXIS)[0]
        wanted = target_rate(zone, zone["near"] * (1.0 + 1e-9), 1.0)
        if wanted >= zone["rate"]:
            continue
        outside = follow(zone, memory, zone["near"] * (1.0 + 1e-9), wanted, DT, False)
        inside = follow(zone, memory, zone["near"] * (1.0 - 1e-9), wanted, DT, True)
        assert outside == pytest.approx(0.0, abs=1e-9)
        assert inside == pytest.approx(0.0, abs=1e-6 * zone["proportional"])


def test_parabola_is_a_constant_deceleration():
    zone = zone_record(**BANK)
    e = np.linspace(radians(8.0), radians(20.0), 400)
    w = np.array([target_rate(zone, x, 1.0) for x in e])
    assert np.gradient(0.5 * w**2, e)[5:-5] == pytest.approx(radians(9.0), rel=1e-3)


def second_order(zone, start, t):
    natural = sqrt(zone["proportional"])
    damping = zone["derivative"] / (2.0 * natural)
    assert damping < 1.0
    damped = natural * sqrt(1.0 - damping**2)
    return (
        start * exp(-damping * natural * t) * (cos(damped * t) + damping * natural / damped * sin(damped * t))
    )


@pytest.mark.parametrize("proportional, derivative", [(1.4, 1.9), (4.0, 1.2), (0.5, 0.7)])
def test_inner_zone_is_the_analytic_second_order_response(proportional, derivative):
    """Released at rest inside the PID zone: natural frequency sqrt(P), damping ratio D / (2 sqrt(P))."""
    zone = zone_record(proportional=proportional, derivative=derivative, near_deg=3.0, rate_deg_s=20.0)
    start = radians(2.0)
    t, error, _, where = slew(zone, start, 10.0, dt=0.002)
    wanted = np.array([second_order(zone, start, x) for x in t])
    assert np.max(np.abs(error - wanted)) < 0.004 * start
    assert np.all(where[1:] == PID)


def test_inner_zone_of_the_flown_gains_is_well_damped_at_the_control_rate(onboard):
    for name, zone in flown_zones(onboard).items():
        damping = zone["derivative"] / (2.0 * sqrt(zone["proportional"]))
        assert 0.6 < damping < 1.3, name
        start = 0.5 * min(zone["near"], zone["rate"] * zone["derivative"] / zone["proportional"])
        _, error, _, _ = slew(zone, start, 15.0, saturated=True)  # the integral left aside
        assert np.min(error) > -0.06 * start, name
        assert abs(error[-1]) < 0.01 * start, name


def test_integral_removes_the_error_of_a_constant_disturbance_and_proportional_control_leaves_it():
    push = radians(1.0)
    without = zone_record(near_deg=5.0, rate_deg_s=20.0)
    with_integral = zone_record(near_deg=5.0, rate_deg_s=20.0, integral=0.5)
    _, error, _, _ = slew(without, 0.0, 40.0, disturbance=push)
    assert error[-1] == pytest.approx(-push / without["proportional"], rel=1e-3)  # static balance P e = -d
    _, error, _, _ = slew(with_integral, 0.0, 60.0, disturbance=push)
    assert abs(degrees(error[-1])) < 1e-3


def test_integral_stands_still_while_saturated_and_is_limited():
    zone = zone_record(near_deg=5.0, integral=0.5, integral_limit_deg_s2=2.0)
    memory = np.zeros(1, AXIS)[0]
    for _ in range(100):
        follow(zone, memory, radians(2.0), 0.0, DT, True)
    assert memory["integral"] == 0.0
    for _ in range(10000):
        follow(zone, memory, radians(2.0), 0.0, DT, False)
    assert 0.5 * memory["integral"] == pytest.approx(radians(2.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("angle", [0.0, 4.0, 90.0, -90.0])
def test_rate_beyond_the_limit_is_brought_down_whatever_the_angle(sign, angle):
    zone = zone_record(**BANK)
    memory = np.zeros(1, AXIS)[0]
    rate = sign * radians(35.0)
    a = follow(zone, memory, radians(angle), rate, DT, False)
    assert memory["zone"] == LIMITER
    assert a * rate < 0.0
    _, _, history, _ = slew(zone, radians(angle), 5.0, rate=rate)
    assert np.max(np.abs(history)) <= abs(rate)
    assert abs(history[75]) < 1.16 * zone["rate"]


def test_zones_are_passed_in_order_from_far_to_near():
    zone = zone_record(**BANK)
    _, _, _, where = slew(zone, radians(120.0), 20.0)
    passed = [int(w) for i, w in enumerate(where[1:]) if i == 0 or w != where[i]]
    assert passed == [CONSTANT, PARABOLA, PID]


@pytest.mark.parametrize("name", ["bank", "lander roll"])
def test_pid_zone_follows_a_sine_with_its_analytic_bandwidth(onboard, name):
    """Rate feedback, angle command: P / (s^2 + D s + P), 3 dB down at wn sqrt(1 - 2 z^2 + sqrt(2 - 4 z^2 + 4
    z^4)).
    """
    zone = flown_zones(onboard)[name]
    natural = sqrt(zone["proportional"])
    z = zone["derivative"] / (2.0 * natural)
    w = natural * sqrt(1.0 - 2.0 * z * z + sqrt(2.0 - 4.0 * z * z + 4.0 * z**4))
    axis, dt = np.zeros(1, AXIS)[0], 0.01
    angle = rate = 0.0
    answer, asked = [], []
    for k in range(int(60.0 / dt)):
        command = radians(1.0) * sin(w * k * dt)
        a = follow(zone, axis, command - angle, rate, dt, True)
        angle += rate * dt + 0.5 * a * dt * dt
        rate += a * dt
        answer.append(angle), asked.append(command)
    late = slice(int(30.0 / dt), None)
    assert np.ptp(answer[late]) / np.ptp(asked[late]) == pytest.approx(sqrt(0.5), rel=0.03)
