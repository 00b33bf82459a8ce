"""No mean wind.

Source: none, this is the null member of the family.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class NoneParams(Params):
    """No mean wind."""


@kernel
def mean(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    return 0.0, 0.0


MEMBER = Member("none", NoneParams, {"mean": mean}, "null member")
