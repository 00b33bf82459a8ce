"""Flights side by side: each is the flight alone, and their threads end with them."""

import gc
import threading
import time

import pytest

import edl6dof
from edl6dof.scenario.records import build_records
from edl6dof.sim.fleet import Fleet, Start
from edl6dof.sim.outcome import FLYING
from edl6dof.sim.simulation import SteppedFlight


@pytest.fixture(scope="module")
def short():
    return edl6dof.load("tianwen1", {"simulation": {"time_limit_s": 75.0}})


def fleet_of(loaded, count, workers):
    return Fleet(count, build_records(loaded).tables, loaded.scenario.steps_per_cycle, workers)


def test_flights_side_by_side_in_portions_are_the_flight_alone(short):
    """The second begins anew on the way, from elsewhere."""
    alone = SteppedFlight(short, telemetry=False)
    records = build_records(short)
    start = Start.of(records, alone.running.snapshot())
    alone.step(cycles=1500)
    later = Start.of(records, alone.running.snapshot())
    fleet = fleet_of(short, 2, 2)
    for index in range(2):
        fleet.put(index, start)
    for cycles in (1, 1, 698):
        fleet.advance(cycles)
    fleet.put(1, later)
    while (fleet.outcomes == FLYING).any():
        fleet.advance(7)
    fleet.close()
    while alone.step(cycles=1000):
        pass
    for index in range(2):
        assert fleet.plants[index].tobytes() == alone.running.plant.tobytes()
        assert fleet.memories[index].tobytes() == alone.running.fsw.tobytes()


def helpers():
    return [one for one in threading.enumerate() if one.name.startswith("edl6dof-fleet")]


def test_threads_end_with_the_fleet_and_a_closed_one_flies_no_further(short):
    before = len(helpers())
    closed, dropped = fleet_of(short, 3, 3), fleet_of(short, 2, 2)
    closed.advance(1)
    dropped.advance(1)
    assert len(helpers()) == before + 3
    closed.close()
    with pytest.raises(RuntimeError, match="closed"):
        closed.advance(1)
    del dropped
    gc.collect()
    end = time.monotonic() + 60.0
    while len(helpers()) > before and time.monotonic() < end:
        time.sleep(0.001)
    assert len(helpers()) == before
