"""Sobol indices of a figure, from flights of the design of :mod:`edl6dof.campaign.design.saltelli`.

First-order: the share of the variance that goes when a group of inputs is known.  Total: the share that stays
when all others are known; above the first-order index by what the group does together with others.

Sources: Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, table 2, b and f; Jansen, Comput. Phys.
Commun. 117 (1999) 35; intervals by the bootstrap over rows, Archer et al., J. Stat. Comput. Simul. 58 (1997)
99.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from edl6dof.campaign.quantiles import CONFIDENCE

#: Designs drawn again from the rows.
_REDRAWN = 400

#: Fewest rows from which indices are formed.
FEWEST = 16


@dataclass(frozen=True)
class Index:
    """Indices of a group, each with the ends of its 95 % interval: (value, low, high)."""

    name: str
    first: tuple[float, float, float]
    total: tuple[float, float, float]


def sobol_indices(a: np.ndarray, b: np.ndarray, swapped: Mapping[str, np.ndarray]) -> list[Index]:
    """Indices of each group, the largest total first; none where rows are too few or the figure stands still.

    Args:
        a: the figure of the flights of matrix A, shape (rows,); NaN where a flight has none.
        b: of matrix B.
        swapped: of A with a group from B, by the name of the group.
    """
    every = np.stack([a, b, *swapped.values()])
    every = every[:, np.isfinite(every).all(axis=0)]
    rows = every.shape[1]
    if rows < FEWEST or np.ptp(every[:2]) == 0.0:
        return []
    picks = np.random.default_rng(0).integers(rows, size=(_REDRAWN, rows))
    tail = 0.5 * (1.0 - CONFIDENCE)
    values = _indices(every[:, None, :])[:, :, 0]
    low, high = np.quantile(_indices(every[:, picks]), (tail, 1.0 - tail), axis=2)
    first, total = (
        [(float(value), float(start), float(end)) for value, start, end in zip(*kind, strict=True)]
        for kind in zip(values, low, high, strict=True)
    )
    found = [Index(*index) for index in zip(swapped, first, total, strict=True)]
    return sorted(found, key=lambda index: -index.total[0])


def _indices(figure: np.ndarray) -> np.ndarray:
    """First-order and total indices, shape (2, groups, samples), of figures of shape (2 + groups, samples,
    rows).
    """
    spread = np.concatenate([figure[0], figure[1]], axis=-1)
    a, b, swapped = figure[0], figure[1] - spread.mean(axis=-1, keepdims=True), figure[2:]
    variance = np.maximum(spread.var(axis=-1), np.finfo(float).tiny)
    first = np.mean(b * (swapped - a), axis=-1) / variance
    total = 0.5 * np.mean((a - swapped) ** 2, axis=-1) / variance
    return np.stack([first, total])
