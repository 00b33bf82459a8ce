"""The same wind at all altitudes.

Source: NASA/TM-2015-218675 (NESC check cases), case 7.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class ConstantParams(Params):
    """The same wind at all altitudes."""

    east_m_s: float = param(0.0, "wind towards east", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams"))
    north_m_s: float = param(0.0, "wind towards north", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams"))


@kernel
def mean(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    return wind.constant.east, wind.constant.north


MEMBER = Member("constant", ConstantParams, {"mean": mean}, "NASA/TM-2015-218675, check case 7")
