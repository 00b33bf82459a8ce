"""One of several values, by inversion of their cumulative weights.

Source: Devroye, Non-Uniform Random Variate Generation (1986), section III.2.1.
"""

from __future__ import annotations

from typing import Any, Literal, Self

import numpy as np
from pydantic import model_validator

from edl6dof.campaign.design.distributions.base import DistributionParams
from edl6dof.config.base import REQUIRED, param
from edl6dof.registry import Member


class Discrete(DistributionParams):
    """One of several values: numbers, or names such as that of a guidance law."""

    kind: Literal["discrete"] = param(REQUIRED, "one of several values")
    choices: list[Any] = param(REQUIRED, "the values", min_length=1)
    weights: list[float] | None = param(
        None, "how likely each is, relative to the others; all alike if not given", min_length=1
    )

    @model_validator(mode="after")
    def _weights_fit(self) -> Self:
        weights = self.weights
        if weights is not None and (
            len(weights) != len(self.choices) or min(weights) < 0.0 or not sum(weights) > 0.0
        ):
            raise ValueError(f"weights must be {len(self.choices)} numbers, none negative and not all zero")
        return self

    @property
    def alternatives(self) -> list[Any]:
        """The values."""
        return self.choices

    def values(self, unit: np.ndarray, nominal: Any) -> np.ndarray:
        """Values of unit numbers."""
        weights = np.ones(len(self.choices)) if self.weights is None else np.asarray(self.weights)
        steps = np.cumsum(weights) / np.sum(weights)
        chosen = np.minimum(np.searchsorted(steps, unit, side="right"), len(self.choices) - 1)
        found = np.empty(len(unit), object)
        found[:] = [self.choices[index] for index in chosen]
        return found


MEMBER = Member(
    "discrete", Discrete, {}, "Devroye, Non-Uniform Random Variate Generation (1986), section III.2.1"
)
