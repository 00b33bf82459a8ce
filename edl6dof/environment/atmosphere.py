"""Density, pressure, temperature and speed of sound against height above the areoid: one of several
models, with a bias and an optional random perturbation of density.
"""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, group, param
from edl6dof.config.document.regular import read_regular
from edl6dof.config.dtype import fill
from edl6dof.environment.atmosphere_table import (
    MAX_ROWS,
    AirInputs,
    cubic,
    cubic_coefficients,
    row_at,
    table_path,
)
from edl6dof.environment.atmospheres.registry import ATMOSPHERES, AtmosphereChoice, air_of_model
from edl6dof.environment.layout import extended
from edl6dof.environment.planet import PlanetParams
from edl6dof.environment.profiles import DENSITY_STREAM, central_slopes, gauss_markov, stream
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import held

#: Lowest factor that a perturbation may put on density: reached only where sigma is above 30 %, beyond 100 km
#: (sigma_scale 1).
_LEAST = 0.05


class PerturbationParams(Params):
    """Random density profile of a case: relative sigma of the table times a Gauss-Markov sequence of
    altitude.
    """

    enabled: bool = param(False, "whether density is perturbed")
    sigma_scale: float = param(1.0, "factor on the sigma of the table", ge=0.0, le=5.0)
    sigma: float = param(0.02, "relative sigma when the table has none", status="estimate", ge=0.0, le=0.5)
    correlation_length_m: float = param(
        5000.0, "altitude over which the correlation falls to 1/e", status="estimate", ge=500.0
    )


class AtmosphereParams(AtmosphereChoice):
    """Atmosphere of the truth."""

    moved: ClassVar = {
        "gas_constant_j_kg_k": "planet.gas.gas_constant_j_kg_k",
        "heat_capacity_ratio": "planet.gas.heat_capacity_ratio",
    }

    table: str = param(
        "",
        (
            "csv in edl6dof/data/atmosphere, or an absolute path; empty for none. Also the source of winds "
            "and of density sigma"
        ),
        record=False,
    )
    bottom_m: float = param(
        -8000.0,
        (
            "height above the areoid down to which the table is extended, and the flight computer knows the "
            "air at least"
        ),
        record=False,
        ge=-50e3,
        le=0.0,
    )
    top_m: float = param(
        150e3,
        "height above the areoid up to which the flight computer knows the air at least",
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
    density_factor: float = param(1.0, "bias factor on density and pressure", gt=0.0, le=10.0)
    perturbation: PerturbationParams = group(PerturbationParams, "random density profile")

    @model_validator(mode="after")
    def _has_what_its_model_needs(self) -> Self:
        section = "exponential" if self.model == "none" else self.model
        if section in AtmosphereChoice.model_fields and getattr(self, section) is None:
            params = ATMOSPHERES.member(section).params
            keys = ", ".join(f"{key}: ..." for key, info in params.model_fields.items() if info.is_required())
            raise ValueError(f"model {self.model!r} needs {section}: {{{keys}}}")
        return self


#: The parameters, and the relative density change of this case: cubics between the rows of the shared table.
ATMOSPHERE = extended(AtmosphereParams, density_change=("f8", (MAX_ROWS - 1, 4)))


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at ``alt``, m above the areoid.

    ``gas``: the ``GAS`` record of the planet.
    """
    rho, pressure, temperature, sound = air_of_model(atm.model, atm, gas, table, alt)
    factor = atm.density_factor
    if atm.perturbation.enabled:
        row, t = row_at(table, alt)
        factor *= max(1.0 + cubic(atm.density_change, row, held(t)), _LEAST)
    return rho * factor, pressure * factor, temperature, sound


def air_inputs(params: AtmosphereParams, planet: PlanetParams) -> AirInputs:
    """What the table that all cases share follows from.

    Raises:
        ValueError: there must be a table and none is named.
        OSError: its file cannot be read.
    """
    if params.model == "table" and not params.table:
        raise ValueError("atmosphere model table needs a table file")
    return AirInputs(
        params.table,
        read_regular(table_path(params.table)) if params.table else b"",
        params.bottom_m,
        max(params.top_m, 200e3),
        planet.gas.gas_constant_j_kg_k,
        params.extension_gravity_m_s2 or planet.gravity.mu_m3_s2 / planet.mean_radius_m**2,
        params.perturbation.sigma,
    )


def fill_atmosphere(
    record: np.void, params: AtmosphereParams, table: np.void, seed: int = 0, case: int = 0
) -> None:
    """Copy the parameters and draw the density profile that belongs to (seed, case)."""
    fill(record, params)
    record["density_change"] = 0.0
    chosen = params.perturbation
    if chosen.enabled:
        rows = int(table["rows"])
        spacing = 1.0 / (float(table["per_step"]) * chosen.correlation_length_m)
        normal = gauss_markov(stream(seed, case, DENSITY_STREAM), rows, spacing)
        change = chosen.sigma_scale * table["sigma"][:rows] * normal
        record["density_change"][: rows - 1] = cubic_coefficients(change, central_slopes(change))
