"""Normal distribution without its tails, by quantile: the unit numbers are spread over what the bounds leave.

Source: Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), section 13.10.1.
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from edl6dof.campaign.design.distributions.base import Spread, inside
from edl6dof.config.base import REQUIRED, param
from edl6dof.registry import Member
from edl6dof.spatial.arrays import normal_quantile, normal_share


class TruncatedNormal(Spread):
    """Normal distribution without the values outside two bounds."""

    kind: Literal["truncated_normal"] = param(REQUIRED, "normal, cut off")
    mean: float | None = param(None, "mean before the cut; the nominal value if not given")
    low: float | None = param(None, "lowest value")
    high: float | None = param(None, "highest value")

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        if self.low is None and self.high is None:
            raise ValueError("must give low, high or both; without bounds it is kind normal")
        if self.low is not None and self.high is not None and self.low >= self.high:
            raise ValueError(f"low must be below high (got {self.low:g} and {self.high:g})")
        return self

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Values of unit numbers."""
        mean, sigma = nominal if self.mean is None else self.mean, self.deviation(nominal)
        low, high = (
            (bound - mean) / sigma if bound is not None else end
            for bound, end in ((self.low, -np.inf), (self.high, np.inf))
        )
        # shares near 1 lose digits: an upper tail is drawn as the lower tail of the mirror image
        side = -1.0 if low > 0.0 else 1.0
        below, above = sorted((side * low, side * high))
        first, last = normal_share(below), normal_share(above)
        if not last - first > 1e-9:
            raise ValueError("low and high leave nothing of the distribution")
        share = inside(unit if side > 0.0 else 1.0 - unit)
        values = mean + sigma * side * normal_quantile(first + share * (last - first))
        return np.clip(values, self.low, self.high)  # the last bit may be outside


MEMBER = Member(
    "truncated_normal",
    TruncatedNormal,
    {},
    "Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), section 13.10.1",
)
