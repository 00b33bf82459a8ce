"""Air of a table against altitude: density and temperature, interpolated so that their slopes are continuous.

Pressure is p = rho R T throughout.  The Mars-GRAM table holds density and temperature, and they balance the
weight of the air only to a few per cent (tides, rounding); p = rho R T is the choice that agrees with both
and keeps a^2 = gamma p / rho.
Source: that of the table; of the slopes, Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.environment.atmosphere_table import row_at
from edl6dof.environment.curves import cubic, straight_beyond
from edl6dof.environment.gas import pressure_and_sound
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.table_index import held


class TableParams(Params):
    """The table that ``atmosphere.table`` names."""


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    row, t = row_at(table, alt)
    inside = held(t)
    rho = exp(cubic(table.ln_density, row, inside) + straight_beyond(table.ln_density, row, t))
    temperature = cubic(table.temperature, row, inside)
    pressure, sound = pressure_and_sound(gas, rho, temperature)
    return rho, pressure, temperature, sound


MEMBER = Member("table", TableParams, {"air": air}, "Fritsch and Butland (1984), and the source of the table")
