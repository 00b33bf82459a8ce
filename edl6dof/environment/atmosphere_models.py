"""Models of the air against altitude that a scenario may name as ``atmosphere.model``.

Source: exponential: hydrostatics of an ideal gas, Anderson, Introduction to Flight (1989), eq. 3.9.  Table:
the source of its csv; slopes: Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.  Seasonal:
Withers, Space Science Reviews 170 (2012) 837-860 (pressure); Allison and McEwen, Planetary and Space Science
48 (2000) 215-235 (season and hour); hydrostatics, see :mod:`edl6dof.environment.hydrostatic`.  us76: U.S.
Standard Atmosphere, 1976, NOAA/NASA/USAF, table 4 and eq. 18, 23, 33a, 33b, 42, 50.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import REQUIRED, Params, group, param
from edl6dof.environment.atmosphere_table import row_at
from edl6dof.environment.gas import pressure_and_sound
from edl6dof.environment.profiles import cubic, integral, straight_beyond
from edl6dof.kernels import kernel
from edl6dof.registry import Family, Member
from edl6dof.spatial.elementary import exp, pow
from edl6dof.spatial.table_index import between, held


class TableParams(Params):
    """The table that ``atmosphere.table`` names."""


@kernel
def table_air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    row, t = row_at(table, alt)
    inside = held(t)
    rho = exp(cubic(table.ln_density, row, inside) + straight_beyond(table.ln_density, row, t))
    temperature = cubic(table.temperature, row, inside)
    pressure, sound = pressure_and_sound(gas, rho, temperature)
    return rho, pressure, temperature, sound


TABLE = Member(
    "table", TableParams, {"air": table_air}, "Fritsch and Butland (1984), and the source of the table"
)


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
        "temperature; model none has it too, for a finite Mach number",
        gt=0.0,
        usual=(30, 800, "Pluto to Venus"),
    )


@kernel
def exponential_air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    temperature = atm.exponential.temperature
    rho = atm.exponential.density * exp(-alt / atm.exponential.scale_height)
    pressure, sound = pressure_and_sound(gas, rho, temperature)
    return rho, pressure, temperature, sound


EXPONENTIAL = Member(
    "exponential",
    ExponentialParams,
    {"air": exponential_air},
    "Anderson, Introduction to Flight (1989), eq. 3.9",
)


US76_GAS_CONSTANT = 8314.32 / 28.9644  # J/(kg K): 287.05287
US76_HEAT_CAPACITY_RATIO = 1.4
_RADIUS = 6356766.0  # m, effective Earth radius of the geopotential
_HYDROSTATIC = 9.80665 / US76_GAS_CONSTANT  # K/m

_BASE = np.array([0.0, 11e3, 20e3, 32e3, 47e3, 51e3, 71e3])  # m, geopotential
_LAPSE = np.array([-6.5e-3, 0.0, 1e-3, 2.8e-3, 0.0, -2.8e-3, -2e-3])  # K/m


def _layers() -> tuple[np.ndarray, np.ndarray]:
    """Temperature (K) and pressure (Pa) at the base of each layer."""
    temperature, pressure = [288.15], [101325.0]
    for thickness, lapse in zip(np.diff(_BASE), _LAPSE[:-1], strict=True):
        t0 = temperature[-1]
        temperature.append(t0 + lapse * thickness)
        ratio = (
            pow(temperature[-1] / t0, -_HYDROSTATIC / lapse) if lapse else exp(-_HYDROSTATIC * thickness / t0)
        )
        pressure.append(pressure[-1] * ratio)
    return np.array(temperature), np.array(pressure)


_TEMPERATURE, _PRESSURE = _layers()


class Us76Params(Params):
    """U.S. Standard Atmosphere 1976, with its own gas constants."""


@kernel
def us76_air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at geometric altitude ``alt``, m."""
    height = _RADIUS * alt / (_RADIUS + alt)
    layer = 0
    while layer < 6 and height >= _BASE[layer + 1]:
        layer += 1
    above = height - _BASE[layer]
    t0 = _TEMPERATURE[layer]
    lapse = _LAPSE[layer]
    temperature = t0 + lapse * above
    if lapse == 0.0:
        pressure = _PRESSURE[layer] * exp(-_HYDROSTATIC * above / t0)
    else:
        # The last layer would reach 0 K at 178 km; holding 1 K keeps a stray flight finite.
        temperature = max(temperature, 1.0)
        pressure = _PRESSURE[layer] * pow(temperature / t0, -_HYDROSTATIC / lapse)
    rt = US76_GAS_CONSTANT * temperature
    return pressure / rt, pressure, temperature, sqrt(US76_HEAT_CAPACITY_RATIO * rt)


US76 = Member("us76", Us76Params, {"air": us76_air}, "U.S. Standard Atmosphere, 1976, NOAA/NASA/USAF")


class NoneParams(Params):
    """No air, at the temperature of model exponential."""


@kernel
def no_air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m."""
    temperature = atm.exponential.temperature
    pressure, sound = pressure_and_sound(gas, 0.0, temperature)
    return 0.0, pressure, temperature, sound


NONE = Member("none", NoneParams, {"air": no_air}, "null member")


class TemperatureWavesParams(Params):
    """Random temperature profile of a case: a Gauss-Markov sequence of altitude."""

    enabled: bool = param(False, "true: temperature is perturbed", record=False)
    sigma_k: float = param(3.0, "sigma of the temperature", status="estimate", record=False, ge=0.0, le=50.0)
    correlation_length_m: float = param(
        8000.0,
        "altitude over which the correlation falls to 1/e",
        status="estimate",
        record=False,
        ge=500.0,
    )


class SeasonalParams(Params):
    """Air of the landing site in the season and at the hour of initial.epoch_utc; needs planet.climate."""

    lapse_rate_k_m: float = param(
        2.5e-3,
        "rise of temperature per metre downwards, below the table",
        status="recalled",
        source="mean of the lower atmosphere of Mars, Zurek et al. 1992",
        record=False,
        ge=-0.02,
        le=0.02,
    )
    diurnal_amplitude_k: float = param(
        12.0,
        "largest excess of the temperature near the ground over its daily mean",
        status="estimate",
        source="of the lowest kilometre, Smith et al. 2006 (Mini-TES)",
        record=False,
        ge=0.0,
        le=80.0,
    )
    diurnal_depth_m: float = param(
        2000.0,
        "height above ground over which this excess falls by e",
        status="estimate",
        record=False,
        gt=0.0,
    )
    warmest_hour: float = param(
        15.0, "local true solar time of the warmest air, h", status="estimate", record=False, ge=0.0, le=24.0
    )
    surface_pressure_factor: float = param(
        1.0,
        "true pressure at the ground divided by that of the climate, which the flight computer assumes",
        record=False,
        gt=0.0,
        le=10.0,
    )
    temperature_bias_k: float = param(
        0.0,
        "excess of the true temperature over the climate at every height; not known on board",
        record=False,
        ge=-100.0,
        le=100.0,
        usual=(-30, 30, "profiles of other seasons and places"),
    )
    temperature_perturbation: TemperatureWavesParams = group(
        TemperatureWavesParams, "random temperature profile; not known on board", record=False
    )

    @property
    def undispersed(self) -> SeasonalParams:
        """Parameters without dispersions: the mean climate."""
        fields = ("surface_pressure_factor", "temperature_bias_k", "temperature_perturbation")
        return SeasonalParams(**{name: value for name, value in self if name not in fields})


@kernel
def seasonal_air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m above the areoid;
    isothermal beyond the table.
    """
    row, t = row_at(table, alt)
    inside = held(t)
    column = atm.column
    s = cubic(column.inverse_scale_height, row, inside)
    fallen = integral(column.inverse_scale_height, row, inside) + (t - inside) * s
    temperature = between(table.climate.gravity, row, inside) / (gas.gas_constant * s)
    pressure = exp(column.ln_pressure[row] - fallen / table.per_step)
    rho = pressure / (gas.gas_constant * temperature)
    pressure, sound = pressure_and_sound(gas, rho, temperature)
    return rho, pressure, temperature, sound


SEASONAL = Member(
    "seasonal",
    SeasonalParams,
    {"air": seasonal_air},
    "Withers (2012); Allison and McEwen (2000); hydrostatics",
)


ATMOSPHERES = Family("atmosphere", (TABLE, EXPONENTIAL, US76, NONE, SEASONAL))

AtmosphereChoice = ATMOSPHERES.params_model(
    "AtmosphereChoice", "model", "table", "Model of the air.", bare=True
)

#: ``(index, atmosphere, gas, table, altitude)`` to density kg/m3, pressure Pa, temperature K and speed of
#: sound m/s.
air_of_model = ATMOSPHERES.switch("air", "atm", "gas", "table", "alt")
