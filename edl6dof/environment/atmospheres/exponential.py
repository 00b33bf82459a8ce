"""Isothermal air: density falls by e every scale height above the areoid; a uniform one is a very large scale
height.

Source: hydrostatics of an ideal gas, Anderson, Introduction to Flight (1989), eq. 3.9.
"""

from __future__ import annotations

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.environment.gas import pressure_and_sound
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp


class ExponentialParams(Params):
    """Isothermal atmosphere, and the temperature of model none."""

    density_kg_m3: float = param(
        REQUIRED, "density at altitude 0", gt=0.0, le=1e20, usual=(1e-6, 100, "Pluto to Venus")
    )
    scale_height_m: float = param(
        REQUIRED, "scale height", gt=0.0, le=1e16, usual=(3000, 80000, "Venus to Saturn")
    )
    temperature_k: float = param(
        REQUIRED,
        "temperature; also that of model none, for a finite Mach number",
        gt=0.0,
        usual=(30, 800, "Pluto to Venus"),
    )


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    temperature = atm.exponential.temperature
    rho = atm.exponential.density * exp(-alt / atm.exponential.scale_height)
    pressure, sound = pressure_and_sound(gas, rho, temperature)
    return rho, pressure, temperature, sound


MEMBER = Member(
    "exponential", ExponentialParams, {"air": air}, "Anderson, Introduction to Flight (1989), eq. 3.9"
)
