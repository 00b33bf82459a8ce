"""Models of the mean wind against altitude that a scenario may name as ``wind.model``.

Source: constant and shear: NASA/TM-2015-218675 (NESC check cases), cases 7 and 8; table: the source of its
csv.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.environment.atmosphere_table import row_at
from edl6dof.environment.profiles import cubic
from edl6dof.kernels import kernel
from edl6dof.registry import Family, Member
from edl6dof.spatial.table_index import held


class TableParams(Params):
    """The winds of the table that ``atmosphere.table`` names."""


@kernel
def table_wind(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    row, t = row_at(table, alt)
    inside = held(t)
    return cubic(table.east, row, inside), cubic(table.north, row, inside)


TABLE = Member("table", TableParams, {"mean": table_wind}, "the source of the table")


class ConstantParams(Params):
    """The same wind at all altitudes."""

    east_m_s: float = param(0.0, "wind towards east", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams"))
    north_m_s: float = param(0.0, "wind towards north", ge=-200.0, le=200.0, usual=(-150, 150, "jet streams"))


@kernel
def constant_wind(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    return wind.constant.east, wind.constant.north


CONSTANT = Member("constant", ConstantParams, {"mean": constant_wind}, "NASA/TM-2015-218675, check case 7")


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
def shear_wind(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    shear = wind.shear
    return shear.east + shear.east_shear * alt, shear.north + shear.north_shear * alt


SHEAR = Member("shear", ShearParams, {"mean": shear_wind}, "NASA/TM-2015-218675, check case 8")


class NoneParams(Params):
    """No mean wind."""


@kernel
def no_wind(wind, table, alt):
    """Wind towards east and north, m/s, at ``alt``, m."""
    return 0.0, 0.0


NONE = Member("none", NoneParams, {"mean": no_wind}, "null member")


WINDS = Family("mean wind", (TABLE, CONSTANT, SHEAR, NONE))

WindChoice = WINDS.params_model("WindChoice", "model", "table", "Model of the mean wind.", bare=True)

#: ``(index, wind, table, altitude)`` to the mean wind towards east and north, m/s.
wind_of_model = WINDS.switch("mean", "wind", "table", "alt")
