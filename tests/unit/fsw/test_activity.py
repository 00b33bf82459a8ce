"""Share of a measured cycle in which each thruster should have given thrust, against sampling in time; and
the measured wrench.
"""

import numpy as np
import pytest
from thruster_bench import expect, modulate, remember

from edl6dof.fsw.onboard import FSW
from edl6dof.interface.effectors import BRANCHES
from edl6dof.interface.sensed import SENSED
from edl6dof.sensors.imu import READINGS, ImuParams, measure
from edl6dof.vehicle.plant import OUTPUTS, RATE, STATE
from edl6dof.vehicle.propulsion.rcs import linear_level

CYCLE = 0.04


@pytest.mark.parametrize(("delay", "lag"), [(0.0, 0.0), (0.02, 0.0), (0.02, 0.006), (0.04, 0.02)])
def test_share_is_the_time_open_within_the_measured_cycle(delay, lag):
    rng = np.random.default_rng(1)
    fsw, effect, history = np.zeros(1, FSW), rng.normal(size=(32, 6)) * 200.0, []
    memory, fsw["effectiveness"]["matrix"] = fsw["estimation"]["activity"][0], effect
    for k in range(30):
        t = k * CYCLE
        if k > 0:
            expect(5, t - delay - CYCLE, t - delay, lag, fsw)
            inside = t - delay - CYCLE + CYCLE * (np.arange(4000) + 0.5) / 4000
            begun, ended = np.moveaxis(history, -1, 0)[..., None] + lag
            sampled = np.mean(np.any((begun <= inside) & (inside < ended), axis=0), axis=-1)
            assert memory["share"][:5] == pytest.approx(sampled, abs=1e-3)
            assert memory["wrench"] == pytest.approx(memory["share"][:5] @ effect[:5], abs=1e-9)
        opens = t + rng.uniform(0.0, 0.02, 5)
        closes = np.minimum(opens + rng.choice([0.0, 0.01, 0.02], 5), t + CYCLE)
        history.append(list(zip(opens, closes, strict=True)))
        fsw["modulation"]["open_time"][0, :5], fsw["modulation"]["close_time"][0, :5] = opens, closes
        remember(5, fsw)


@pytest.mark.parametrize("slot", [0, 16])
def test_share_is_what_the_valve_gives_of_pulses_that_go_on_over_several_cycles(shared_onboard, slot):
    """Thrust rises and decays in 12 ms, for which half of it stands as lag: 1.5 ms where a cycle ends in a
    ramp, nothing in the sum.
    """
    rng, onboard, ramp, delay = np.random.default_rng(5), shared_onboard, 0.012, 0.02
    fsw, params, vehicle = np.zeros(1, FSW), onboard["modulation"], onboard[0]["vehicle"]
    memory, duty = fsw["estimation"]["activity"][0], fsw["allocation"]["duty"][0]
    opens, closes = (fsw["modulation"][name][0] for name in ("open_time", "close_time"))
    fsw["effectiveness"]["matrix"] = 1.0
    level, halves, shares = 0.0, [0.0], []
    for k in range(3000):
        t = k * CYCLE
        expect(22, t - delay - CYCLE, t - delay, 0.5 * ramp, fsw)
        shares.append(memory["share"][slot])
        duty[slot] = rng.uniform(0.0, 1.0) if k % 10 == 0 else duty[slot]
        modulate(params, vehicle, t, CYCLE, fsw)
        remember(22, fsw)
        for half in (t, t + delay):
            mean, _, level = linear_level(level, ramp, ramp, half, delay, opens[slot], closes[slot])
            halves.append(mean)
    given = 0.5 * (np.array(halves[0:-2:2]) + np.array(halves[1:-1:2]))
    wide = np.diff(np.flatnonzero(np.diff(np.array(shares) > 0.99)))
    assert np.max(wide) > 3  # pulses of more than three cycles were among them
    assert np.array(shares)[2:] == pytest.approx(given[1:-1], abs=0.04)
    assert np.cumsum(shares)[2:] == pytest.approx(np.cumsum(given)[1:-1], abs=0.04)


@pytest.mark.parametrize("delay", [0, 1, 5, 7])
def test_readings_arrive_so_many_cycles_late_and_unchanged(delay):
    params = np.zeros(1, [("delay_cycles", "i8")])[0]
    params["delay_cycles"] = ImuParams(delay_cycles=delay).delay_cycles
    plant, readings, sensed = np.zeros(1, STATE)[0], np.zeros(1, READINGS)[0], np.zeros(1, SENSED)[0]
    outputs, nothing = np.zeros(1, OUTPUTS)[0], np.zeros(1)[0]
    case = np.zeros(1, [("branches", BRANCHES)])[0]
    for k in range(40):
        plant["y"][RATE : RATE + 3], plant["velocity_gain"] = (k, -k, 2 * k), (3 * k, k, 0)
        measure(params, nothing, case, nothing, plant, outputs, readings, sensed)
        then = max(k - delay, 0)
        assert (
            sensed["imu_rate_B"].tolist() == [then, -then, 2 * then] and sensed["imu_gain_B"][0] == 3 * then
        )
