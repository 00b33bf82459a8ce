"""Air of a place, a season and an hour: a column in hydrostatic balance on the pressure that the planet's
climate gives the ground.

Temperature is that of ``atmosphere.table``, with a lapse rate below it and a near-surface term that follows
the hour.
Source: Withers, Space Science Reviews 170 (2012) 837-860 (pressure); Allison and McEwen, Planetary and Space
Science 48 (2000) 215-235 (season and hour); hydrostatics, see :mod:`edl6dof.environment.column`.
"""

from __future__ import annotations

from edl6dof.config.base import Params, group, param
from edl6dof.environment.atmosphere_table import row_at
from edl6dof.environment.curves import cubic, integral
from edl6dof.environment.gas import pressure_and_sound
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.table_index import between, held


class TemperatureWavesParams(Params):
    """Random temperature profile of a case: a Gauss-Markov sequence of altitude."""

    enabled: bool = param(False, "whether temperature is perturbed", record=False)
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
        "by which the air gets warmer downwards below the table",
        status="recalled",
        source="mean of the lower atmosphere of Mars, Zurek et al. 1992",
        record=False,
        ge=-0.02,
        le=0.02,
    )
    diurnal_amplitude_k: float = param(
        12.0,
        "how much warmer than in the daily mean the air near the ground is at its warmest",
        status="estimate",
        source="of the lowest kilometre, Smith et al. 2006 (Mini-TES)",
        record=False,
        ge=0.0,
        le=80.0,
    )
    diurnal_depth_m: float = param(
        2000.0, "height above ground over which that falls by e", status="estimate", record=False, gt=0.0
    )
    warmest_hour: float = param(
        15.0, "local true solar time of the warmest air, h", status="estimate", record=False, ge=0.0, le=24.0
    )
    surface_pressure_factor: float = param(
        1.0,
        "true pressure at the ground over that of the climate; the flight computer knows the climate",
        record=False,
        gt=0.0,
        le=10.0,
    )
    temperature_bias_k: float = param(
        0.0,
        "by which the true air is warmer than the climate at every height; not known on board",
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
        """The climate itself."""
        fields = ("surface_pressure_factor", "temperature_bias_k", "temperature_perturbation")
        return SeasonalParams(**{name: value for name, value in self if name not in fields})


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m above the areoid; beyond
    the table it is isothermal.
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


MEMBER = Member(
    "seasonal", SeasonalParams, {"air": air}, "Withers (2012); Allison and McEwen (2000); hydrostatics"
)
