"""Where the time of a cycle goes: flights with and without one part of the loop, for ``tools/bench.py``."""

from __future__ import annotations

import statistics
import time
from typing import NamedTuple

FREE = ("mission.phases=[]", "simulation.time_limit_s=250")
PERFECT = ("sensors.set=perfect",)
#: Flights by name; each lacks a part that an earlier one has.
FLIGHTS = {
    "whole flight, instruments": (),
    "whole flight, instruments, no fault isolation": ("flight_software.diagnosis.enabled=false",),
    "whole flight, perfect sensors": PERFECT,
    "free entry, instruments": FREE,
    "free entry, perfect sensors": (*FREE, *PERFECT),
}


class Box(NamedTuple):
    """Cost of a cycle in one flight, ns of CPU time in each repetition."""

    name: str
    logged: list[float]
    silent: list[float]  # without telemetry

    @property
    def medians(self) -> tuple[float, float]:
        """Median cost with telemetry, and the part that telemetry takes."""
        whole = statistics.median(self.logged)
        return whole, whole - statistics.median(self.silent)


def measure_boxes(scenario: str, repeats: int) -> list[Box]:
    """Fly all flights in turn, with telemetry and without; the first round, which compiles, is left out."""
    import edl6dof

    loaded = {name: edl6dof.load(scenario, list(sets)) for name, sets in FLIGHTS.items()}
    boxes = {name: Box(name, [], []) for name in FLIGHTS}
    for lap in range(repeats + 1):
        for name, one in loaded.items():
            for log, samples in ((True, boxes[name].logged), (False, boxes[name].silent)):
                if (cost := _cost(one, log)) and lap:
                    samples.append(cost)
    return list(boxes.values())


def _cost(loaded: object, log: bool) -> float:
    """CPU time of a cycle, ns."""
    from edl6dof.sim.flight_state import NO_TICKS, RunningFlight

    flight = RunningFlight(loaded, log=None if log else NO_TICKS)
    begin = time.process_time()
    flight.advance(flight.last_cycle)
    return 1e9 * (time.process_time() - begin) / flight.cycle
