"""Mean wind of the table of the atmosphere; beyond its ends the end value.

Source: that of the table.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.environment.atmosphere_table import row_at
from edl6dof.environment.curves import cubic
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.table_index import held


class TableParams(Params):
    """The winds of the table that ``atmosphere.table`` names."""


@kernel
def mean(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    row, t = row_at(table, alt)
    inside = held(t)
    return cubic(table.east, row, inside), cubic(table.north, row, inside)


MEMBER = Member("table", TableParams, {"mean": mean}, "the source of the table")
