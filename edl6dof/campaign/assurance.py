"""Requirements on a share of all flights, and their verdict from the flights of a campaign.

A requirement is *verified* if a smaller true share would give so few failures with a probability of at most
one minus the confidence (the consumer risk), *violated* if the required share exceeds the upper confidence
bound of the true share, and otherwise *undecided*.  Requirements do not change a flight: they are read from a
file of their own, and any complete campaign can be judged by them.

Source: Hanson and Beard, NASA/TP-2010-216447; bounds of the share: Clopper and Pearson, Biometrika 26 (1934)
404, one-sided.

>>> [flights_to_verify(failures, share=0.9973, confidence=0.9) for failures in range(4)]
[852, 1440, 1970, 2473]
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.special import bdtr, betaincc, betaincinv

from edl6dof.campaign.statistics import rank_above
from edl6dof.config.base import REQUIRED, Params, Title, param, stated
from edl6dof.config.document.source import read_document
from edl6dof.config.errors import ConfigError
from edl6dof.config.validate import judged
from edl6dof.config.wording import unknown
from edl6dof.metrics.figures import LIMITS

#: Share and confidence of a limit of the scenario that is judged as a requirement.
SHARE, CONFIDENCE = 0.99, 0.9
#: More flights than any campaign has; at most three worst cases are listed for each requirement.
_MOST, _WORST = 2**50, 3


class Requirement(Params):
    """A bound (``at_most`` or ``at_least``) that a figure meets in at least a share of all flights."""

    id: Title = param(REQUIRED, "name of the requirement, such as SYS-12")
    text: Title = param(REQUIRED, "the requirement in words")
    figure: str = param(REQUIRED, "figure of merit, a column of the campaign")
    at_most: float | None = param(None, "largest allowed value, in the unit of the figure")
    at_least: float | None = param(None, "smallest allowed value, in the unit of the figure")
    share: float = param(REQUIRED, "share of all flights that meets the bound", gt=0.0, lt=1.0)
    confidence: float = param(CONFIDENCE, "probability that a smaller share is not verified", ge=0.5, lt=1.0)

    @property
    def limit(self) -> float:
        """The bound."""
        return stated(self.at_least if self.at_most is None else self.at_most)

    @property
    def label(self) -> str:
        """Name and text in one line."""
        return self.id if self.id == self.text else f"{self.id}: {self.text}"

    @property
    def sign(self) -> float:
        """Factor of the figure, 1 or -1, after which larger values are worse."""
        return -1.0 if self.at_most is None else 1.0

    def margins(self, values: np.ndarray) -> np.ndarray:
        """Distance of each of the ``values``, shape (n,), from the bound, negative outside; -inf for NaN."""
        return np.where(np.isnan(values), -np.inf, self.sign * (self.limit - values))


class RequirementsFile(Params):
    """A file of requirements."""

    requirements: list[Requirement] = param(REQUIRED, "the requirements", min_length=1)


def limits_as_requirements(limits: Mapping[str, Any]) -> list[Requirement]:
    """Return each of the ``limits`` of a scenario, by key, as a requirement named by its figure."""
    given = [(figure, limits.get(str(figure.limit))) for figure in LIMITS]
    return [
        Requirement.model_validate(
            {"id": one.name, "text": one.meaning, "figure": one.name, "share": SHARE}
            | {"at_least" if one.clearance else "at_most": float(limit)}
        )
        for one, limit in given
        if limit is not None
    ]


def load_requirements(path: Path, figures: Collection[str]) -> list[Requirement]:
    """Read a file of requirements; ``figures``: names that a requirement may use.

    Raises:
        ConfigError: every mistake, with file, line and key.
    """
    document = read_document(path, {})
    found, problems = judged(RequirementsFile, document)
    own = _problems(document.data.get("requirements"), figures)
    problems += [document.problem(("requirements", *place), words) for place, words in own]
    if problems:
        raise ConfigError(problems)
    return found.requirements


def _problems(items: Any, figures: Collection[str]) -> Iterator[tuple[tuple[int, str], str]]:
    """Yield place and message of each problem that the declaration of a requirement cannot find alone."""
    names: list[Any] = []
    for number, item in enumerate(items if isinstance(items, list) else ()):
        given = item if isinstance(item, dict) else {}
        if isinstance(figure := given.get("figure"), str) and figure not in figures:
            yield (number, "figure"), unknown("figure", figure, sorted(figures))
        if (name := given.get("id")) is not None and name in names:
            yield (number, "id"), f"must be given once (got {name!r} twice)"
        bounds = [key for key in ("at_most", "at_least") if given.get(key) is not None]
        if len(bounds) != 1:
            words = f"give one of at_most and at_least (got {' and '.join(bounds) or 'none'})"
            yield (number, "at_most"), words
        names.append(name)


@dataclass(frozen=True)
class Verdict:
    """A requirement judged by the flights of a campaign.

    Attributes:
        flights: number of flights.
        failures: number of flights outside the bound, or without a value.
        demonstrated: lower confidence bound of the share of flights that meet the requirement.
        bound: confidence bound of the figure at the required share, by order statistics, in the unit of the
            figure; ``None`` if the flights are too few, or too many of them failed.
        verdict: result.
        needed: flights of a campaign that verifies the requirement with this number of failures.
        worst: row and figure of the worst flights, the worst first; NaN without a value.
    """

    requirement: Requirement
    flights: int
    failures: int
    demonstrated: float
    bound: float | None
    verdict: Literal["verified", "violated", "undecided"]
    needed: int
    worst: tuple[tuple[int, float], ...]


def judge(requirement: Requirement, values: np.ndarray, failed: np.ndarray) -> Verdict:
    """Judge a requirement.

    Args:
        requirement: the requirement.
        values: figure of each flight, shape (n,), NaN where a flight has none.
        failed: True for flights that count as failures whatever their figure, shape (n,).
    """
    share, confidence = requirement.share, requirement.confidence
    worse = np.where(failed | np.isnan(values), np.inf, requirement.sign * values)
    n, failures = len(worse), int(np.sum(worse > requirement.sign * requirement.limit))
    order = np.argsort(worse, kind="stable")
    rank = rank_above(n, share, confidence)
    bound = requirement.sign * float(worse[order[rank]]) if rank < n else np.inf
    low, high = share_bounds(failures, n, confidence)
    verdict: Literal["verified", "violated", "undecided"] = "violated" if high < share else "undecided"
    if bdtr(failures, n, 1.0 - share) <= 1.0 - confidence:
        verdict = "verified"
    worst = np.argsort(-worse, kind="stable")[:_WORST].tolist()
    return Verdict(
        *(requirement, n, failures, low, bound if isfinite(bound) else None, verdict),
        needed=flights_to_verify(failures, share, confidence),
        worst=tuple((row, float(values[row])) for row in worst),
    )


def share_bounds(failures: int, flights: int, confidence: float) -> tuple[float, float]:
    """Lower and upper bound of the share of successes, each at this confidence."""
    good = flights - failures
    low = float(betaincinv(good, failures + 1, 1.0 - confidence)) if good else 0.0
    return low, float(betaincinv(good + 1, failures, confidence)) if failures else 1.0


def flights_to_verify(failures: int, share: float, confidence: float) -> int:
    """Least number of flights that verifies a share with this number of failures."""
    more = range(failures + 1, _MOST)  # more failures than these, with a true share equal to the required one
    return more[bisect_left(more, confidence, key=lambda n: betaincc(n - failures, failures + 1, share))]
