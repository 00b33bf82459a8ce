"""The gas of a planet's atmosphere: properties for the air, the flow around the vehicle and the heating.

Source: vibration of molecules as harmonic oscillators, Vincenti and Kruger, Introduction to Physical Gas
Dynamics (1965), chapter IV.12.
"""

from __future__ import annotations

from functools import lru_cache
from math import pi, sqrt
from typing import Annotated

import numpy as np

from edl6dof.config.base import REQUIRED, Capacity, Params, group, param
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.heating import RadiationParams
from edl6dof.environment.profiles import cubic, cubic_coefficients
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.table_index import cell

#: Kinds of vibration of one molecule: carbon dioxide has three, methane four.
MAX_VIBRATIONS = 4


class Vibration(Params):
    """Vibrations of a molecule with one characteristic temperature."""

    temperature_k: float = param(
        REQUIRED, "characteristic temperature, h c / k times the wave number", gt=0.0, le=20000.0
    )
    modes: int = param(1, "number of vibrations with this temperature", ge=1, le=9)


class GasParams(Params):
    """Gas of the atmosphere, a thermally perfect one; part of the planet file."""

    gas_constant_j_kg_k: float = param(
        REQUIRED,
        "specific gas constant",
        status="published",
        source="planet file",
        gt=50.0,
        lt=5000.0,
        usual=(60, 4300, "xenon to hydrogen"),
    )
    heat_capacity_ratio: float = param(
        REQUIRED,
        "ratio of specific heats of the cold gas, in which no molecule vibrates: speed of sound",
        status="published",
        source="planet file",
        gt=1.0,
        lt=1.7,
        usual=(1.05, 1.67, "polyatomic to monatomic gas"),
    )
    vibrations: Annotated[list[Vibration], Capacity(MAX_VIBRATIONS)] = param(
        None,
        "vibrations of the molecule, which lower that ratio as the temperature rises; empty: constant ratio",
        factory=list,
        max_length=MAX_VIBRATIONS,
    )
    shock_layer_heat_capacity_ratio: float = param(
        REQUIRED, "ratio of specific heats behind the bow shock: stagnation pressure", status="estimate",
        source="planet file",
        record=False, gt=1.0, lt=1.7,
    usual=(1.05, 1.67, "polyatomic to monatomic gas"))  # fmt: skip
    molecular_diameter_m: float = param(
        REQUIRED,
        "hard-sphere diameter of the molecule: mean free path",
        status="recalled",
        source="planet file",
        gt=0.0,
        le=1e-6,
        usual=(2e-10, 6e-10, "helium to heavy molecules"),
    )
    molecular_mass_kg: float = param(
        REQUIRED,
        "mean mass of a molecule: mean free path",
        status="derived",
        source="planet file",
        gt=0.0,
        le=1e-20,
        usual=(3e-27, 2.2e-25, "hydrogen to xenon"),
    )
    sutton_graves_constant: float = param(
        REQUIRED, ("convective heating at the stagnation point: heat flux / (sqrt(density / nose radius) "
            "speed^3), kg^0.5/m"),
        status="published", source="planet file", gt=0.0, le=1.0,
    usual=(3e-5, 0.001, "hydrogen to argon"))  # fmt: skip
    radiation: RadiationParams = group(RadiationParams, "radiative heating at the stagnation point")


#: Spacing (K) and number of the rows in which the ratio of specific heats is tabulated; cubics between them
#: err by less than 5e-7.
_STEP, _ROWS = 16.0, 64

#: The parameters, and the ratio of specific heats: cubics between rows of temperature.
GAS = extended(GasParams, ratio=("f8", (_ROWS - 1, 4)))


def fill_gas(record: np.void, params: GasParams) -> None:
    """Fill a ``GAS`` record: the parameters and, if the molecules vibrate, the ratio of specific heats over
    temperature.
    """
    fill(record, params)
    record["ratio"] = _ratios(params) if params.vibrations else 0.0


@lru_cache(maxsize=8)
def _ratios(params: GasParams) -> np.ndarray:
    gas = np.zeros(1, GAS)[0]
    fill(gas, params)
    rows, tiny = _STEP * np.arange(_ROWS), 1e-3
    low, middle, high = (
        np.array([ratio_of_specific_heats(gas, temperature) for temperature in rows + shift])
        for shift in (-tiny, 0.0, tiny)
    )
    return cubic_coefficients(middle, _STEP * (high - low) / (2.0 * tiny))


@kernel
def pressure_and_sound(gas, rho, temperature):
    """Pressure (Pa) and speed of sound (m/s) of the ideal gas at ``rho`` (kg/m3) and ``temperature`` (K)."""
    rt = gas.gas_constant * temperature
    return rho * rt, sqrt(_ratio_in_rows(gas, temperature) * rt)


@kernel
def _ratio_in_rows(gas, temperature):
    """:func:`ratio_of_specific_heats`, interpolated in its table where that reaches."""
    if gas.n_vibrations == 0:
        return gas.heat_capacity_ratio
    row, t = cell(temperature / _STEP, _ROWS - 1)
    if 0.0 <= t <= 1.0:
        return cubic(gas.ratio, row, t)
    return ratio_of_specific_heats(gas, temperature)


@kernel
def ratio_of_specific_heats(gas, temperature):
    """Ratio of specific heats at ``temperature`` (K): each vibration, an oscillator of temperature theta,
    adds (x / 2 sinh(x/2))^2, x = theta / T, to c_v / R.
    """
    if gas.n_vibrations == 0:
        return gas.heat_capacity_ratio
    heat_capacity = 1.0 / (gas.heat_capacity_ratio - 1.0)
    for i in range(gas.n_vibrations):
        x = gas.vibrations[i].temperature / max(temperature, 1.0)
        heat_capacity += gas.vibrations[i].modes * x * x * exp(-x) / (1.0 - exp(-x)) ** 2
    return 1.0 + 1.0 / heat_capacity


@kernel
def inverse_knudsen_number(gas, rho, length):
    """``length`` (m) over the mean free path m / (sqrt(2) pi d^2 rho) of hard spheres; ``rho`` in kg/m3."""
    return sqrt(2.0) * pi * gas.molecular_diameter**2 * rho * length / gas.molecular_mass
