"""Base of all distributions: each turns numbers in 0..1 into values by its inverse distribution function.

Inverse functions make every sampling plan (random, Latin hypercube, Sobol) serve every distribution.
"""

from __future__ import annotations

from typing import Any, Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, param, stated
from edl6dof.spatial.arrays import normal_quantile

#: Unit numbers are kept this far from 0 and 1, where a normal deviate is infinite: beyond 7 sigma.
_EDGE = 1e-12


class DistributionParams(Params):
    """Base of the parameters of a distribution; a field ``kind`` holds its name."""

    @property
    def alternatives(self) -> list[Any]:
        """The values, where there are a few that need not be numbers."""
        return []

    def values(self, unit: np.ndarray, nominal: Any) -> np.ndarray:
        """Values of numbers in 0..1, shape (n,), in the parameter's unit.

        Raises:
            ValueError: nothing can be drawn about this nominal value.
        """
        raise NotImplementedError


def deviates(unit: np.ndarray) -> np.ndarray:
    """Standard normal deviates of numbers in 0..1, finite at both ends."""
    return normal_quantile(inside(unit))


def inside(unit: np.ndarray) -> np.ndarray:
    """Numbers in 0..1 as near to both ends as every quantile function is finite."""
    return np.clip(unit, _EDGE, 1.0 - _EDGE)


class Spread(DistributionParams):
    """Width of a normal distribution, given in one of three ways."""

    sigma: float | None = param(None, "standard deviation, in the parameter's unit", gt=0.0)
    three_sigma: float | None = param(None, "three standard deviations, in the parameter's unit", gt=0.0)
    three_sigma_pct: float | None = param(None, "three standard deviations over the nominal value", gt=0.0)

    @model_validator(mode="after")
    def _one_width(self) -> Self:
        if sum(width is not None for width in (self.sigma, self.three_sigma, self.three_sigma_pct)) != 1:
            raise ValueError("must give exactly one of sigma, three_sigma, three_sigma_pct")
        return self

    def deviation(self, nominal: float) -> float:
        """Standard deviation about a nominal value."""
        if self.sigma is not None:
            return self.sigma
        if self.three_sigma is not None:
            return self.three_sigma / 3.0
        return abs(nominal) * stated(self.three_sigma_pct) / 300.0
