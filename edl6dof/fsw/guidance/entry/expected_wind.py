"""The mean wind that is expected before the flight: what the aim point and the angle of attack in the air
allow for.

It is the climatology of the table that the believed air is read from, and no part of it follows the wind that
blows.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param


class ExpectedWindParams(Params):
    """Mean wind against height: a factor on the winds of a table, and a wind that is the same everywhere."""

    table_factor: float = param(
        1.0,
        "factor on the mean wind of the table that atmosphere.table names; without one there is none",
        record=False,
        ge=-10.0,
        le=10.0,
    )
    north_m_s: float = param(
        0.0,
        "wind towards north at all heights, besides",
        record=False,
        ge=-200.0,
        le=200.0,
        usual=(-150, 150, "jet streams"),
    )
    east_m_s: float = param(
        0.0,
        "wind towards east at all heights, besides",
        record=False,
        ge=-200.0,
        le=200.0,
        usual=(-150, 150, "jet streams"),
    )
