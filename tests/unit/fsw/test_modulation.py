"""Pulse modulation: impulse is conserved, widths follow the duty, pulses and gaps keep their least length,
small demands are left alone; against the law of steady duties, and a modulator written anew in ticks.
"""

import itertools

import numpy as np
import pytest
from numba import njit

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.modulation import MODULATION, ModulationParams, modulate
from edl6dof.fsw.onboard import ONBOARD
from edl6dof.vehicle.propulsion.rcs import linear_level

CYCLE, GAP = 0.04, 0.012


@pytest.fixture
def jets(shared_onboard):
    """Slots 0..3: 40 ms; 4..7: 128 ms."""
    thrusters = shared_onboard[0]["vehicle"]["thrusters"].copy()
    thrusters["minimum_pulse"][:4] = 0.040
    thrusters["minimum_pulse"][4:8] = 0.128
    return thrusters


def settings(**changes):
    record = np.zeros(1, dtype_of(ModulationParams))
    fill(record[0], ModulationParams(shortest_gap_s=GAP, **changes))
    return record[0]


def operate(thrusters, duties, cycle=CYCLE, p=None, start=0.0):
    """On-time in each cycle, shape like ``duties`` (cycles, 8), and the pulses of each thruster as merged
    (open, close).
    """
    p = settings() if p is None else p
    vehicle, padded = np.zeros(1, ONBOARD["vehicle"]), np.zeros((len(duties), 32))
    vehicle["thrusters"], vehicle["n_thrusters"] = thrusters, 8
    padded[:, :8] = duties
    t, memory = start + np.arange(len(duties)) * cycle, np.zeros(1, MODULATION)
    opens, closes = np.zeros_like(padded), np.zeros_like(padded)
    modulate_each(np.asarray(p).reshape(1), vehicle, padded, t, cycle, memory, opens, closes)
    opens, closes = opens[:, :8], closes[:, :8]
    assert np.all(opens >= t[:, None] - 1e-12)
    assert np.all(closes <= t[:, None] + cycle + 1e-9)
    on = closes - opens
    return on, [merged(opens[open_, i], closes[open_, i]) for i, open_ in enumerate(on.T > 0.0)]


@njit
def modulate_each(p, vehicle, duties, t, cycle, memory, opens, closes):
    """All cycles, compiled: most of the time of a call from Python goes into its records."""
    for k in range(len(duties)):
        modulate(p[0], vehicle[0], duties[k], t[k], cycle, memory[0])
        for i in range(opens.shape[1]):
            opens[k, i], closes[k, i] = memory[0].open_time[i], memory[0].close_time[i]


def merged(opens, closes):
    """Pulses of what opens when it closes."""
    apart = np.abs(opens[1:] - closes[:-1]) >= 1e-9
    return (
        np.column_stack([opens[np.append(True, apart)], closes[np.append(apart, True)]]).tolist()
        if len(opens)
        else []
    )


@pytest.mark.parametrize("cycle", [0.02, 0.04, 0.05, 0.1])
def test_total_on_time_follows_randomly_varying_duty_within_one_minimum_pulse_and_one_cycle(jets, cycle):
    rng = np.random.default_rng(1)
    duties = rng.uniform(0.04, 1.0, (2500, 8)) * rng.uniform(0.1, 1.0, 8)
    duties = np.maximum(duties, 0.04)
    on, _ = operate(jets, duties, cycle)
    residual = np.cumsum(duties * cycle - on, axis=0)
    bound = jets["minimum_pulse"][:8] + cycle
    assert np.all(np.abs(residual) <= bound + 1e-9)
    assert np.mean(on, axis=0) / cycle == pytest.approx(
        np.mean(duties, axis=0), abs=2.0 * bound.max() / (2500 * cycle)
    )


def test_constant_duty_gives_the_same_mean_duty(jets):
    duty = np.array([0.05, 0.31, 0.62, 0.97, 0.05, 0.31, 0.62, 0.97])
    on, _ = operate(jets, np.tile(duty, (4000, 1)))
    assert np.sum(on, axis=0) / (4000 * CYCLE) == pytest.approx(duty, abs=(0.128 + CYCLE) / (4000 * CYCLE))


@pytest.mark.parametrize("cycle", [0.02, 0.04, 0.1])
def test_no_pulse_is_shorter_than_the_minimum_even_when_demand_vanishes_mid_pulse(jets, cycle):
    rng = np.random.default_rng(2)
    wanted = np.repeat(rng.random((300, 8)) < 0.6, 10, axis=0)  # comes and goes in blocks of ten cycles
    duties = rng.uniform(0.3, 1.0, (3000, 8)) * wanted
    _, pulses = operate(jets, duties, cycle, start=123.4)
    end = 123.4 + 3000 * cycle
    for i in range(8):
        assert len(pulses[i]) > 20
        for opened, closed in pulses[i]:
            if closed < end - 1e-6:
                assert closed - opened >= jets["minimum_pulse"][i] - 1e-7, i


def test_duty_inside_the_deadband_never_opens_a_valve_and_just_outside_does(jets):
    on, _ = operate(jets, np.full((2000, 8), 0.029))
    assert np.sum(on) == 0.0
    on, _ = operate(jets, np.full((2000, 8), 0.031))
    assert np.all(np.sum(on, axis=0) > 0.0)


def test_residual_is_dropped_when_the_thruster_is_no_longer_asked_for(jets):
    """Alternating half-pulse demands with a pause between must not add up to a pulse in the pause."""
    duties = np.zeros((300, 8))
    duties[::2] = 0.6  # 24 ms due, and a valve opens at 26 ms
    on, _ = operate(jets, duties)
    assert np.all(on[1::2] == 0.0)


def test_full_duty_keeps_the_valve_open_without_gap(jets):
    on, pulses = operate(jets, np.ones((200, 8)))
    for i in range(8):
        assert len(pulses[i]) == 1
        assert pulses[i][0][0] <= jets["minimum_pulse"][i]  # starts once the minimum pulse is due
        assert pulses[i][0][1] == pytest.approx(200 * CYCLE)


def test_128_ms_pulse_spans_control_cycles(jets):
    duties = np.full((400, 8), 0.2)
    on, pulses = operate(jets, duties)
    lengths = np.array([closed - opened for opened, closed in pulses[5]])
    assert np.all(lengths > 3 * CYCLE)
    assert np.all(lengths <= 0.128 + 0.2 * 4 * CYCLE + CYCLE)
    assert np.sum(lengths) == pytest.approx(400 * CYCLE * 0.2, abs=0.128 + CYCLE)


def test_pulse_started_goes_on_when_demand_stops_after_one_cycle(jets):
    duties = np.zeros((12, 8))
    duties[:3, 4] = 1.0  # 0.12 s due by the third cycle, more than 0.65 of 0.128 s: opens there
    on, pulses = operate(jets, duties)
    assert pulses[4][0][0] == pytest.approx(0.08)
    assert pulses[4][0][1] - pulses[4][0][0] == pytest.approx(0.128)
    assert np.sum(on[6:, 4]) == 0.0


@pytest.mark.parametrize("share", [0.5, 0.65, 1.0])
def test_steady_duty_gives_the_widths_of_the_law_and_the_mean_of_the_duty(jets, share):
    """Width w max(1, h / (1 - d)), every width / d, where cycles are short beside pulses and gaps."""
    cycle, p = 0.0005, settings(opening_share=share)
    for duty, seconds in ((0.05, 20.0), (0.2, 5.0), (0.4, 5.0), (0.6, 5.0), (0.7, 5.0)):
        _, pulses = operate(jets, np.full((round(seconds / cycle), 8), duty), cycle, p)
        for i in (0, 4):
            opens, closes = np.array(pulses[i][1:-1]).T
            assert len(opens) >= 3
            width = jets["minimum_pulse"][i] * max(1.0, share / (1.0 - duty))
            assert closes - opens == pytest.approx(width, abs=2.0 * cycle / (1.0 - duty))
            assert np.diff(opens) == pytest.approx(width / duty, abs=2.0 * cycle / (1.0 - duty) / duty)


@pytest.mark.parametrize("duty", [0.3, 0.5, 0.6, 0.7, 0.9])
def test_control_cycle_of_one_minimum_pulse_gives_pulses_of_other_widths(jets, duty):
    """With the cycle of the flight as with any other: 250 N thrusters know more than 0 and 40 ms."""
    _, pulses = operate(jets, np.full((2000, 8), duty))
    opens, closes = np.array(pulses[0][1:-1]).T
    whole_cycles = (closes - opens) / CYCLE
    assert np.all(whole_cycles > 1.0 + 1e-3)
    assert np.mean(np.abs(whole_cycles - np.round(whole_cycles)) > 0.05) > 0.2


def ticking(duties, shortest, p, cycle, ticks=40):
    """One thruster, tick by tick (a ``ticks``-th of a cycle): shape (cycles,), s of open valve in each."""
    tick = cycle / ticks
    due, is_open, since, on = 0.0, False, 0.0, np.zeros(len(duties))
    for k, duty in enumerate(duties):
        asked = 0.0 if duty <= p["deadband"] else 1.0 if duty > 1.0 - p["deadband"] else duty
        due = due + asked * cycle if asked else 0.0
        if not is_open and due >= p["opening_share"] * shortest - 1e-9:
            is_open, since = True, 0.0
        for j in range(ticks):
            must_go_on = since < shortest - 1e-9
            too_late_to_close = 0 < (ticks - j) * tick < p["shortest_gap"] - 1e-9
            is_open = is_open and (due > 1e-9 or must_go_on or too_late_to_close)
            if is_open:
                due, since, on[k] = due - tick, since + tick, on[k] + tick
        due = max(due, -shortest)
    return on


@pytest.mark.parametrize(("slot", "shortest"), [pytest.param(0, 0.040, marks=pytest.mark.long), (4, 0.128)])
def test_same_valve_as_a_modulator_that_counts_ticks(jets, slot, shortest):
    rng, p = np.random.default_rng(3), settings()
    duties = np.zeros((3000, 8))
    # whole ticks of a millisecond, so that both close at the same time
    duties[:, slot] = np.repeat(rng.integers(0, 41, 600) / 40.0, 5)
    on, _ = operate(jets, duties, p=p)
    assert on[:, slot] == pytest.approx(ticking(duties[:, slot], shortest, p, CYCLE), abs=1e-9)


@pytest.mark.parametrize("slot", [0, 4])
def test_delivered_impulse_is_linear_in_the_duty_with_deadband_and_saturation(jets, slot):
    """Through the valve, whose thrust rises and decays: the law of Hu et al. 2022, section 4.2."""
    cycles, deadband, lag = 4000, 0.03, 0.012
    for duty in (0.0, 0.02, 0.031, 0.1, 0.35, 0.5, 0.65, 0.8, 0.9, 0.96, 0.98, 1.0):
        duties = np.zeros((cycles, 8))
        duties[:, slot] = duty
        _, pulses = operate(jets, duties)
        impulse, level = 0.0, 0.0
        edges = [0.0, *np.ravel(pulses[slot]).tolist(), cycles * CYCLE]
        for number, (begin, end) in enumerate(itertools.pairwise(edges)):
            if end > begin:
                opens, closes = (begin, end) if number % 2 else (end, end)
                mean, _, level = linear_level(level, lag, lag, begin, end - begin, opens, closes)
                impulse += mean * (end - begin)
        expected = 0.0 if duty <= deadband else 1.0 if duty > 1.0 - deadband else duty
        assert impulse / (cycles * CYCLE) == pytest.approx(expected, abs=2e-3), duty


def test_valve_never_closes_for_so_short_a_time_that_thrust_would_not_end(jets):
    rng = np.random.default_rng(4)
    _, pulses = operate(jets, rng.uniform(0.3, 0.999, (4000, 8)))
    for i in range(8):
        edges = np.array(pulses[i])
        assert len(edges) > 50 and np.all(edges[1:, 0] - edges[:-1, 1] >= GAP - 1e-9)


def test_of_what_a_valve_gave_too_much_no_more_than_a_shortest_pulse_is_kept(jets):
    """A gap of 18 ms keeps a valve open for all of a 20 ms cycle; 4 ms are due in each.

    Due at the start of the cycles: 4 (opens), -5 + 4, 3, 7 (opens), -5 + 4, ...: every third cycle.
    """
    jets["minimum_pulse"], p = 0.005, settings()
    p["shortest_gap"] = 0.018
    on, _ = operate(jets, np.full((12, 8), 0.2), 0.02, p)
    assert on[:, 0] == pytest.approx(np.tile([0.02, 0.0, 0.0], 4))
