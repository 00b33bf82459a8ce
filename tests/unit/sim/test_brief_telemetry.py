"""A flight that records only what its figures need is the same flight, with the same figures to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.sim.channels import BRIEF, BRIEF_CHANNELS, TICK
from edl6dof.sim.extremes import largest
from edl6dof.sim.flight import fly, log_rows
from edl6dof.sim.telemetry import Telemetry


@pytest.fixture(scope="module")
def brief(nominal):
    return fly(nominal.loaded, log=np.full(log_rows(nominal.loaded), np.nan, BRIEF))


def test_every_channel_is_that_of_the_whole_telemetry(nominal, brief):
    assert len(brief.log) == len(nominal.log)
    assert list(brief.telemetry) == ["t_s", *(channel.name for channel in BRIEF_CHANNELS)]
    for name, column in brief.telemetry.items():
        assert column.tobytes() == nominal.telemetry[name].tobytes(), name


def test_flight_and_figures_are_the_same(nominal, brief):
    assert brief.plant.tobytes() == nominal.plant.tobytes()
    assert brief.fsw.tobytes() == nominal.fsw.tobytes()
    assert brief.metrics == nominal.metrics
    assert brief.events == nominal.events
    assert (brief.success, brief.outcome, brief.cause) == (nominal.success, nominal.outcome, nominal.cause)


def test_channels_that_were_not_recorded_are_refused(brief):
    with pytest.raises(KeyError):
        brief.telemetry["truth.tilt_deg"]
    with pytest.raises(KeyError):
        brief.telemetry["rcs.D1"]
    assert BRIEF.itemsize < TICK.itemsize / 4


@pytest.mark.parametrize("rows", [1, 2, 63, 64, 65, 200, 1001])
def test_largest_magnitude_is_that_of_numpy(rows):
    values = np.random.default_rng(rows).normal(size=(rows, BRIEF.itemsize // 8))
    log = values.view(BRIEF)[:, 0]
    names = [channel.name for channel in BRIEF_CHANNELS[::3]]
    telemetry = Telemetry(log, ())
    expected = [np.max(np.abs(telemetry[name])) for name in names]
    assert telemetry.largest(*names).tolist() == expected
    values[rows // 2, 4] = np.nan
    assert np.isnan(largest(log, np.arange(10))).tolist() == [k == 4 for k in range(10)]


def test_largest_of_nothing_is_no_number():
    assert np.isnan(Telemetry(np.zeros(0, TICK), ("D1",)).largest("truth.mach", "guide.phase")).all()
