"""The flow meters against their own error parameters; what flows is moved by hand."""

import numpy as np
import pytest
from instrument_bench import LOADED, Bench

H = 0.02
EXACT = dict.fromkeys(("scale_pct", "bias_pct", "noise_pct", "quantum_kg"), 0.0)
N = len(LOADED.scenario.vehicle.rcs.branches)
G0 = 9.80665


def meters(case=0, **others):
    """A bench with meters that are ideal but for what is given."""
    return Bench("flow_meters", EXACT | {"delay_cycles": 0} | others, case=case)


def counts(bench, cycles, flow=0.0):
    """What they have counted, shape (cycles, branches), while each branch carries ``flow`` (kg/s)."""
    rows = []
    for k in range(cycles):
        bench.plant["branch_used"][:N] = flow * k * H
        rows.append(bench.measure(t=k * H)["branch_used"][:N].copy())
    return np.array(rows)


def test_full_flow_is_that_of_all_thrusters_of_the_branch():
    full = meters().case["branches"]["full_flow"][:N]
    expected = [2 * 250.0 / (270.0 * G0)] * 4 + [2 * 250.0 / (285.0 * G0)] * 2
    expected += [2 * 250.0 / (270.0 * G0)] * 2 + [2 * 25.0 / (280.0 * G0)] * 3
    assert full == pytest.approx(expected, rel=1e-12)


def test_ideal_meters_count_what_flows():
    flow = np.linspace(0.0, 0.2, N)
    assert counts(meters(), 200, flow) == pytest.approx(np.outer(H * np.arange(200), flow), abs=1e-15)


def test_errors_of_the_copies_have_the_given_spread_and_differ_from_case_to_case():
    """Slopes of the count with and without flow."""
    scales, biases = [], []
    full, span = meters().case["branches"]["full_flow"][:N], 5 * H
    for case in range(60):
        open_, shut = (counts(meters(case, scale_pct=1.0, bias_pct=0.2), 6, flow)[-1] for flow in (full, 0.0))
        biases.append(shut / (full * span))
        scales.append((open_ - shut) / (full * span) - 1.0)
    for values, sigma in ((np.array(scales), 0.01), (np.array(biases), 0.002)):
        assert values.std() == pytest.approx(sigma, rel=5.0 / np.sqrt(2.0 * values.size))
        assert abs(values.mean()) < 5.0 * sigma / np.sqrt(values.size)
        assert len(set(values.ravel())) == values.size


def test_noise_of_the_flow_is_white_and_of_its_size_whatever_the_cycle():
    """A mean over 0.04 s scatters by 0.1 % / sqrt(0.04) = 0.5 % of the full flow."""
    for h in (0.02, 0.01):
        bench = meters(noise_pct=0.1)
        rows = bench.series(20_001, h, "branch_used")[:, :N]
        full, every = bench.case["branches"]["full_flow"][:N], round(0.04 / h)
        flow = np.diff(rows[::every], axis=0) / (0.04 * full)
        assert flow.std() == pytest.approx(0.005, rel=5.0 / np.sqrt(2.0 * flow.size))
        assert abs(flow.mean()) < 5.0 * 0.005 / np.sqrt(flow.size)
        unit = flow / flow.std(axis=0)
        correlation = unit.T @ unit / len(unit) - np.eye(N)
        assert np.abs(correlation).max() < 5.0 / np.sqrt(len(unit))
        assert np.abs((unit[1:] * unit[:-1]).mean(axis=0)).max() < 5.0 / np.sqrt(len(unit))


def test_count_comes_in_whole_quanta_and_loses_nothing():
    rows = counts(meters(quantum_kg=1e-4), 501, 0.0123)
    assert rows / 1e-4 == pytest.approx(np.round(rows / 1e-4), abs=1e-6)
    behind = 0.0123 * H * np.arange(501)[:, None] - rows
    assert behind.min() > -1e-12 and 0.5e-4 < behind.max() < 1e-4 * (1.0 + 1e-6)


@pytest.mark.parametrize(
    "delay", [pytest.param(0, marks=pytest.mark.long), pytest.param(1, marks=pytest.mark.long), 3]
)
@pytest.mark.parametrize("name", ["flow_meters", "imu"])
def test_count_arrives_some_cycles_late(name, delay):
    bench = meters(delay_cycles=delay) if name == "flow_meters" else Bench(name, {"delay_cycles": delay})
    seen = counts(bench, 20, 0.1)
    assert seen == pytest.approx(np.repeat([[0.1 * H * max(k - delay, 0)] for k in range(20)], N, axis=1))
