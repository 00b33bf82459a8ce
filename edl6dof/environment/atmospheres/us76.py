"""U.S. Standard Atmosphere 1976 up to 86 km, from its defining lapse rates.

Source: U.S. Standard Atmosphere, 1976, NOAA/NASA/USAF, table 4 and eq. 18, 23, 33a, 33b, 42, 50.  Temperature
is the molecular-scale temperature; above 86 km the last layer is continued, which is outside the validity of
these equations.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp, pow

GAS_CONSTANT = 8314.32 / 28.9644  # J/(kg K): 287.05287
HEAT_CAPACITY_RATIO = 1.4
_RADIUS = 6356766.0  # m, effective Earth radius of the geopotential
_HYDROSTATIC = 9.80665 / GAS_CONSTANT  # K/m

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
    """U.S. Standard Atmosphere 1976, with a gas of its own."""


@kernel
def air(atm, gas, table, alt):
    """Density kg/m3, pressure Pa, temperature K and speed of sound m/s at the geometric altitude ``alt``,
    m.
    """
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
    rt = GAS_CONSTANT * temperature
    return pressure / rt, pressure, temperature, sqrt(HEAT_CAPACITY_RATIO * rt)


MEMBER = Member("us76", Us76Params, {"air": air}, "U.S. Standard Atmosphere, 1976, NOAA/NASA/USAF")
