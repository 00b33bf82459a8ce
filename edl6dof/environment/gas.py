"""The gas of a planet's atmosphere: what the air, the flow around the vehicle and the heating take from its
molecules.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.config.base import REQUIRED, Params, param
from edl6dof.config.dtype import dtype_of
from edl6dof.jit import kernel


class GasParams(Params):
    """Gas of the atmosphere, a calorically perfect one; part of the planet file."""

    gas_constant_j_kg_k: float = param(
        REQUIRED, "specific gas constant", status="published", source="planet file", gt=50.0, lt=5000.0
    )
    heat_capacity_ratio: float = param(
        REQUIRED,
        "ratio of specific heats of the air at rest: speed of sound",
        status="published",
        source="planet file",
        gt=1.0,
        lt=1.7,
    )
    shock_layer_heat_capacity_ratio: float = param(
        REQUIRED, "ratio of specific heats behind the bow shock: stagnation pressure", status="estimate",
        source="planet file",
        record=False, gt=1.0, lt=1.7,
    )  # fmt: skip
    molecular_diameter_m: float = param(
        REQUIRED,
        "hard-sphere diameter of the molecule: mean free path",
        status="recalled",
        source="planet file",
        gt=0.0,
        le=1e-6,
    )
    molecular_mass_kg: float = param(
        REQUIRED,
        "mean mass of a molecule: mean free path",
        status="derived",
        source="planet file",
        gt=0.0,
        le=1e-20,
    )
    sutton_graves_constant: float = param(
        REQUIRED, ("convective heating at the stagnation point: heat flux / (sqrt(density / nose radius) "
            "speed^3), kg^0.5/m"),
        status="published", source="planet file", gt=0.0, le=1.0,
    )  # fmt: skip


GAS = dtype_of(GasParams)


@kernel
def pressure_and_sound(gas, rho, temperature):
    """Pressure (Pa) and speed of sound (m/s) of the ideal gas at ``rho`` (kg/m3) and ``temperature`` (K)."""
    rt = gas.gas_constant * temperature
    return rho * rt, sqrt(gas.heat_capacity_ratio * rt)


@kernel
def inverse_knudsen_number(gas, rho, length):
    """``length`` (m) in mean free paths of hard spheres, lambda = m / (sqrt(2) pi d^2 rho), at ``rho``
    (kg/m3).
    """
    return sqrt(2.0) * pi * gas.molecular_diameter**2 * rho * length / gas.molecular_mass


@kernel
def stagnation_heat_flux(gas, rho, nose_radius, speed):
    """Convective heat flux (W/m2) at the stagnation point.

    Source: Sutton and Graves, NASA TR R-376 (1971).
    """
    return gas.sutton_graves_constant * sqrt(rho / nose_radius) * speed * speed * speed
