"""No air: density and pressure vanish; temperature and speed of sound keep the Mach number finite.

Source: none, this is the null member of the family.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.environment.gas import pressure_and_sound
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class NoneParams(Params):
    """No air, at the temperature of model exponential."""


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    temperature = atm.exponential.temperature
    pressure, sound = pressure_and_sound(gas, 0.0, temperature)
    return 0.0, pressure, temperature, sound


MEMBER = Member("none", NoneParams, {"air": air}, "null member")
