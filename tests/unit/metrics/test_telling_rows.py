"""Figures from the rows that a flight without its whole log keeps: the same to the last bit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import edl6dof
from edl6dof.metrics.extremes import EXTREMES
from edl6dof.metrics.telling_rows import EXTREME, keep_telling
from edl6dof.sim.figures import telling_of
from edl6dof.telemetry.channels import BRIEF

#: Rows logged between two looks at what may be dropped.
LAUNCHES = (13, 500, 100_000)


def brief(flight):
    """The brief log of a flight."""
    log = np.zeros(len(flight.log), BRIEF)
    log["t"] = flight.log["t"]
    for group in BRIEF.names[1:]:
        for name in BRIEF[group].names:
            log[group][name] = flight.log[group][name]
    return log


def thinned(flight, needs, launch):
    """The flight with no more rows of its log than ``needs`` says, the others dropped while it is flown."""
    log, kept, count = flight.log, np.zeros(len(flight.log), BRIEF), 0
    keep = np.zeros(len(log), np.int8)
    for first in range(0, len(log), launch):
        some = log[first : first + launch]
        kept[count : count + len(some)] = some
        then = flight.plant.copy()
        for name in ("done", "touchdown_time"):
            then[name] = np.where(then[name] > some["t"][-1], np.nan, then[name])
        count = keep_telling(needs[0], then[0], kept, count + len(some), keep)
    return replace(flight, log=kept[:count])


def noise(log, growth):
    """A log of the same times, phases and bank angles with random numbers in the other channels, so that no
    extreme stands in a row that is kept for another reason; from start to end they grow by ``growth``.
    """
    size = 0.5 + growth * (log["t"][:, None] / log["t"][-1] - 0.5)
    numbers = size * np.random.default_rng(1).uniform(-1.0, 1.0, (len(log), BRIEF.itemsize // 8))
    other = numbers.view(BRIEF)[:, 0]
    other["t"], other["guide"] = log["t"], log["guide"]
    return other


@pytest.fixture(scope="module")
def flights(nominal):
    """Flights with their brief logs: one that lands, one that is over early, and random numbers."""
    short = edl6dof.fly("tianwen1", ("simulation.time_limit_s=200",))
    assert (nominal.landed, short.landed) == (True, False)
    logs = [(nominal, brief(nominal)), (short, brief(short))]
    logs += [(nominal, noise(logs[0][1], growth)) for growth in (-0.5, 0.5)]
    return [replace(flight, log=log) for flight, log in logs]


def test_figures_of_the_rows_that_are_kept_are_those_of_all(nominal, flights):
    assert list(flights[0].metrics.items()) == list(nominal.metrics.items())
    assert EXTREMES.keys() <= nominal.metrics.keys()
    for flight in flights:
        for launch in LAUNCHES:
            few = thinned(flight, telling_of(flight.scenario), launch)
            assert len(few.log) < 100 < len(flight.log) / 100
            assert list(few.metrics.items()) == list(flight.metrics.items())
            assert (few.outcome, few.cause, few.success) == (flight.outcome, flight.cause, flight.success)


def test_every_extreme_is_needed(flights):
    """Without the row of one, a figure is another: none is kept in vain, and a figure whose rows were
    forgotten shows.
    """
    needs = telling_of(flights[0].scenario)
    of_no_phase, begins = np.zeros((), EXTREME), needs["extremes"]["since"][0, : needs["n_extremes"][0]]
    never = np.flatnonzero(np.isnan(flights[0].plant["done"][0]))
    assert "relight" in flights[0].scenario.mission.events
    for number in np.flatnonzero(~np.isin(begins, never)):
        without = needs.copy()
        without["extremes"][0, number] = of_no_phase
        few = [thinned(flight, without, 500).metrics != flight.metrics for flight in flights[2:]]
        assert any(few), needs["extremes"][0, number]
    without = needs.copy()
    without["late"] = of_no_phase
    figure = "trim_aoa_limit_cycle_deg"
    assert thinned(flights[2], without, 500).metrics[figure] < flights[2].metrics[figure]


def test_flight_that_looks_for_hazards_keeps_every_row():
    scenario = edl6dof.load("tianwen1").scenario
    assert telling_of(scenario) is not None
    assert telling_of(edl6dof.load("tianwen1_hazards").scenario) is None
