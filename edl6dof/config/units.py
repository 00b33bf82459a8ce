"""Unit suffixes of parameter names, and their conversion to SI.

A parameter or telemetry channel carries its unit as the suffix of its name (``mass_kg``, ``bank_deg``).
Inside records and kernels the suffix is gone and the value is in SI units and radians; this table is the only
place where units are converted.
"""

from __future__ import annotations

from functools import cache
from math import inf, pi
from typing import NamedTuple


class Unit(NamedTuple):
    """Unit of a suffix."""

    label: str  # printed form
    to_si: float  # factor to SI
    largest: float  # magnitude, in this unit, beyond which a parameter without bounds of its own is refused


DEG = pi / 180.0
#: Standard gravity, m/s2: the unit of loads, and the ratio of exhaust velocity to specific impulse.
G0 = 9.80665

#: Suffix (without the leading underscore) to unit.
UNITS: dict[str, Unit] = {
    "kg": Unit("kg", 1.0, 1e9),
    "kg_s": Unit("kg/s", 1.0, 1e6),
    "kg_s2": Unit("kg/s2", 1.0, 1e6),
    "kg_m2": Unit("kg m2", 1.0, 1e10),
    "kg_m3": Unit("kg/m3", 1.0, 1e4),
    "m": Unit("m", 1.0, 1e9),
    "mm": Unit("mm", 1e-3, 1e6),
    "km": Unit("km", 1e3, 1e6),
    "m2": Unit("m2", 1.0, 1e6),
    "m_s": Unit("m/s", 1.0, 1e5),
    "m_s2": Unit("m/s2", 1.0, 1e4),
    "m_s3": Unit("m/s3", 1.0, 1e4),
    "m_s4": Unit("m/s4", 1.0, 1e4),
    "m3_s2": Unit("m3/s2", 1.0, 1e21),
    "g0": Unit("g", G0, 1e4),
    "ug": Unit("ug", 9.80665e-6, 1e9),
    "ug_sqrt_hz": Unit("ug/sqrt(Hz)", 9.80665e-6, 1e9),
    "ug_sqrt_h": Unit("ug/sqrt(h)", 9.80665e-6 / 60.0, 1e9),
    "s": Unit("s", 1.0, 1e9),
    "s2_m": Unit("s2/m", 1.0, 1e9),
    "hz": Unit("Hz", 1.0, 1e6),
    "deg": Unit("deg", DEG, 1e4),
    "deg_s": Unit("deg/s", DEG, 1e7),
    "deg_day": Unit("deg/day", DEG / 86400.0, 1e6),
    "deg_century": Unit("deg/century", DEG / (36525.0 * 86400.0), 1e6),
    "deg_s2": Unit("deg/s2", DEG, 1e6),
    "deg_h": Unit("deg/h", DEG / 3600.0, 1e9),
    "deg_sqrt_h": Unit("deg/sqrt(h)", DEG / 60.0, 1e6),
    "deg_h_sqrt_h": Unit("deg/h/sqrt(h)", DEG / 3600.0 / 60.0, 1e9),
    "arcsec": Unit("arcsec", DEG / 3600.0, 1e7),
    "rad_s": Unit("rad/s", 1.0, 1e4),
    "n": Unit("N", 1.0, 1e9),
    "n_s": Unit("N/s", 1.0, 1e10),
    "ns": Unit("N s", 1.0, 1e9),
    "nm": Unit("N m", 1.0, 1e10),
    "n_m": Unit("N/m", 1.0, 1e12),
    "n_s_m": Unit("N s/m", 1.0, 1e12),
    "pa": Unit("Pa", 1.0, 1e10),
    "k": Unit("K", 1.0, 1e6),
    "k_m": Unit("K/m", 1.0, 1e3),
    "j_kg_k": Unit("J/(kg K)", 1.0, 1e6),
    "w_m2": Unit("W/m2", 1.0, 1e12),
    "w_cm2": Unit("W/cm2", 1e4, 1e8),
    "j_cm2": Unit("J/cm2", 1e4, 1e10),
    "j_m2": Unit("J/m2", 1.0, 1e14),
    "pct": Unit("%", 0.01, 1e6),
    "ppm": Unit("ppm", 1e-6, 1e9),
}

DIMENSIONLESS = Unit("", 1.0, inf)


@cache
def split_unit(name: str) -> tuple[str, Unit]:
    """Split ``bank_deg`` into ``("bank", Unit("deg", pi/180))``; a name without a known suffix is
    dimensionless.

    The longest suffix wins, so ``rate_deg_s`` is degrees per second and not seconds.
    """
    parts = name.split("_")
    for first in range(1, len(parts)):
        suffix = "_".join(parts[first:])
        if suffix in UNITS:
            return "_".join(parts[:first]), UNITS[suffix]
    return name, DIMENSIONLESS
