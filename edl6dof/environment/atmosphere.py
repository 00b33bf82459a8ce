"""Density, pressure, temperature and speed of sound against height above the areoid: one of several
models, with a bias and an optional random perturbation of density.
"""

from __future__ import annotations

from typing import Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Key, Params, group, param, stated
from edl6dof.config.document.regular import read_regular
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.atmosphere_models import ATMOSPHERES, AtmosphereChoice, air_of_model
from edl6dof.environment.atmosphere_table import AirInputs, profile_path, row_at
from edl6dof.environment.hydrostatic import COLUMN, fill_column
from edl6dof.environment.planet import PlanetParams
from edl6dof.environment.profiles import (
    DENSITY_STREAM,
    MAX_ROWS,
    TEMPERATURE_STREAM,
    central_slopes,
    cubic,
    cubic_coefficients,
    gauss_markov,
)
from edl6dof.environment.site_climate import Place, climate_inputs
from edl6dof.kernels import kernel
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.table_index import held

#: Lowest factor that a perturbation may put on density: reached only where sigma is above 30 %, beyond 100 km
#: (sigma_scale 1).
_LEAST = 0.05


class PerturbationParams(Params):
    """Random density profile of a case: sigma of the table times a Gauss-Markov sequence in altitude."""

    enabled: bool = param(False, "true: density is perturbed")
    sigma_scale: float = param(1.0, "factor on the sigma of the table", ge=0.0, le=5.0)
    sigma: float = param(0.02, "relative sigma when the table has none", status="estimate", ge=0.0, le=0.5)
    correlation_length_m: float = param(
        5000.0, "altitude over which the correlation falls to 1/e", status="estimate", ge=500.0
    )


class AtmosphereParams(AtmosphereChoice):
    """True atmosphere."""

    table: str = param(
        "",
        (
            "name of one of profiles, csv in edl6dof/data/atmosphere, or an absolute path; empty for "
            "none. Also the source of winds and of density sigma"
        ),
        record=False,
    )
    profiles: dict[Key, str] = param(
        None,
        "names for csv files (as table), so that table, a sweep or a campaign may choose among them",
        record=False,
        factory=dict,
    )
    bottom_m: float = param(
        -8000.0,
        (
            "height above the areoid down to which the table is extended, and the air model of the flight "
            "computer reaches"
        ),
        record=False,
        ge=-50e3,
        le=0.0,
    )
    top_m: float = param(
        150e3,
        "height above the areoid up to which the air model of the flight computer reaches",
        record=False,
        gt=0.0,
        le=1e7,
    )
    extension_gravity_m_s2: float | None = param(
        None,
        "gravity of the hydrostatic extension below the table; mu / mean radius^2 when not given",
        record=False,
        gt=0.0,
    )
    density_factor: float = param(1.0, "factor on density and pressure", gt=0.0, le=10.0)
    perturbation: PerturbationParams = group(PerturbationParams, "random density profile")

    @model_validator(mode="after")
    def _has_what_its_model_needs(self) -> Self:
        section = "exponential" if self.model == "none" else self.model
        if section in AtmosphereChoice.model_fields and getattr(self, section) is None:
            params = ATMOSPHERES.member(section).params
            keys = ", ".join(f"{key}: ..." for key, info in params.model_fields.items() if info.is_required())
            raise ValueError(f"model {self.model!r} needs {section}: {{{keys}}}")
        return self

    @property
    def table_file(self) -> str:
        """The csv that ``table`` means; empty for none."""
        return self.profiles.get(self.table, self.table)

    @property
    def undispersed(self) -> Self:
        """Parameters without dispersions, as known before the flight: no random profile, and the mean
        climate.
        """
        quiet = self.perturbation.model_copy(update={"enabled": False})
        return self.model_copy(update={"perturbation": quiet, "seasonal": self.seasonal.undispersed})


#: The parameters; of this case, the relative density change (cubics between the rows of the shared table) and
#: the column of model seasonal.
ATMOSPHERE = extended(AtmosphereParams, density_change=("f8", (MAX_ROWS - 1, 4)), column=COLUMN)


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m above the areoid, in the
    air of a planet with this ``GAS`` record.
    """
    rho, pressure, temperature, sound = air_of_model(atm.model, atm, gas, table, alt)
    factor = atm.density_factor
    if atm.perturbation.enabled:
        row, t = row_at(table, alt)
        factor *= max(1.0 + cubic(atm.density_change, row, held(t)), _LEAST)
    return rho * factor, pressure * factor, temperature, sound


def air_inputs(params: AtmosphereParams, planet: PlanetParams, place: Place | None = None) -> AirInputs:
    """Gather the inputs of the table that all cases share; model seasonal needs ``place``.

    Raises:
        Inconsistent: model seasonal lacks the climate of the planet or the epoch.
        ValueError: the model needs a table and none is named.
        OSError: the file of the table cannot be read.
    """
    if params.model in ("table", "seasonal") and not params.table:
        raise ValueError(f"atmosphere model {params.model} needs a table file")
    return AirInputs(
        params.table_file,
        read_regular(profile_path(params.table_file)) if params.table else b"",
        params.bottom_m,
        max(params.top_m, 200e3),
        planet.gas.gas_constant_j_kg_k,
        params.extension_gravity_m_s2
        or planet.gravity.mu_m3_s2 / planet.mean_radius_m / planet.mean_radius_m,
        params.perturbation.sigma,
        climate_inputs(params.seasonal, planet, stated(place)) if params.model == "seasonal" else None,
    )


def fill_atmosphere(
    record: np.void, params: AtmosphereParams, table: np.void, seed: int = 0, case: int = 0
) -> None:
    """Fill an atmosphere ``record`` with the parameters, and with the random profiles of density and
    temperature of (``seed``, ``case``).
    """
    fill(record, params)
    record["density_change"] = 0.0
    rows, per_step = int(table["rows"]), float(table["per_step"])
    chosen = params.perturbation
    if chosen.enabled:
        spacing = 1.0 / (per_step * chosen.correlation_length_m)
        normal = gauss_markov(Stream(seed, case, DENSITY_STREAM), rows, spacing)
        change = chosen.sigma_scale * table["sigma"][:rows] * normal
        record["density_change"][: rows - 1] = cubic_coefficients(change, central_slopes(change))
    if params.model == "seasonal":
        seasonal, waves = params.seasonal, params.seasonal.temperature_perturbation
        warmer = np.full(rows, seasonal.temperature_bias_k)
        if waves.enabled:
            spacing = 1.0 / (per_step * waves.correlation_length_m)
            warmer += waves.sigma_k * gauss_markov(Stream(seed, case, TEMPERATURE_STREAM), rows, spacing)
        factor = seasonal.surface_pressure_factor
        fill_column(record["column"], table["climate"], rows, 1.0 / per_step, factor, warmer)
