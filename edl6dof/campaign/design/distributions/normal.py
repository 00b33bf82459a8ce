"""Normal distribution.

Source: Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), chapter 13.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from edl6dof.campaign.design.distributions.base import Spread, deviates
from edl6dof.config.base import REQUIRED, param
from edl6dof.registry import Member


class Normal(Spread):
    """Normal distribution."""

    kind: Literal["normal"] = param(REQUIRED, "normal")
    mean: float | None = param(None, "mean; the nominal value if not given")

    def values(self, unit: np.ndarray, nominal: float) -> np.ndarray:
        """Values of unit numbers."""
        mean = nominal if self.mean is None else self.mean
        return mean + self.deviation(nominal) * deviates(unit)


MEMBER = Member(
    "normal",
    Normal,
    {},
    "Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1 (1994), chapter 13",
)
