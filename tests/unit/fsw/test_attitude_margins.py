"""Margins of the attitude loops: closed forms, the compiled laws in simulation, and the figures in the
docstrings.
"""

from math import degrees, pi, radians, sqrt

import numpy as np
import pytest
from attitude_margins import Loop, flown_loops, margins

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.control import bank_to_steer, rate_damping, thrust_vector
from edl6dof.fsw.control.phase_plane_zones import AXIS, ZoneParams, follow
from edl6dof.fsw.estimation.first_order import FirstOrderParams, estimate
from edl6dof.fsw.estimation.registry import DISTURBANCE, MEASURED, unexplained_torque
from edl6dof.scenario.loading import load_scenario

FINE = {"cycle": 1e-4, "valve_lag": 0.0, "sensor_delay": 0.0}
INERTIA = 500.0


@pytest.fixture(scope="module")
def loops():
    return flown_loops(load_scenario("tianwen1").scenario)


def continuous(loop, w):
    """L(jw) of the PID law P + D s + I / s over a double integrator."""
    s = 1j * w
    return (loop.proportional + loop.derivative * s + loop.integral / s) / s**2


@pytest.mark.parametrize("gains", [(1.4, 0.0, 1.9), (2.5, 0.8, 2.8)])
def test_fast_sampling_gives_the_continuous_loop(gains):
    loop = Loop(*gains, **FINE)
    w = np.array([0.3, 1.0, 3.0, 10.0])
    assert loop.open_loop(w) == pytest.approx(continuous(loop, w), rel=2e-3)


def test_estimator_in_the_loop_is_the_pid_law_of_the_docstring():
    """P + lambda D, lambda P and D + lambda, as written in thrust_vector."""
    p, d, pole = 1.4, 1.9, 8.0
    w = np.array([0.3, 1.0, 3.0, 10.0])
    pid = Loop(p + pole * d, pole * p, d + pole)
    assert Loop(p, 0.0, d, pole, **FINE).open_loop(w) == pytest.approx(continuous(pid, w), rel=5e-3)


def test_phase_margin_of_a_slow_loop_is_the_closed_form_less_the_dead_time_of_hold_and_valve():
    p, d = 1.4, 1.9
    loop = Loop(p, 0.0, d)
    crossover = sqrt((d * d + sqrt(d**4 + 4.0 * p * p)) / 2.0)  # |P + D jw| = w^2
    own = margins(loop)
    assert own.crossover_rad_s == pytest.approx(crossover, rel=0.01)
    dead_time = loop.cycle / 2.0 + loop.valve_lag
    assert own.phase_deg == pytest.approx(
        degrees(np.arctan(d * crossover / p) - crossover * dead_time), abs=0.3
    )


def test_sampled_rate_feedback_alone_is_stable_up_to_two_over_the_cycle():
    """u = -D w, held without lag: w' = (1 - D T) w, stable for D T < 2."""
    loop = Loop(0.0, 0.0, 5.0, valve_lag=0.0)
    a, b, c = loop.matrices()
    rates = a[1:2, 1:2] + b[1] * c[1]
    assert rates[0, 0] == pytest.approx(1.0 - 5.0 * 0.04)
    for gain, stable in ((9.9, True), (10.1, False)):
        assert (abs(1.0 + gain * b[1] * c[1]) < 1.0) == stable


def simulate(loop, push, cycles):
    """Inputs of the plant under the compiled laws: ``push`` (per cycle) is added to the commanded
    acceleration.
    """
    zone, settings = np.zeros(1, dtype_of(ZoneParams))[0], np.zeros(1, dtype_of(FirstOrderParams))[0]
    gains = {"proportional": loop.proportional, "integral": loop.integral, "derivative": loop.derivative}
    fill(zone, ZoneParams(near_deg=179.0, far_deg=180.0, rate_deg_s=60.0, integral_limit_deg_s2=1e6, **gains))
    fill(settings, FirstOrderParams(torque_pole_rad_s=max(loop.pole, 1e-6)))
    axis, out, measured = np.zeros(1, AXIS)[0], np.zeros(1, DISTURBANCE)[0], np.zeros(1, MEASURED)[0]
    cycle, lag, delay = loop.cycle, loop.valve_lag, loop.sensor_delay
    angle = rate = applied = last = before = 0.0
    sample = (0.0, 0.0, 0.0)
    history = []
    for k in range(cycles):
        expected = INERTIA * ((delay + lag) * before + (cycle - delay - lag) * last) / cycle
        seen = (rate - delay * applied, 0.0, 0.0)
        if k > 0:
            inertia = (INERTIA,) * 3 + (0.0,) * 3
            unexplained = unexplained_torque(inertia, seen, sample, (expected, 0.0, 0.0), cycle)
            measured["unexplained"][3:] = unexplained
            estimate(settings, measured, cycle, None, out)
        sample = seen
        found = out["torque"][0] / INERTIA if loop.pole else 0.0
        command = follow(zone, axis, -angle, rate, cycle, False) - found
        entering = command + push[k]
        history.append((entering, command))
        angle += rate * cycle + applied * lag * (cycle - lag / 2.0) + entering * (cycle - lag) ** 2 / 2.0
        rate += applied * lag + entering * (cycle - lag)
        applied, before, last = entering, last, command
    return np.array(history).T


@pytest.mark.parametrize("name", ["bank", "parachute roll", "lander pitch and yaw"])
def test_compiled_laws_have_the_loop_gain_of_the_linear_model(loops, name):
    """A sine of acceleration pushes the closed loop; command over input of the plant is minus the open
    loop.
    """
    loop = loops[name]
    for cycles_per_turn in (20, 50, 125):
        turns = 4000 // cycles_per_turn
        w = 2.0 * pi / (cycles_per_turn * loop.cycle)
        k = np.arange(turns * cycles_per_turn)
        entering, command = simulate(loop, radians(0.02) * np.sin(w * loop.cycle * k), len(k))
        late = slice(len(k) // 2 - (len(k) // 2) % cycles_per_turn, None)
        phasor = np.exp(-1j * w * loop.cycle * k[late])
        measured = -np.sum(command[late] * phasor) / np.sum(entering[late] * phasor)
        assert measured == pytest.approx(loop.open_loop(np.array([w]))[0], rel=0.02)


@pytest.mark.parametrize("zone", ["bank_to_steer.bank", "thrust_vector.roll"])
def test_pid_zone_follows_a_sine_with_its_analytic_bandwidth(onboard_control, zone):
    """Rate feedback, angle command: P / (s^2 + D s + P), 3 dB down at wn sqrt(1 - 2 z^2 + sqrt(2 - 4 z^2 + 4
    z^4)).
    """
    controller, channel = zone.split(".")
    record = onboard_control[controller][channel]
    natural = sqrt(record["proportional"])
    z = record["derivative"] / (2.0 * natural)
    w = natural * sqrt(1.0 - 2.0 * z * z + sqrt(2.0 - 4.0 * z * z + 4.0 * z**4))
    axis, dt = np.zeros(1, AXIS)[0], 0.01
    angle = rate = 0.0
    answer, asked = [], []
    for k in range(int(60.0 / dt)):
        command = radians(1.0) * np.sin(w * k * dt)
        a = follow(record, axis, command - angle, rate, dt, True)
        angle += rate * dt + 0.5 * a * dt * dt
        rate += a * dt
        answer.append(angle), asked.append(command)
    late = slice(int(30.0 / dt), None)
    assert np.ptp(answer[late]) / np.ptp(asked[late]) == pytest.approx(sqrt(0.5), rel=0.03)


@pytest.fixture(scope="module")
def onboard_control():
    from edl6dof.scenario.records import build_onboard

    scenario = load_scenario("tianwen1").scenario
    return build_onboard(scenario)[0]["control"]


def test_every_flown_loop_keeps_textbook_margins(loops):
    for name, loop in loops.items():
        own = margins(loop)
        assert loop.is_stable(), name
        assert own.phase_deg > 45.0, name
        assert own.gain_db > 10.0 and own.gain_down_db < -10.0, name
        assert own.delay_s > 2.0 * loop.cycle, name


@pytest.mark.parametrize(
    ("module", "name"),
    [(bank_to_steer, "bank"), (rate_damping, "parachute roll"), (thrust_vector, "lander pitch and yaw")],
)
def test_docstrings_give_the_margins_of_the_flown_gains(loops, module, name):
    own = margins(loops[name])
    text = " ".join(module.__doc__.split())
    down = f"{-own.gain_down_db:.0f} dB down" if own.gain_down_db > -59.0 else "any gain down"
    assert (
        f"crossover {own.crossover_rad_s:.1f} rad/s, phase margin {own.phase_deg:.0f} deg, gain margin "
        f"{own.gain_db:.0f} dB up and {down}"
    ) in text
