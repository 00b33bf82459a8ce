"""Flights for a covariance: a two-level design sets each source (a dispersion of a campaign) one standard
deviation above or below its mean, and the figures are taken at an event.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count, groupby
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.dispersions import Draw, Target, drawn
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.design.sections import Correlated
from edl6dof.campaign.executor import Progress, fly_rows
from edl6dof.config.document.overrides import with_values
from edl6dof.config.errors import refusal
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario

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
        """True if the source stands for the items of a list."""
        return "*" in self.name

    @property
    def width(self) -> int:
        """Number of independent deviates."""
        return sum(len(draw.targets) for draw in self.draws)

    def values(self, steps: np.ndarray) -> Iterator[tuple[Target, np.ndarray]]:
        """Values of each parameter, shape (flights,), at ``steps`` (sigma), shape (flights, width)."""
        for draw, own in drawn(self.draws, steps):
            yield from zip(draw.targets, _values(draw, own), strict=True)


def sources(plan: Plan) -> list[Source]:
    """Sources of a campaign: parameters and groups in the order of the file, then lists.

    Raises:
        ConfigError: the campaign has no dispersions, or something in it has no covariance.
    """
    if plan.sweep is not None or plan.fault_matrix is not None:
        raise refusal(plan.name, "covariance is that of one flight: leave out sweep and fault_matrix")
    if plan.campaign is None or not plan.draws:
        words = "has no dispersions in a campaign: section; try edl6dof covariance tianwen1_mc"
        raise refusal(plan.name, words)
    if plan.campaign.faults:
        words = "faults that happen in some flights have no covariance: leave out campaign.faults"
        raise refusal(plan.name, words)
    found = []
    for place, draws in groupby(plan.draws, key=lambda draw: draw.targets[0].place[:3]):
        lines = tuple(draws)
        name, first = str(place[2]), lines[0].targets[0]
        if isinstance(lines[0].distribution, Correlated):
            name = f"{first.path} and {len(lines[0].targets) - 1} more"
        found.append(Source(name if first.of == "truth" else f"{name} ({first.of})", lines))
    return sorted(found, key=lambda source: source.is_list)


def cases(
    plan: Plan, found: Sequence[Source], steps: np.ndarray, own_profiles: bool = True
) -> Iterator[Case]:
    """Yield flights with the rows of ``steps``, shape (flights, width of sources), in standard deviations.

    Each flight has its own random profiles (``own_profiles``), or all have the same; none of these profiles
    occurs in the campaign itself.
    """
    values = list(Source("", tuple(draw for source in found for draw in source.draws)).values(steps))
    random = plan.campaign is not None and plan.campaign.profiles
    for index in range(len(steps)):
        truth = {target.path: float(every[index]) for target, every in values if target.of == "truth"}
        belief = {target.path: float(every[index]) for target, every in values if target.of != "truth"}
        profile = plan.per_point + index * own_profiles if random else None
        yield Case(index, truth, belief, profile)


def moments(draw: Draw) -> tuple[float, float]:
    """Mean and standard deviation of one parameter's distribution.

    Raises:
        ConfigError: the values of the distribution are no numbers.
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


def hadamard(order: int) -> np.ndarray | None:
    """Matrix of -1 and 1 with orthogonal columns, shape (order, order), by Paley's first construction and by
    doubling; ``None`` if neither gives this order.

    Source: Plackett and Burman, Biometrika 33 (1946) 305; Paley, J. Math. Phys. 12 (1933) 311.
    """
    if order == 1:
        return np.ones((1, 1))
    prime = order - 1
    if order % 4 == 0 and all(prime % divisor for divisor in range(2, int(prime**0.5) + 1)):
        return _paley(prime)
    half = hadamard(order // 2) if order % 2 == 0 else None
    return None if half is None else np.kron([[1.0, 1.0], [1.0, -1.0]], half)


def at_least(order: int) -> np.ndarray:
    """The smallest Hadamard matrix of at least this order."""
    return next(found for size in count(max(order, 1)) if (found := hadamard(size)) is not None)


def design(columns: int, more: int, pairs: int, seed: int) -> np.ndarray:
    """Signs of the steps in the first flight of each pair, shape (at least ``pairs``, columns + more); the
    second flight has the opposite signs.  The first ``columns`` are orthogonal to each other, the ``more``
    others are random.
    """
    generator = np.random.default_rng(seed)
    matrix = at_least(max(pairs, columns))
    orthogonal = matrix[:, generator.permutation(len(matrix))[:columns]]
    return np.hstack([orthogonal, generator.choice([-1.0, 1.0], (len(matrix), more))])


def _paley(prime: int) -> np.ndarray:
    """Hadamard matrix of order ``prime`` + 1; the prime leaves 3 when divided by 4."""
    numbers = np.arange(prime)
    character = np.where(np.isin(numbers, numbers[1:] ** 2 % prime), 1.0, -1.0)
    character[0] = 0.0
    matrix = np.eye(prime + 1)
    matrix[0, 1:], matrix[1:, 0] = 1.0, -1.0
    matrix[1:, 1:] += character[(numbers[:, None] - numbers) % prime]
    return matrix


class EventFigures(NamedTuple):
    """Names of the figures of an event: the two of the ``position`` that span an ellipse, if any; others."""

    position: tuple[str, ...]
    others: tuple[str, ...]

    @property
    def all(self) -> tuple[str, ...]:
        """Names of all figures, those of the position first."""
        return self.position + self.others


_LOADS = ("peak_load_g0", "peak_dynamic_pressure_pa", "peak_heat_flux_w_cm2", "heat_load_j_cm2")
_STATE = ("altitude_m", "speed_m_s", "mach", "dynamic_pressure_pa", "s")
EVENTS = {
    "entry": EventFigures((), _LOADS),
    "parachute": EventFigures(
        ("parachute_downrange_m", "parachute_crossrange_m"), tuple(f"parachute_{name}" for name in _STATE)
    ),
    "trim_wing": EventFigures((), ("trim_wing_s", "trim_wing_mach")),
    "backshell": EventFigures((), ("backshell_height_m", "backshell_speed_m_s", "backshell_s")),
    "touchdown": EventFigures(
        ("landing_east_m", "landing_north_m"), ("touchdown_s", "touchdown_vertical_m_s", "propellant_used_kg")
    ),
}


def figures_at(event: str) -> EventFigures:
    """Names of the figures of an event.

    Raises:
        ConfigError: there is no such event.
    """
    if event not in EVENTS:
        raise refusal("--at", f"must be {', '.join(EVENTS)} (got {event!r})")
    return EVENTS[event]


def figures_of(
    plan: Plan,
    cases: Iterable[Case],
    event: EventFigures,
    workers: int | None = None,
    progress: Progress | None = None,
) -> np.ndarray:
    """Figures of all flights, shape (flights, figures).

    Raises:
        ConfigError: a flight does not reach the event.
    """
    rows = list(fly_rows(plan.loaded, cases, workers=workers, progress=progress))
    values = np.array([[row.get(name, np.nan) for name in event.all] for row in rows], dtype=float)
    if (short := ~np.isfinite(values).all(axis=1)).any():
        outcome = rows[int(np.argmax(short))]["outcome"]
        words = f"{short.sum()} of {len(rows)} flights do not come to the event; one: {outcome}"
        raise refusal(plan.name, words)
    return values


def ending_at_deployment(plan: Plan) -> Plan:
    """A plan of the same flights, which end when the parachute is deployed."""
    document = with_values(plan.loaded.document, {"mission.goal": "deployment"}, Scenario)
    return replace(plan, loaded=check_document(document))
