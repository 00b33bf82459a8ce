"""Heating of the stagnation point by the gas of the shock layer: convection, and radiation of fast entries.

Sources: convection, Sutton and Graves, NASA TR R-376 (1971); radiation, Tauber and Sutton, Journal of
Spacecraft and Rockets 28 (1991) 40-42.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated

from pydantic import field_validator

from edl6dof.config.base import Capacity, Params, Vec3, param
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import pow

#: Rows of the longest table of velocities.
MAX_SPEEDS = 24
#: Emissivity of a charred heat shield [E].
EMISSIVITY = 0.85
STEFAN_BOLTZMANN = 5.670374419e-8  # W/(m2 K4)


class RadiationParams(Params):
    """Radiative heat flux: coefficient * nose radius^a * density^b * f(speed); none without f."""

    coefficient_w_cm2: float = param(
        0.0, "heat flux for a nose radius of 1 m, density 1 kg/m3 and f = 1", ge=0.0
    )
    density_exponent: float = param(0.0, "b, exponent of the density", ge=0.0, le=3.0)
    radius_exponent: Vec3 = param(
        (0.0, 0.0, 0.0),
        "a, exponent of the nose radius: a factor, times powers of speed (m/s) and density (kg/m3) with "
        "these exponents",
    )
    largest_radius_exponent: Vec3 = param(
        (1.0, 1.0, 1.0), "largest a for nose radii below 1 m, below 2 m, and above"
    )
    speeds: Annotated[list[tuple[float, float]], Capacity(MAX_SPEEDS)] = param(
        None,
        "f: pairs of speed (m/s) and value, speeds rising; below the first no radiation, above the last held",
        factory=list,
        max_length=MAX_SPEEDS,
    )

    @field_validator("speeds")
    @classmethod
    def _rise(cls, value: list[tuple[float, float]]) -> list[tuple[float, float]]:
        if any(second[0] <= first[0] for first, second in zip(value, value[1:], strict=False)):
            raise ValueError("speeds must rise")
        return value


@kernel
def convective_heat_flux(gas, rho, nose_radius, speed):
    """Convective heat flux (W/m2) at the stagnation point, Sutton and Graves (1971)."""
    return gas.sutton_graves_constant * sqrt(rho / nose_radius) * speed * speed * speed


@kernel
def radiative_heat_flux(radiation, rho, nose_radius, speed):
    """Radiative heat flux (W/m2) at the stagnation point, Tauber and Sutton (1991), eq. 1, tables 1 and 2.

    Args:
        radiation: record of :class:`RadiationParams`.
        rho: density of the air, kg/m3.
        nose_radius: m.
        speed: airspeed, m/s.
    """
    if radiation.n_speeds == 0 or not speed >= radiation.speeds[0, 0]:
        return 0.0
    factor, of_speed, of_density = radiation.radius_exponent
    largest = radiation.largest_radius_exponent[0 if nose_radius < 1.0 else 1 if nose_radius < 2.0 else 2]
    exponent = min(factor * pow(speed, of_speed) * pow(rho, of_density), largest)
    flux = radiation.coefficient * pow(nose_radius, exponent) * pow(rho, radiation.density_exponent)
    return flux * _of_speed(radiation, speed)


@kernel
def _of_speed(radiation, speed):
    """Function of the speed, straight between its rows and held above the last."""
    rows = radiation.speeds
    for k in range(1, radiation.n_speeds):
        if speed < rows[k, 0]:
            share = (speed - rows[k - 1, 0]) / (rows[k, 0] - rows[k - 1, 0])
            return rows[k - 1, 1] + share * (rows[k, 1] - rows[k - 1, 1])
    return rows[radiation.n_speeds - 1, 1]


def wall_temperature(flux: float) -> float:
    """Temperature (K) of a wall that radiates a heat flux (W/m2) away; a real wall also absorbs and ablates,
    and stays cooler.
    """
    return sqrt(sqrt(flux / (EMISSIVITY * STEFAN_BOLTZMANN)))
