"""Dispersions of a campaign as sources of covariance: each a standard deviation above or below its mean."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from scipy.special import ndtr

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.dispersions import Draw, Target
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.design.sections import Correlated
from edl6dof.config.errors import refusal

#: Standard normal deviates over which moments are summed, and their weights.
_DEVIATES = np.linspace(-8.0, 8.0, 8001)
_WEIGHTS = np.exp(-0.5 * _DEVIATES**2) / np.exp(-0.5 * _DEVIATES**2).sum()


@dataclass(frozen=True)
class Source:
    """One line of a campaign's dispersions: a parameter, a group, or every item of a list."""

    name: str
    draws: tuple[Draw, ...]

    @property
    def is_list(self) -> bool:
        """True if it stands for the items of a list."""
        return "*" in self.name

    @property
    def width(self) -> int:
        """Number of independent deviates."""
        return sum(len(draw.targets) for draw in self.draws)

    def values(self, steps: np.ndarray) -> Iterator[tuple[Target, np.ndarray]]:
        """Values of each parameter, shape (flights,); ``steps``, shape (flights, width), in standard
        deviations.
        """
        column = 0
        for draw in self.draws:
            width = len(draw.targets)
            yield from zip(draw.targets, _values(draw, steps[:, column : column + width]), strict=True)
            column += width


def sources(plan: Plan) -> list[Source]:
    """Sources of a campaign: parameters and groups in the order of the file, then lists.

    Raises:
        ConfigError: it has none, or something in it has no covariance.
    """
    if plan.sweep is not None or plan.fault_matrix is not None:
        raise refusal(plan.name, "covariance is that of one flight: leave out sweep and fault_matrix")
    if plan.campaign is None or not plan.draws:
        raise refusal(
            plan.name, "has no dispersions in a campaign: section; try edl6dof covariance tianwen1_mc"
        )
    if plan.campaign.faults:
        raise refusal(
            plan.name, "faults that happen in some flights have no covariance: leave out campaign.faults"
        )
    lines = groupby(plan.draws, key=lambda draw: draw.targets[0].place[:3])
    found = [_source(tuple(draws)) for _, draws in lines]
    return sorted(found, key=lambda source: source.is_list)


def cases(
    plan: Plan, found: Sequence[Source], steps: np.ndarray, own_profiles: bool = True
) -> Iterator[Case]:
    """Flights with the rows of ``steps``, shape (flights, width of all sources), in standard deviations.

    Each meets random profiles of its own, or all the same; none that a case of the campaign itself meets.
    """
    ends = np.cumsum([source.width for source in found])[:-1]
    drawn = [
        pair
        for source, columns in zip(found, np.split(steps, ends, axis=1), strict=True)
        for pair in source.values(columns)
    ]
    random = plan.campaign is not None and plan.campaign.profiles
    for index in range(len(steps)):
        truth = {target.path: float(values[index]) for target, values in drawn if target.of == "truth"}
        belief = {target.path: float(values[index]) for target, values in drawn if target.of != "truth"}
        profile = plan.per_point + index * own_profiles if random else None
        yield Case(index, truth, belief, profile)


def moments(draw: Draw) -> tuple[float, float]:
    """Mean and standard deviation of one parameter's distribution.

    Raises:
        ConfigError: it is one of several names.
    """
    try:
        values = draw.values(ndtr(_DEVIATES)[:, None])[0].astype(float)
    except (TypeError, ValueError):
        raise refusal(draw.targets[0].path, "has values that are no numbers, and no covariance") from None
    mean = float(_WEIGHTS @ values)
    return mean, float(np.sqrt(_WEIGHTS @ (values - mean) ** 2))


def _values(draw: Draw, steps: np.ndarray) -> list[np.ndarray]:
    if isinstance(draw.distribution, Correlated):
        return draw.values(ndtr(steps))
    mean, deviation = moments(draw)
    return [mean + deviation * steps[:, 0]]


def _source(draws: tuple[Draw, ...]) -> Source:
    first = draws[0].targets[0]
    path = str(first.place[2])
    if isinstance(draws[0].distribution, Correlated):
        path = f"{first.path} and {len(draws[0].targets) - 1} more"
    return Source(path if first.of == "truth" else f"{path} ({first.of})", draws)
