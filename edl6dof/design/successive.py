"""Successive convexification: a sequence of convex programs, each about the solution of the previous one.

The cost of changes increases while the changes do not decrease, and is reset where they stop, until a reset
brings no further gain.  If no landing within the limits exists, virtual control remains.
Source: Szmuk & Acikmese 2018, AIAA 2018-0617, algorithm 1; the rule for the cost is this project's own.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from edl6dof.design.convex_step import Linear, Nodes, linearise, scales_of, solve_step
from edl6dof.design.rigid_landing import RigidLanding

#: Intervals, and those of them at full level.
INTERVALS, FULL_INTERVALS = 30, 4
#: Programs at most.
PROGRAMS = 150
#: Price of change at first, and what it is multiplied by where a change is not less than the one before, and
#: where a step is refused, whose true motion misses the next node by more than the size of the problem.
FIRST_TRUST, FACTOR, REFUSED, WILD = 0.02, 1.5, 4.0, 1.0
#: Largest defect (units of the problem), and difference between the costs that two programs promise (masses
#: at the start), at which it has converged.
DEFECT, GAIN = 5e-7, 2e-6
#: What the first price of change has to gain once more for it to go on, masses at the start.
AGAIN = 1e-4


@dataclass(frozen=True)
class Converged:
    """Result of successive convexification.

    Attributes:
        nodes: the last flight.
        fuel: kg.
        defect: largest difference between the end of an interval and the node there, in units of the problem.
        programs: convex programs solved.
        seconds: of computing.
        landed: whether it is a flight: no defect, and no better one near it.
    """

    nodes: Nodes
    fuel: float
    defect: float
    programs: int
    seconds: float
    landed: bool


def land(landing: RigidLanding, intervals: int = INTERVALS) -> Converged:
    """The landing of least fuel."""
    began = time.perf_counter()
    nodes = first_guess(landing, intervals)
    linear, trust, settled, programs = linearise(landing, nodes), FIRST_TRUST, False, 0
    promised, change, best, landed = np.inf, np.inf, np.inf, None
    while programs < PROGRAMS and not settled:
        programs += 1
        step = solve_step(landing, nodes, linear, trust)
        tried = None if step is None else linearise(landing, step.nodes)
        if step is None or tried is None or not _defect(landing, step.nodes, tried) < WILD:
            trust *= REFUSED
            continue
        gain, larger = abs(promised - step.promised), step.change >= change
        nodes, promised, change, linear = step.nodes, step.promised, step.change, tried
        if larger:
            trust *= FACTOR
        if gain < GAIN and _defect(landing, nodes, linear) < DEFECT:
            # a price of change that has grown may hold it where it is
            settled = promised > best - AGAIN
            if promised < best:
                best, landed = promised, (nodes, linear)
            trust, change = FIRST_TRUST, np.inf
    nodes, linear = landed or (nodes, linear)
    return Converged(
        nodes=nodes,
        fuel=float(landing.start[0] - nodes.x[-1, 0]),
        defect=_defect(landing, nodes, linear),
        programs=programs,
        seconds=time.perf_counter() - began,
        landed=landed is not None,
    )


def first_guess(landing: RigidLanding, intervals: int) -> Nodes:
    """A straight line to the landing point in the time of a constant deceleration, upright, thrust against
    gravity; the start at full level takes its shortest time.
    """
    height, descent = landing.start[3], max(-landing.start[6], 10.0)
    whole = max(2.0 * height / descent, 2.0 * (landing.full_time + landing.throttled_time))
    full = FULL_INTERVALS if landing.starts_full else 0
    durations = np.array([landing.full_time, whole - landing.full_time] if full else [whole])
    nodes = Nodes(np.empty((intervals + 1, 14)), np.zeros((intervals + 1, 4)), durations, full)
    share = (nodes.times / whole)[:, None]
    upright = np.array([landing.start[7], 0.0, 0.0, landing.start[10]])
    end = np.concatenate([[landing.start[0]], np.zeros(6), upright / np.linalg.norm(upright), np.zeros(3)])
    nodes.x[:] = (1.0 - share) * landing.start + share * end
    weight = landing.start[0] * landing.gravity
    nodes.u[:, 0] = np.clip(weight, *landing.thrust)
    nodes.u[:full, 0] = landing.thrust[1]
    return nodes


def _defect(landing: RigidLanding, nodes: Nodes, linear: Linear) -> float:
    scales = scales_of(landing, float(np.sum(nodes.durations)))
    return float(np.max(np.abs(linear.x[-1] - nodes.x[1:]) / scales.x))
