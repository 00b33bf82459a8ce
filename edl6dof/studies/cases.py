"""Dispersed flights of one scenario: Gaussian draws of its parameters, flown by the campaign's executor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa


@dataclass(frozen=True)
class Spread:
    """Gaussian dispersion of the true value of one parameter, named by its dotted path."""

    path: str
    mean: float
    three_sigma: float


def draw(spreads: Sequence[Spread], runs: int, seed: int) -> list[dict[str, float]]:
    """True values of ``runs`` flights by dotted path; the first flights of a longer series are those of a
    shorter one.
    """
    normal = np.random.default_rng(seed).standard_normal((runs, len(spreads)))
    return [
        {s.path: s.mean + s.three_sigma / 3.0 * float(x) for s, x in zip(spreads, row, strict=True)}
        for row in normal
    ]


def values(table: pa.Table, name: str) -> np.ndarray:
    """A column as floats; what a flight did not reach is NaN, so that no bound on it is kept."""
    return np.array([np.nan if x is None else x for x in table[name].to_pylist()], dtype=float)
