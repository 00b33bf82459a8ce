"""Pulse modulation: impulse is conserved, pulses keep the minimum length, small demands are left alone."""

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.modulation import MODULATION, ModulationParams, modulate
from edl6dof.fsw.onboard import ONBOARD

CYCLE = 0.04


@pytest.fixture
def jets(shared_onboard):
    """Slots 0..3: 40 ms; 4..7: 128 ms."""
    thrusters = shared_onboard[0]["vehicle"]["thrusters"].copy()
    thrusters["minimum_pulse"][:4] = 0.040
    thrusters["minimum_pulse"][4:8] = 0.128
    return thrusters


def settings(deadband=0.03):
    record = np.zeros(1, dtype_of(ModulationParams))
    fill(record[0], ModulationParams(deadband=deadband))
    return record[0]


def operate(thrusters, duties, cycle=CYCLE, p=None, start=0.0):
    """On-time in each cycle, shape like ``duties`` (cycles, 8), and the pulses of each thruster as merged
    (open, close).
    """
    p = settings() if p is None else p
    memory = np.zeros(1, MODULATION)[0]
    opens, closes = np.zeros(32), np.zeros(32)
    on, pulses = np.zeros_like(duties), [[] for _ in range(8)]
    padded, vehicle = np.zeros(32), np.zeros(1, ONBOARD["vehicle"])[0]
    vehicle["thrusters"], vehicle["n_thrusters"] = thrusters, 8
    for k, row in enumerate(duties):
        t = start + k * cycle
        padded[:8] = row
        modulate(p, vehicle, padded, t, cycle, memory, opens, closes)
        assert np.all(opens[:8] >= t - 1e-12)
        assert np.all(closes[:8] <= t + cycle + 1e-9)
        on[k] = closes[:8] - opens[:8]
        for i in range(8):
            if on[k, i] > 0.0:
                if pulses[i] and abs(pulses[i][-1][1] - opens[i]) < 1e-9:
                    pulses[i][-1][1] = closes[i]
                else:
                    pulses[i].append([opens[i], closes[i]])
    return on, pulses


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
    duties[::2] = 0.9
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
    duties[:4, 4] = 1.0  # 0.16 s due by the fourth cycle: opens there
    on, pulses = operate(jets, duties)
    assert pulses[4][0][0] == pytest.approx(0.12)
    assert pulses[4][0][1] - pulses[4][0][0] == pytest.approx(0.128)
    assert np.sum(on[7:, 4]) == 0.0
