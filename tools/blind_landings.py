"""How often a landing that does not look meets a rock: by census at random places, and by flights.

    python tools/blind_landings.py [--places 20000] [--flights 20] [--abundance 0.04 0.1 0.2]

A disc of 12.6 m2 holds no rock of half a metre or more with probability exp(-12.6 N), where N per m2 follows
from Golombek's law; counts must lie within the binomial interval.  Exit status 1 where one does not.
"""

from __future__ import annotations

import argparse
import sys
from math import exp, pi

import numpy as np
from scipy import integrate, stats

import edl6dof
from edl6dof.environment.landing_area.population import within
from edl6dof.metrics.record_figures import COUNTED, FOOTPRINT
from edl6dof.scenario.records import build_records

SCENARIO = "tianwen1_hazards"


def expected(abundance: float) -> float:
    """Probability that a rock lies in the footprint."""
    q = 1.79 + 0.152 / abundance
    number = integrate.quad(lambda d: 4.0 * q * abundance * exp(-q * d) / (pi * d * d), COUNTED, np.inf)[0]
    return 1.0 - exp(-pi * FOOTPRINT**2 * number)


def by_census(abundance: float, places: int, per_case: int = 200) -> int:
    """How many of some random places, over ground of many cases, have a rock in the footprint."""
    hit = 0
    for seed in range(-(-places // per_case)):
        loaded = edl6dof.load(SCENARIO, [*_rocks(abundance), f"seed={seed}"])
        rocks = build_records(loaded).case["terrain"]["landing_area"]["rocks"][0]
        for north, east in np.random.default_rng(seed).uniform(-15e3, 15e3, (per_case, 2)):
            hit += within(rocks, north, east, FOOTPRINT, COUNTED)[0] > 0
    return hit


def by_flight(abundance: float, flights: int) -> int:
    """How many of some flights over ground of different cases come down on a rock."""
    landed = [edl6dof.fly(SCENARIO, [*_rocks(abundance), f"seed={seed}"]) for seed in range(1, flights + 1)]
    return sum(flight.figures["rocks_under_lander"] > 0 for flight in landed)


def _rocks(abundance: float) -> list[str]:
    return [f"terrain.landing_area.rock_abundance={abundance}"]


def within_interval(hit: int, count: int, share: float) -> bool:
    """Whether a count lies in the 99.9 % interval of the binomial distribution."""
    low, high = stats.binom.interval(0.999, count, share)
    return bool(low <= hit <= high)


def main() -> int:
    """Count and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--places", type=int, default=20_000)
    parser.add_argument("--flights", type=int, default=20)
    parser.add_argument("--abundance", type=float, nargs="+", default=[0.04, 0.1, 0.2])
    options = parser.parse_args()
    good = True
    for abundance in options.abundance:
        share = expected(abundance)
        counts = [("places", by_census(abundance, options.places), -(-options.places // 200) * 200)]
        if options.flights:
            counts.append(("flights", by_flight(abundance, options.flights), options.flights))
        for what, hit, count in counts:
            ok = within_interval(hit, count, share)
            good &= ok
            print(
                f"rocks on {abundance:4.0%} of the ground: {hit} of {count} {what} meet one = "
                f"{hit / count:.2%}, expected {share:.2%}: {'within' if ok else 'NOT within'} the interval"
            )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
