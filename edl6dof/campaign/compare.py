"""Two campaigns on common random numbers: the same cases flown by two configurations, difference by
difference.

What both share cancels in a pair, so a small difference shows with few flights.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from scipy.special import stdtrit
from scipy.stats import binomtest

from edl6dof.campaign.design.case import BELIEF, TRUTH
from edl6dof.campaign.statistics import Proportion
from edl6dof.campaign.store import Store
from edl6dof.config.errors import refusal

#: Columns of the end of a case, which are no figures.
_ENDS = {"case", "success", "cause", "outcome", "profile"}


@dataclass(frozen=True)
class Difference:
    """Mean of a figure in both, and of the paired difference B - A with its 95 % interval; ``clear`` where no
    difference is excluded at 95 % for all figures together.
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
    """Comparison of two campaigns.

    Attributes:
        counts: pairs in which both succeed, A alone, B alone, neither.
        p_value: probability of a split of the single successes at least as uneven if the two configurations
            do not differ (McNemar, exact).
    """

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


def compare(first: Store, second: Store) -> Comparison:
    """Pair the cases of two campaigns.

    Raises:
        ConfigError: they did not fly the same cases.
    """
    a, b = first.table().sort_by("case"), second.table().sort_by("case")
    cases = np.intersect1d(a["case"].to_numpy(), b["case"].to_numpy())
    a, b = (table.filter(pc.is_in(table["case"], pa.array(cases))) for table in (a, b))
    names = (first.folder.name, second.folder.name)
    _require_common(a, b, first, second)
    x, y = (table["success"].to_numpy(zero_copy_only=False) for table in (a, b))
    both, only_a, only_b, neither = (int(np.sum(pair)) for pair in (x & y, x & ~y, ~x & y, ~(x | y)))
    success, single = (Proportion.of(x), Proportion.of(y)), only_a + only_b
    p_value = float(binomtest(only_a, single).pvalue) if single else 1.0
    counts = both, only_a, only_b, neither
    return Comparison(names, success, counts, p_value, tuple(_differences(a, b)))


def _require_common(a: pa.Table, b: pa.Table, first: Store, second: Store) -> None:
    """Every quantity that both disperse must have the same values: only then are these pairs."""
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
    """A figure in those pairs in which both have it; nothing where a column is no figure."""
    numeric = name in b.column_names and all(pa.types.is_floating(table[name].type) for table in (a, b))
    if not numeric or name in _ENDS or name.startswith((TRUTH, BELIEF)):
        return np.empty(0), np.empty(0)
    x, y = (table[name].to_numpy(zero_copy_only=False) for table in (a, b))
    usable = np.isfinite(x) & np.isfinite(y)
    return x[usable], y[usable]
