"""Uniform distribution.

Source: Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 2 (1995), chapter 26.
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from edl6dof.campaign.design.distributions.base import DistributionParams
from edl6dof.config.base import REQUIRED, param, stated
from edl6dof.registry import Member


class Uniform(DistributionParams):
    """Every value between two bounds is equally likely."""

    kind: Literal["uniform"] = param(REQUIRED, "uniform")
    low: float | None = param(None, "lowest value")
    high: float | None = param(None, "highest value")
    half_width: float | None = param(
        None, "instead of low and high: greatest distance from the nominal value", gt=0.0
    )

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        given = (self.low is not None, self.high is not None, self.half_width is not None)
        if given not in ((True, True, False), (False, False, True)):
            raise ValueError("must give low and high, or half_width")
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise ValueError(f"low must be below high (got {self.low:g} and {self.high:g})")
        return self

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Values of unit numbers."""
        if self.half_width is None:
            low, high = stated(self.low), stated(self.high)
        else:
            low, high = nominal - self.half_width, nominal + self.half_width
        return low + unit * (high - low)


MEMBER = Member(
    "uniform",
    Uniform,
    {},
    "Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 2 (1995), chapter 26",
)
