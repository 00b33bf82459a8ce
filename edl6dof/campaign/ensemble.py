"""Mean and spread of figures over neighbouring flights, whose initial states are practically equal.

The closed loop responds to a change of a nanometre per second with another sequence of pulses, so the figures
of one flight are one random draw of many.  Neighbouring flights differ by a millionth of a metre per second
in entry speed and by the number of their random profiles.  Their mean is the value of a figure, and their
standard deviation is its spread.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import nan, sqrt
from typing import Any, NamedTuple, Self

import numpy as np
from scipy.special import stdtrit

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import Progress, Row, fly_rows
from edl6dof.metrics.figures import BALANCES, FIGURES
from edl6dof.metrics.published import Published, published_figures
from edl6dof.scenario.initial import InitialState
from edl6dof.scenario.loaded import LoadedScenario

#: Difference in entry speed between flights (m/s), and number of flights of a mean in a document.
SPEED_STEP_M_S, FLIGHTS = 1e-6, 30
#: These figures judge the simulator; where it is right they are noise.
_BALANCES = frozenset(figure.name for figure in BALANCES)


class SampleMean(NamedTuple):
    """Mean, standard deviation (``nan`` for a single flight), and number of flights that reached a figure."""

    mean: float
    deviation: float
    flights: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Self:
        """Compute the statistics of at least one value."""
        deviation = float(np.std(values, ddof=1)) if len(values) > 1 else nan
        return cls(float(np.mean(values)), deviation, len(values))


def neighbours(loaded: LoadedScenario, count: int, step_m_s: float = SPEED_STEP_M_S) -> list[Case]:
    """Return the scenario itself and ``count - 1`` neighbours, each ``step_m_s`` faster than the last."""
    initial, profile = loaded.truth.initial, loaded.scenario.profile
    return [Case(k, truth=_faster(initial, k * step_m_s), profile=profile + k) for k in range(count)]


def fly_neighbours(
    loaded: LoadedScenario,
    count: int = FLIGHTS,
    *,
    step_m_s: float = SPEED_STEP_M_S,
    belief: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> list[Row]:
    """Fly neighbours; ``belief`` changes belief and truth of all of them, by dotted path."""
    cases = [replace(case, belief=belief or {}) for case in neighbours(loaded, count, step_m_s)]
    return list(fly_rows(loaded, cases, progress=progress))


def sample_means(rows: Sequence[Row], published: Published) -> dict[str, SampleMean]:
    """Mean and spread of every figure of merit that a flight reached, in the order of their declaration, then
    of published figures at events.  A figure that is published without its sign counts by its absolute value.
    """
    beside = {figure.name: entry for figure, entry in published_figures(published)}
    found = {}
    for name in dict.fromkeys([*(figure.name for figure in FIGURES), *beside]):
        size = abs if name in beside and beside[name].magnitude is not None else float
        values = [size(row[name]) for row in rows if row.get(name) is not None]
        if values:
            found[name] = SampleMean.of(values)
    return found


def clear_differences(
    spreads: Mapping[str, SampleMean], one: Mapping[str, Any], two: Mapping[str, Any]
) -> dict[str, float]:
    """Figures in which two flights differ by more than neighbours do, the largest relative difference first.

    Args:
        spreads: mean and spread of the figures over neighbours of one of the flights.
        one, two: figures of the flights by name.

    Returns:
        By name of each such figure, the largest difference that two neighbours may have, at 95 % for all
        figures together (Student's t of the difference of two draws, Bonferroni).
    """
    known = {
        name: (spread, one[name], two[name])
        for name, spread in spreads.items()
        if spread.flights > 1 and None not in (one.get(name), two.get(name)) and name not in _BALANCES
    }
    found: dict[str, tuple[float, float]] = {}
    for name, (spread, a, b) in known.items():
        variation = stdtrit(spread.flights - 1, 1.0 - 0.025 / len(known)) * sqrt(2.0) * spread.deviation
        if abs(b - a) > variation:
            found[name] = abs(b - a) / max(abs(a), abs(b)), float(variation)
    return {name: found[name][1] for name in sorted(found, key=lambda name: -found[name][0])}


def _faster(initial: InitialState, by: float) -> dict[str, Any]:
    """The initial velocity with a speed that is larger ``by``, m/s."""
    if initial.speed_m_s is not None:
        return {"initial.speed_m_s": initial.speed_m_s + by}
    velocity = np.array(initial.velocity_ned_m_s)
    return {"initial.velocity_ned_m_s": (velocity * (1.0 + by / max(initial.speed, 1e-9))).tolist()}
