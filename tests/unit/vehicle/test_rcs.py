"""Thruster pulses against closed-form impulses and a fine numerical integration of the valve's differential
equation.

Thrust ramps up in ``rise`` and down in ``decay``.  A pulse of length T >= rise therefore delivers F (T -
rise/2 + decay/2), a trapezium; a shorter one reaches T/rise and delivers F T/rise (T + T decay/rise) / 2, a
triangle.  Their sum is the truth for any pulse train, however the time axis is cut into steps.
"""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.integrate import cumulative_trapezoid

from edl6dof.config.dtype import fill
from edl6dof.interface.capacities import MAX_BRANCHES
from edl6dof.vehicle.mass import Tank
from edl6dof.vehicle.plant import INPUTS, VALVES
from edl6dof.vehicle.propulsion.feed_system import FEEDS, fill_feeds
from edl6dof.vehicle.propulsion.rcs import RCS, RcsParams, Thruster, climb, efficiency, linear_level
from edl6dof.vehicle.propulsion.rcs import fire as fire_from_tanks

G0 = 9.80665
RISE, DECAY, THRUST, ISP = 0.012, 0.019, 25.0, 220.0
JET = {
    "group": "attitude",
    "specific_impulse_s": ISP,
    "minimum_pulse_s": 0.02,
    "rise_s": RISE,
    "decay_s": DECAY,
}


def jet(name="a", position=(-1.0, 1.2, 0.0), direction=(0.0, 0.0, 1.0), thrust=THRUST, **changes):
    return Thruster(name=name, position_m=position, direction=direction, thrust_n=thrust, **JET, **changes)


def thrusters(*jets, **interaction):
    rcs = np.zeros(1, RCS).view(np.recarray)[0]
    fill(rcs, RcsParams(thrusters=list(jets), **interaction))
    return rcs, np.zeros(1, VALVES).view(np.recarray)[0]


def fire(rcs, valves, t, step):
    """Mean wrench of the thrusters, and flow out of the one tank that feeds them, in a row of 7."""
    feeds, inputs = np.zeros(1, FEEDS)[0], np.zeros(1, INPUTS)[0]
    fill_feeds(feeds["thrusters"], [()] * rcs.n_thrusters, [Tank(name="main", mass_kg=9.0)])
    inputs["filled"][0] = 1
    own, used = np.arange(MAX_BRANCHES), np.zeros(MAX_BRANCHES)
    fire_from_tanks(rcs, feeds["thrusters"], own, valves, t, step, inputs, used)
    return (*inputs["rcs_force"].tolist(), *inputs["rcs_moment"].tolist(), float(inputs["rcs_flow"][0]))


def closed_form(length):
    """Integral of the thrust fraction of one pulse from rest, s."""
    if length >= RISE:
        return length + 0.5 * (DECAY - RISE)
    return 0.5 * (length / RISE) * (length + length / RISE * DECAY)


def flown(pulses, cuts):
    """Integral of the mean level over the steps between ``cuts``; the next command is given once the last
    valve has shut.
    """
    level, total, queue = 0.0, 0.0, list(pulses)
    opens, closes = queue.pop(0)
    for start, end in zip(cuts, cuts[1:], strict=False):
        mean, _, level = linear_level(level, RISE, DECAY, start, end - start, opens, closes)
        total += mean * (end - start)
        if end >= closes + DECAY and queue:
            opens, closes = queue.pop(0)
    return total, level


@pytest.mark.parametrize("length", [1e-6, 0.003, RISE - 1e-9, RISE, 0.0137, 0.02, 0.04, 0.128, 0.25])
@pytest.mark.parametrize("steps", [1, 2, 7, 20, 100, 1313])
def test_one_pulse_delivers_its_impulse_whatever_the_step(length, steps):
    total, level = flown([(0.0317, 0.0317 + length)], np.linspace(0.0, 0.4, steps + 1))
    assert total == pytest.approx(closed_form(length), rel=1e-12, abs=1e-17) and level == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_random_pulse_trains_deliver_the_sum_of_their_impulses_in_random_steps(seed):
    rng = np.random.default_rng(seed)
    opens = 0.11 + 0.2 * np.arange(60)
    pulses = [(t, t + length) for t, length in zip(opens, rng.uniform(0.001, 0.06, 60), strict=True)]
    expected = sum(closed_form(b - a) for a, b in pulses)
    answers = []
    for count in (300, 1500, 6000):
        cuts = np.unique(np.concatenate([[0.0, 13.0], rng.uniform(0.0, 13.0, count), opens - 0.05]))
        answers.append(flown(pulses, cuts)[0])
    assert answers == pytest.approx([expected] * 3, rel=1e-12)


def test_a_valve_reopened_while_thrust_decays_follows_its_differential_equation():
    """Fine Euler integration of dL/dt = 1/rise or -1/decay within [0, 1], 2e-7 s, against steps of 1 to 20
    ms.
    """
    schedule = [(0.010, 0.0485), (0.055, 0.060), (0.066, 0.110)]
    dt = 2e-7
    times = (np.arange(round(0.16 / dt)) + 0.5) * dt
    is_open = np.any([(a <= times) & (times < b) for a, b in schedule], axis=0)
    level = integral = 0.0
    profile = {}
    for k, valve in enumerate(is_open.tolist()):
        before = level
        level = min(level + dt / RISE, 1.0) if valve else max(level - dt / DECAY, 0.0)
        integral += 0.5 * (before + level) * dt
        if (k + 1) % 5000 == 0:
            profile[round((k + 1) * dt, 6)] = (level, integral)
    got = total = 0.0
    for k in range(160):
        start = k * 1e-3
        opens, closes = [p for p in schedule if p[0] <= start + 5e-4 or p is schedule[0]][-1]
        mean, _, got = linear_level(got, RISE, DECAY, start, 1e-3, opens, closes)
        total += mean * 1e-3
        expected = profile[round(start + 1e-3, 6)]
        assert (got, total) == pytest.approx(expected, abs=5e-5)
    assert total == pytest.approx(integral, abs=1e-6)


@pytest.mark.parametrize("length", [0.002, 0.008, 0.012])
def test_a_short_pulse_peaks_where_the_valve_shuts_and_never_above_full_thrust(length):
    levels = [linear_level(0.0, RISE, DECAY, 0.0, t, 0.0, length)[2] for t in np.linspace(1e-5, 0.05, 2000)]
    assert max(levels) == pytest.approx(length / RISE, abs=1e-3) and max(levels) <= 1.0 and min(levels) >= 0.0


@pytest.mark.parametrize(
    "level, duration, slope", [(0.3, 0.0, 5.0), (0.0, 1.0, -9.0), (1.0, 1.0, 9.0), (0.25, 0.05, 10.0)]
)
def test_climb_stops_at_nothing_and_at_full(level, duration, slope):
    times = np.linspace(0.0, duration, 20001)
    curve = np.clip(level + slope * times, 0.0, 1.0)
    first, second, end = climb(level, duration, slope)
    gathered = cumulative_trapezoid(curve, times, initial=0.0)
    assert first == pytest.approx(gathered[-1], abs=1e-8) and end == pytest.approx(curve[-1], abs=1e-12)
    assert second == pytest.approx(np.trapezoid(gathered, times), abs=1e-8)


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.long) for n in range(1, 3))])
def test_the_line_of_a_pulse_has_its_impulse_and_its_moment_in_time_wherever_it_lies(seed):
    """Against the ramps drawn out at a thousandth of the step: pulses that begin and end before, in and after
    a step of 20 ms, from any level.
    """
    rng, step = np.random.default_rng(seed), 0.02
    times = np.linspace(0.0, step, 20001)
    for _ in range(30):
        opens = rng.uniform(-0.02, step)
        closes, level, curve = opens + rng.uniform(0.0, 0.03), rng.uniform(), []
        start, change = level, times[1]
        for t in times:
            curve.append(level)
            valve = opens <= t < closes
            level = min(level + change / RISE, 1.0) if valve else max(level - change / DECAY, 0.0)
        mean, slope, end = linear_level(start, RISE, DECAY, 0.0, step, opens, closes)
        line = mean + slope * (times - 0.5 * step)
        assert np.trapezoid(line, times) == pytest.approx(np.trapezoid(curve, times), abs=1e-4 * step)
        moments = [np.trapezoid(kind * times, times) for kind in (line, np.array(curve))]
        assert moments[0] == pytest.approx(moments[1], abs=1e-4 * step**2)
        assert end == pytest.approx(curve[-1], abs=3e-4)


def run(rcs, valves, duration, step):
    """Time integrals of the wrench and the propellant used, fired from t = 0."""
    total = np.zeros(7)
    for k in range(round(duration / step)):
        total += np.array(fire(rcs, valves, k * step, step)) * step
    return total


@pytest.mark.parametrize("step", [0.002, 0.01, 0.02, 0.04])
def test_propellant_used_is_impulse_over_exhaust_speed(step):
    rcs, valves = thrusters(jet(), jet("b", thrust=250.0))
    valves.open_time[:2], valves.close_time[:2] = (0.013, 0.1), (0.077, 0.107)
    total = run(rcs, valves, 0.2, step)
    impulse = 25.0 * closed_form(0.064) + 250.0 * closed_form(0.007)
    assert total[2] == pytest.approx(impulse, rel=1e-12)
    assert total[6] == pytest.approx(impulse / (ISP * G0), rel=1e-12)
    assert valves["mean"][:2].tolist() == [0.0, 0.0]


def test_a_couple_turns_without_pushing():
    """Two jets of 25 N, 2.4 m apart, pushing in opposite directions: 60 N m, no force, wherever the origin
    is.
    """
    rcs, valves = thrusters(
        jet("left", (-1.0, -1.2, 0.3), (0.0, 0.0, -1.0)), jet("right", (-1.0, 1.2, 0.3), (0.0, 0.0, 1.0))
    )
    valves.level[:2], valves.open_time[:2], valves.close_time[:2] = 1.0, -1.0, 9.0
    assert fire(rcs, valves, 0.0, 0.01)[:6] == pytest.approx((0.0, 0.0, 0.0, 60.0, 0.0, 0.0), abs=1e-12)


def test_moment_of_an_oblique_jet_is_arm_cross_force():
    position, direction = (-1.7, 0.4, -0.9), (0.48, -0.6, 0.64)
    rcs, valves = thrusters(jet(position=position, direction=direction))
    valves.level[0], valves.open_time[0], valves.close_time[0] = 1.0, -1.0, 9.0
    wrench = fire(rcs, valves, 0.0, 0.01)
    assert wrench[:3] == pytest.approx(25.0 * np.array(direction), rel=1e-12)
    assert wrench[3:6] == pytest.approx(np.cross(position, 25.0 * np.array(direction)), rel=1e-12)


def test_the_flow_takes_thrust_up_to_the_reference_pressure():
    rcs, _ = thrusters(jet(), flow_loss=0.2, flow_loss_pressure_pa=4000.0)
    assert [efficiency(rcs, qbar) for qbar in (0.0, 2000.0, 4000.0, 40000.0)] == [1.0, 0.9, 0.8, 0.8]


def test_closed_valves_and_unused_slots_are_silent():
    rcs, valves = thrusters(jet())
    valves.open_time[1], valves.close_time[1], valves.level[1] = 0.0, 9.0, 1.0  # slot without a thruster
    assert fire(rcs, valves, 1.0, 0.01) == (0.0,) * 7


def test_twin_names_and_directions_without_unit_length_are_refused():
    with pytest.raises(ValidationError, match="given twice: a"):
        RcsParams(thrusters=[jet(), jet()])
    with pytest.raises(ValidationError, match="unit vector"):
        jet(direction=(0.0, 1.0, 1.0))


def test_thruster_that_gives_more_than_is_believed_draws_more_propellant_too():
    """The wrench of a thruster of 1.03 times the thrust is that of one with that nominal thrust."""
    wrenches = []
    for one in (jet(thrust_factor=1.03), jet(thrust=1.03 * THRUST), jet()):
        rcs, valves = thrusters(one)
        valves["open_time"][0], valves["close_time"][0] = 0.0, 0.05
        wrenches.append(np.array(fire(rcs, valves, 0.0, 0.1)))
    assert wrenches[0] == pytest.approx(wrenches[1], rel=1e-12)
    assert wrenches[0] == pytest.approx(1.03 * wrenches[2], rel=1e-12) and wrenches[2][6] > 0.0
