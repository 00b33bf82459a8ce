"""Statistics of a campaign: success probability with its interval, ellipses, quantiles with their bounds
where the flights are enough, and the paired comparison of two campaigns.

>>> flights_needed(0.99), flights_needed(0.9987)
(368, 2836)
>>> quantile(np.arange(1.0, 101.0), 0.95)
Quantile(share=0.95, value=95.05, low=90.0, high=100.0)
>>> quantile(np.arange(1.0, 101.0), 0.99) is None
True
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import ceil, log, sqrt
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from scipy.special import bdtr, ndtri, stdtrit

from edl6dof.campaign.row_columns import BELIEF, TRUTH
from edl6dof.config.errors import refusal

if TYPE_CHECKING:
    from edl6dof.campaign.store import Store


@dataclass(frozen=True)
class Proportion:
    """Successes among trials, with the Wilson score interval.

    Source: Wilson, J. Am. Stat. Assoc. 22 (1927) 209; it keeps its coverage near 0 and 1, where the normal
    interval fails.
    """

    successes: int
    trials: int
    confidence: float = 0.95

    @classmethod
    def of(cls, kept: Sequence[bool]) -> Self:
        """Count the true values of ``kept``."""
        return cls(sum(map(bool, kept)), len(kept))

    @property
    def value(self) -> float:
        """Share of successes."""
        return self.successes / self.trials if self.trials else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper end of the interval; 0 and 1 without trials."""
        if not self.trials:
            return 0.0, 1.0
        n, z = self.trials, float(ndtri(0.5 * (1.0 + self.confidence)))
        middle = self.successes + 0.5 * z**2
        half = z * sqrt(self.successes * (n - self.successes) / n + 0.25 * z**2)
        low, high = (middle - half) / (n + z**2), (middle + half) / (n + z**2)
        return 0.0 if self.successes == 0 else low, 1.0 if self.successes == n else high

    @property
    def half_width(self) -> float:
        """Half the length of the interval."""
        low, high = self.interval
        return (high - low) / 2.0

    def __str__(self) -> str:
        low, high = self.interval
        return f"{100 * self.value:.2f} % ({100 * low:.2f} .. {100 * high:.2f} %)"


@dataclass(frozen=True)
class Until:
    """Stop when the interval of the success probability is narrow enough."""

    half_width: float

    @classmethod
    def parse(cls, text: str) -> Until:
        """Read ``p_success +- 0.5%``.

        Raises:
            ValueError: the text has another form.
        """
        match = re.fullmatch(r"\s*p_success\s*(?:\+-|\+/-|±)\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*(%?)\s*", text)
        try:
            width = float(match[1]) / (100.0 if match[2] else 1.0) if match else 0.0
        except ValueError:
            width = 0.0
        if not 0.0 < width < 0.5:
            raise ValueError(f"must have the form 'p_success +- 0.5%' (got {text!r})")
        return cls(width)

    def reached(self, proportion: Proportion) -> bool:
        """Return whether flying may stop."""
        return proportion.trials > 0 and proportion.half_width <= self.half_width


def ellipse(
    east: np.ndarray, north: np.ndarray, sigmas: float, points: int = 181
) -> tuple[np.ndarray, np.ndarray]:
    """East and north of the ellipse at ``sigmas`` standard deviations of a normal fit to given places."""
    curve = contour(np.cov(np.stack([east, north])), sigmas, points)
    return curve[0] + east.mean(), curve[1] + north.mean()


def contour(covariance: np.ndarray, sigmas: float, points: int = 181) -> np.ndarray:
    """Ellipse (2, points) at ``sigmas`` standard deviations about zero for a normal ``covariance`` (2, 2)."""
    values, vectors = np.linalg.eigh(covariance)
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    return vectors @ (
        np.sqrt(np.maximum(values, 0.0))[:, None] * sigmas * np.stack([np.cos(angle), np.sin(angle)])
    )


#: Probability that both bounds hold.
CONFIDENCE = 0.95
#: Shares of the quantiles of a report: the median, and pairs out to three sigma of a normal distribution.
SHARES = (0.0013, 0.01, 0.05, 0.5, 0.95, 0.99, 0.9987)


@dataclass(frozen=True)
class Quantile:
    """Quantile: the value below which a ``share`` of all flights lies, with its bounds at 95 % confidence."""

    share: float
    value: float
    low: float
    high: float


def quantile(values: np.ndarray, share: float, flown: bool = False) -> Quantile | None:
    """A quantile of ``values``, shape (n,), NaN where a flight has none; ``None`` if too few to bound it.

    The bounds are two of the values themselves, whatever the distribution: the number of values below the
    quantile is binomial.  Of flights that are stratified (Latin hypercube, Sobol sequence) and not
    independent, the bounds hold on the safe side where the figure rises or falls with each input.

    Args:
        values: values of all flights; infinite ones are left out, unless ``flown``.
        share: of the flights that stay below.
        flown: True to take the next larger flown value in place of an interpolated one; infinite values then
            count as flights that failed, larger than all others.

    Source: Wilks, Ann. Math. Stat. 12 (1941) 91; David and Nagaraja, Order Statistics, 3rd ed., 7.1.
    """
    ordered = np.sort(values[~np.isnan(values) if flown else np.isfinite(values)])
    if len(ordered) < flights_needed(share):
        return None
    low, high = _bounding(len(ordered), share)
    value = np.quantile(ordered, share, method="higher" if flown else "linear")
    return Quantile(share, float(value), float(ordered[low]), float(ordered[high]))


def _bounding(n: int, share: float) -> tuple[int, int]:
    """Indices (from 0) of the two among ``n`` ordered values that bound a quantile."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return rank_above(n, share, tail) - 1, rank_above(n, share, 1.0 - tail)


@cache
def rank_above(n: int, share: float, confidence: float) -> int:
    """Index (from 0) of the smallest of ``n`` ordered values that is an upper bound of a quantile with this
    confidence; ``n`` if there is none.
    """
    return bisect_left(range(n), confidence, key=lambda below: bdtr(below, n, share))


def flights_needed(share: float) -> int:
    """Least number of flights whose smallest and largest value bound a quantile."""
    return ceil(log(0.5 * (1.0 - CONFIDENCE)) / log(max(share, 1.0 - share)))


def bounded_shares(flights: int) -> tuple[float, ...]:
    """Shares of :data:`SHARES` whose quantiles this number of flights can bound."""
    return tuple(share for share in SHARES if flights_needed(share) <= flights)


def percent(share: float) -> str:
    """Text of a share in per cent, such as ``99.87 %``."""
    return f"{100.0 * share:g} %"


#: Columns of the end of a case, which are no figures.
_ENDS = {"case", "success", "cause", "outcome", "profile"}


@dataclass(frozen=True)
class Difference:
    """Means of a figure in both campaigns, and of the paired difference B - A with half of its 95 % interval;
    ``clear``: True if no difference is excluded at 95 % for all figures together.
    """

    figure: str
    pairs: int
    mean_a: float
    mean_b: float
    difference: float
    half_width: float
    clear: bool


@dataclass(frozen=True)
class Comparison:
    """Comparison of two campaigns; ``counts``: pairs in which both succeed, A alone, B alone, neither."""

    names: tuple[str, str]
    success: tuple[Proportion, Proportion]
    counts: tuple[int, int, int, int]
    p_value: float
    figures: tuple[Difference, ...]

    @property
    def data(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        both, a, b, neither = self.counts
        return {
            "campaigns": list(self.names),
            "p_success": [proportion.value for proportion in self.success],
            "p_success_95": [list(proportion.interval) for proportion in self.success],
            "pairs": {"both": both, "first_only": a, "second_only": b, "neither": neither},
            "mcnemar_p_value": self.p_value,
            "figures": [vars(figure) for figure in self.figures],
        }


def mcnemar(only_a: int, only_b: int) -> float:
    """Probability that pairs with one success split at least as unevenly if the configurations do not differ.

    Source: McNemar, Psychometrika 12 (1947) 153, with the exact binomial distribution.
    """
    return min(2.0 * float(bdtr(min(only_a, only_b), only_a + only_b, 0.5)), 1.0)


def compare(first: Store, second: Store) -> Comparison:
    """Pair the cases of two campaigns, flown by two configurations.  Common random numbers cancel in a pair,
    so that a small difference shows with few flights.

    Raises:
        ConfigError: the campaigns did not fly the same cases.
    """
    a, b = first.table().sort_by("case"), second.table().sort_by("case")
    cases = np.intersect1d(a["case"].to_numpy(), b["case"].to_numpy())
    a, b = (table.filter(pc.is_in(table["case"], pa.array(cases))) for table in (a, b))
    names = (first.folder.name, second.folder.name)
    _require_common(a, b, first, second)
    x, y = (table["success"].to_numpy(zero_copy_only=False) for table in (a, b))
    both, only_a, only_b, neither = (int(np.sum(pair)) for pair in (x & y, x & ~y, ~x & y, ~(x | y)))
    success = Proportion.of(x), Proportion.of(y)
    counts, p_value = (both, only_a, only_b, neither), mcnemar(only_a, only_b)
    return Comparison(names, success, counts, p_value, tuple(_differences(a, b)))


def _require_common(a: pa.Table, b: pa.Table, first: Store, second: Store) -> None:
    """Require the same values of every quantity that both campaigns disperse, so that cases are pairs."""
    if not len(a):
        raise refusal(first.folder, f"has no case in common with {second.folder}")
    drawn = [name for name in a.column_names if name.startswith((TRUTH, BELIEF, "profile"))]
    shared = [name for name in drawn if name in b.column_names]
    different = [name for name in shared if not a[name].equals(b[name])]
    if not shared or different:
        what = f"differs in {', '.join(different[:3])}" if different else "shares no dispersed quantity"
        words = f"{what} with {second.folder}: fly both with the same campaign section and seed"
        raise refusal(first.folder, words)


def _differences(a: pa.Table, b: pa.Table) -> list[Difference]:
    apart = {name: pair for name in a.column_names if len((pair := _both(a, b, name))[0]) > 1}
    found = []
    for name, (x, y) in apart.items():
        difference = float((y - x).mean())
        deviation = float((y - x).std(ddof=1)) / sqrt(len(x))
        one, all_of_them = (stdtrit(len(x) - 1, 1.0 - 0.025 / tests) for tests in (1, len(apart)))
        clear = abs(difference) > all_of_them * deviation  # Bonferroni: for all figures together
        means = float(x.mean()), float(y.mean()), difference
        found.append(Difference(name, len(x), *means, float(one) * deviation, bool(clear)))
    return found


def _both(a: pa.Table, b: pa.Table, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Values of a figure in the pairs in which both flights have it; empty if the column is no figure."""
    numeric = name in b.column_names and all(pa.types.is_floating(table[name].type) for table in (a, b))
    if not numeric or name in _ENDS or name.startswith((TRUTH, BELIEF)):
        return np.empty(0), np.empty(0)
    x, y = (table[name].to_numpy(zero_copy_only=False) for table in (a, b))
    usable = np.isfinite(x) & np.isfinite(y)
    return x[usable], y[usable]
