"""Wind that grows linearly with altitude.

Source: NASA/TM-2015-218675 (NESC check cases), case 8.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class ShearParams(Params):
    """Wind that grows linearly with altitude."""

    east_m_s: float = param(
        0.0, "wind towards east at altitude 0", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams")
    )
    north_m_s: float = param(
        0.0, "wind towards north at altitude 0", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams")
    )
    east_shear: float = param(
        0.0,
        "growth of the wind towards east, (m/s) per metre of altitude",
        ge=-1.0,
        le=1.0,
        usual=(-0.05, 0.05, "strong shear is 0.01 to 0.03 1/s"),
    )
    north_shear: float = param(
        0.0,
        "growth of the wind towards north, (m/s) per metre of altitude",
        ge=-1.0,
        le=1.0,
        usual=(-0.05, 0.05, "strong shear is 0.01 to 0.03 1/s"),
    )


@kernel
def mean(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    shear = wind.shear
    return shear.east + shear.east_shear * alt, shear.north + shear.north_shear * alt


MEMBER = Member("shear", ShearParams, {"mean": mean}, "NASA/TM-2015-218675, check case 8")
