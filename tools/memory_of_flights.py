"""Does memory grow with the number of flights in one process?

    python tools/memory_of_flights.py 10000            # in a campaign, on all cores
    python tools/memory_of_flights.py 1000 --one-by-one  # each with edl6dof.fly
    python tools/memory_of_flights.py 10000 --engine dask --set simulation.time_limit_s=1  # short flights
    python tools/memory_of_flights.py 100000 --engine dask --campaign FILE  # of another campaign

Prints resident memory (MB) as flights go by, of this process and of the largest process that it has started
(the workers of Dask), its peak, its slope over the second half (kB a flight, least squares), and the hash of
the table of a campaign, which is the same for both engines.
"""

from __future__ import annotations

import argparse
import os
import threading
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import edl6dof

PERIOD_S = 0.25


def resident_mb(process: int | str = "self") -> float:
    """Memory of a process that is in use now (Linux); 0 if it has ended."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except OSError:
        return 0.0
    return pages * 4096 / 1e6


def children(process: int) -> list[int]:
    """Numbers of all processes that a process, or one of these, has started."""
    own = Path(f"/proc/{process}/task").glob("*/children")
    found = [int(one) for file in own for one in file.read_text().split()]
    return found + [one for child in found for one in children(child)]


def measured(work: Callable[[Callable[[int], None]], None]) -> list[tuple[int, float, float]]:
    """Flights done, memory (MB) of this process and of the largest that it has started, sampled while some
    work tells how many flights it has done.
    """
    done, samples, over = [0], [], threading.Event()

    def sample() -> None:
        while not over.wait(PERIOD_S):
            largest = max(map(resident_mb, children(os.getpid())), default=0.0)
            samples.append((done[0], resident_mb(), largest))

    sampler = threading.Thread(target=sample)
    sampler.start()
    try:
        work(lambda count: done.__setitem__(0, count))
    finally:
        over.set()
        sampler.join()
    return samples


def in_a_campaign(
    campaign: str, flights: int, engine: str, sets: Sequence[str]
) -> Callable[[Callable[[int], None]], None]:
    """Dispersed flights of one campaign."""

    def work(tell: Callable[[int], None]) -> None:
        with TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            edl6dof.campaign(
                campaign,
                sets,
                cases=flights,
                engine=engine,
                out=out,
                progress=lambda done, total: tell(done),
            )
            print("cases.parquet", sha256((out / "cases.parquet").read_bytes()).hexdigest())

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
    parser.add_argument("--engine", choices=("threads", "dask"), default="threads")
    parser.add_argument("--campaign", default="tianwen1_mc")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=VALUE")
    options = parser.parse_args()
    campaign = in_a_campaign(options.campaign, options.flights, options.engine, options.set)
    samples = np.array(measured(one_by_one(options.flights) if options.one_by_one else campaign))
    for share in (0.1, 0.25, 0.5, 0.75, 1.0):
        count, own, largest = samples[np.searchsorted(samples[:, 0], share * options.flights, "right") - 1]
        print(f"after {count:6.0f} flights: {own:6.0f} MB, {largest:6.0f} MB")
    print(f"peak: {samples[:, 1].max():.0f} MB, {samples[:, 2].max():.0f} MB")
    late = samples[samples[:, 0] >= 0.5 * options.flights]
    slopes = [1e3 * np.polyfit(late[:, 0], late[:, k], 1)[0] for k in (1, 2)]
    print(f"slope of the second half: {slopes[0]:.2f} kB a flight, {slopes[1]:.2f} kB")


if __name__ == "__main__":
    main()
