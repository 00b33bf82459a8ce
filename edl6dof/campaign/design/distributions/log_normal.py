"""Log-normal distribution.

Source: Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), chapter 14.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from edl6dof.campaign.design.distributions.base import DistributionParams, deviates
from edl6dof.config.base import REQUIRED, param
from edl6dof.registry import Member
from edl6dof.spatial import arrays


class LogNormal(DistributionParams):
    """The logarithm is normal: a factor up is as likely as the same factor down."""

    kind: Literal["log_normal"] = param(REQUIRED, "log-normal")
    median: float | None = param(None, "median; the nominal value if not given", gt=0.0)
    sigma_ln: float = param(REQUIRED, "standard deviation of the natural logarithm", gt=0.0, le=5.0)

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Values of unit numbers."""
        median = nominal if self.median is None else self.median
        if not median > 0.0:
            raise ValueError(f"needs a positive median (the nominal value is {median:g})")
        return median * arrays.exp(self.sigma_ln * deviates(unit))


MEMBER = Member(
    "log_normal",
    LogNormal,
    {},
    "Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), chapter 14",
)
