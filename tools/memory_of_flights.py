"""Does memory grow with the number of flights in one process?

    python tools/memory_of_flights.py 10000            # in a campaign, on all cores
    python tools/memory_of_flights.py 1000 --one-by-one  # each with edl6dof.fly

Prints resident memory (MB) as flights go by, and its slope over the second half (kB a flight, least squares).
"""

from __future__ import annotations

import argparse
import threading
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import edl6dof

PERIOD_S = 0.25


def resident_mb() -> float:
    """Memory of this process that is in use now (Linux)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1e6


def measured(work: Callable[[Callable[[int], None]], None]) -> list[tuple[int, float]]:
    """Flights done and memory (MB), sampled while some work tells how many flights it has done."""
    done, samples, over = [0], [], threading.Event()

    def sample() -> None:
        while not over.wait(PERIOD_S):
            samples.append((done[0], resident_mb()))

    sampler = threading.Thread(target=sample)
    sampler.start()
    try:
        work(lambda count: done.__setitem__(0, count))
    finally:
        over.set()
        sampler.join()
    return samples


def in_a_campaign(flights: int) -> Callable[[Callable[[int], None]], None]:
    """Dispersed flights of one campaign."""

    def work(tell: Callable[[int], None]) -> None:
        with TemporaryDirectory() as folder:
            edl6dof.campaign(
                "tianwen1_mc",
                cases=flights,
                out=Path(folder) / "out",
                progress=lambda done, total: tell(done),
            )

    return work


def one_by_one(flights: int) -> Callable[[Callable[[int], None]], None]:
    """Flights that are loaded, flown and dropped."""

    def work(tell: Callable[[int], None]) -> None:
        for number in range(flights):
            edl6dof.fly("tianwen1", [f"seed={number}"])
            tell(number + 1)

    return work


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Memory of many flights in one process.")
    parser.add_argument("flights", type=int)
    parser.add_argument("--one-by-one", action="store_true")
    options = parser.parse_args()
    chosen = one_by_one if options.one_by_one else in_a_campaign
    samples = np.array(measured(chosen(options.flights)))
    for share in (0.1, 0.25, 0.5, 0.75, 1.0):
        count, memory = samples[np.searchsorted(samples[:, 0], share * options.flights, "right") - 1]
        print(f"after {count:6.0f} flights: {memory:6.0f} MB")
    late = samples[samples[:, 0] >= 0.5 * options.flights]
    slope = 1e3 * np.polyfit(late[:, 0], late[:, 1], 1)[0]
    print(f"slope of the second half: {slope:.2f} kB a flight")


if __name__ == "__main__":
    main()
