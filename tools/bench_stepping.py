"""Cycles of the flight software per second, stepped from Python: one by one, in portions, and of many flights
in a call.

    python tools/bench_stepping.py [--flights 32] [--workers 2]

Wall time and time of the processor, of the nominal flight from entry to touchdown with perfect sensors; the
best of three each.  Where the load is above 1 or so, trust the processor's alone, or run it under chrt -f 5.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

import edl6dof
from edl6dof.scenario.records import build_records
from edl6dof.sim.fleet import Fleet, Start
from edl6dof.sim.simulation import SteppedFlight


def measured(what: str, prepare: Callable[[], Callable[[], int]]) -> None:
    """Print cycles per second, the best of three."""
    wall, cpu = 0.0, 0.0
    for _ in range(3):
        work = prepare()
        began, used = time.perf_counter(), time.process_time()
        cycles = work()
        wall = max(wall, cycles / (time.perf_counter() - began))
        cpu = max(cpu, cycles / (time.process_time() - used))
    print(f"{what:<44}{wall:>12,.0f} /s{cpu:>12,.0f} /s of processor time")


def stepped(loaded: edl6dof.LoadedScenario, cycles: int, command: dict | None = None) -> Callable[[], int]:
    """Fly one flight whole, in portions."""
    flight = SteppedFlight(loaded, telemetry=False)

    def work() -> int:
        while flight.step(command, cycles):
            pass
        return flight.cycle

    return work


def fleet(loaded: edl6dof.LoadedScenario, count: int, workers: int, cycles: int) -> Callable[[], int]:
    """Fly many flights whole, in portions."""
    records = build_records(loaded)
    flight = SteppedFlight(loaded, records, telemetry=False)
    start = Start.of(records, flight.running.snapshot())
    flights = Fleet(count, records.tables, loaded.scenario.steps_per_cycle, workers)
    for index in range(count):
        flights.put(index, start)
    flights.advance(1)

    def work() -> int:
        while (flights.outcomes == 0).any():
            flights.advance(cycles)
        return int(flights.cycles.sum())

    return work


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--flights", type=int, default=32)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    loaded = edl6dof.load("tianwen1")
    stepped(loaded, 1000)()
    print(f"load {os.getloadavg()[0]:.1f}")
    print(f"{'':<44}{'cycles':>12}{'':>3}{'cycles':>12}")
    measured("one flight, cycle by cycle", lambda: stepped(loaded, 1))
    measured("one flight, cycle by cycle, bank commanded", lambda: stepped(loaded, 1, {"bank_deg": 60.0}))
    measured("one flight, ten cycles a step", lambda: stepped(loaded, 10))
    measured("one flight, whole", lambda: stepped(loaded, 1_000_000))
    for workers in sorted({1, options.workers}):
        many = f"{options.flights} flights, {workers} thread{'s' * (workers > 1)}"
        for cycles in (1, 10):
            measured(
                f"{many}, {cycles} cycle{'s' * (cycles > 1)} a step",
                lambda workers=workers, cycles=cycles: fleet(loaded, options.flights, workers, cycles),
            )


if __name__ == "__main__":
    main()
