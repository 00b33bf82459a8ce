"""Processor time of every plan that ``convex`` makes in dispersed landings.

python tools/convex_calls.py [FLIGHTS]

A flight is flown cycle by cycle; the call that makes a plan is made again from what the law remembered before
it, three times, and the least time of the thread is taken: the call alone, whatever else the machine does.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from time import thread_time

import numpy as np

from edl6dof.campaign.design.case import Variants
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.interface.roles import POWERED_DECELERATION
from edl6dof.kernels import kernel
from edl6dof.sim.flight_state import RunningFlight
from edl6dof.sim.outcome import FLYING
from edl6dof.studies.landing import dispersed, with_law

LAW = "convex"
#: Base cycles that are flown at once before the engine lights, and times that a call is made.
STRIDE, REPEATS = 5, 3


@kernel
def call(law, onboards, states, navs, targets, memories, outs):
    """One call of a powered law."""
    powered = onboards[0].guidance.powered
    law(powered.law, powered, onboards[0].vehicle, states[0], navs[0], targets[0], memories[0], outs[0])


def milliseconds(flight: RunningFlight, remembered: np.ndarray) -> float:
    """Least time (ms) of the present call, from what the law remembered before."""
    least, law = np.inf, chosen("powered_law", flight.onboard[0])
    fsw = flight.fsw
    given = [np.array(one) for one in (fsw["vehicle"], fsw["nav"], fsw["guidance"]["target"])]
    for _ in range(REPEATS):
        memory, out = remembered.copy(), np.zeros(1, GUIDE)
        start = thread_time()
        call(law, flight.onboard, *given, memory, out)
        least = min(least, 1e3 * (thread_time() - start))
    return least


def plans(flight: RunningFlight, braking: int) -> Iterator[float]:
    """Time (ms) of each call of a flight that makes a plan."""
    while flight.code == FLYING and flight.fsw["mission"]["phase"][0] != braking:
        flight.advance(STRIDE)
    while flight.code == FLYING and flight.fsw["mission"]["phase"][0] == braking:
        remembered = flight.fsw["guidance"]["powered"].copy()
        flight.advance(1)
        if flight.fsw["guidance"]["powered"][LAW]["plans"][0] != remembered[LAW]["plans"][0]:
            yield milliseconds(flight, remembered)


def tell(title: str, times: list[float]) -> None:
    """Print how long calls took."""
    shares = {"median": 0.5, "99 %": 0.99, "99.9 %": 0.999, "most": 1.0}
    said = ", ".join(
        f"{name} {np.quantile(times, share, method='higher'):.2f}" for name, share in shares.items()
    )
    print(f"{len(times)} {title}, ms: {said}; above 5 ms: {sum(time > 5.0 for time in times)}")


def main() -> None:
    """Print what comes out."""
    variants = Variants(with_law(LAW))
    phases = variants.base.scenario.mission.phases
    braking = next(i for i, phase in enumerate(phases) if phase.role == POWERED_DECELERATION)
    first: list[float] = []
    later: list[float] = []
    for case in dispersed(int(sys.argv[1]) if len(sys.argv) > 1 else 200):
        variant = variants.build(case)
        times = list(plans(RunningFlight(variant.loaded, None, variant.parts), braking))
        first += times[:1]
        later += times[1:]
    tell("first plans", first)
    tell("plans after them", later)


if __name__ == "__main__":
    main()
