"""Unit suffixes of parameter names, and their conversion to SI.

A parameter or telemetry channel carries its unit as the suffix of its name (``mass_kg``, ``bank_deg``).  Inside records and
kernels the suffix is gone and the value is in SI units and radians; this table is the only place where units are converted.
"""

from __future__ import annotations

from functools import cache
from math import pi
from typing import NamedTuple


class Unit(NamedTuple):
    """How one suffix reads: its printed form and the factor that turns a value into SI."""

    label: str
    to_si: float


DEG = pi / 180.0

#: Suffix (without the leading underscore) to unit.
UNITS: dict[str, Unit] = {
    "kg": Unit("kg", 1.0),
    "kg_s": Unit("kg/s", 1.0),
    "kg_m2": Unit("kg m2", 1.0),
    "kg_m3": Unit("kg/m3", 1.0),
    "m": Unit("m", 1.0),
    "mm": Unit("mm", 1e-3),
    "km": Unit("km", 1e3),
    "m2": Unit("m2", 1.0),
    "m_s": Unit("m/s", 1.0),
    "m_s2": Unit("m/s2", 1.0),
    "m_s3": Unit("m/s3", 1.0),
    "m_s4": Unit("m/s4", 1.0),
    "m3_s2": Unit("m3/s2", 1.0),
    "g0": Unit("g", 9.80665),
    "s": Unit("s", 1.0),
    "s2_m": Unit("s2/m", 1.0),
    "hz": Unit("Hz", 1.0),
    "deg": Unit("deg", DEG),
    "deg_s": Unit("deg/s", DEG),
    "deg_s2": Unit("deg/s2", DEG),
    "rad_s": Unit("rad/s", 1.0),
    "n": Unit("N", 1.0),
    "n_s": Unit("N/s", 1.0),
    "ns": Unit("N s", 1.0),
    "nm": Unit("N m", 1.0),
    "n_m": Unit("N/m", 1.0),
    "n_s_m": Unit("N s/m", 1.0),
    "pa": Unit("Pa", 1.0),
    "k": Unit("K", 1.0),
    "j_kg_k": Unit("J/(kg K)", 1.0),
    "w_m2": Unit("W/m2", 1.0),
    "w_cm2": Unit("W/cm2", 1e4),
    "j_cm2": Unit("J/cm2", 1e4),
    "j_m2": Unit("J/m2", 1.0),
    "pct": Unit("%", 0.01),
}

DIMENSIONLESS = Unit("", 1.0)


@cache
def split_unit(name: str) -> tuple[str, Unit]:
    """Split ``bank_deg`` into ``("bank", Unit("deg", pi/180))``; a name without a known suffix is dimensionless.

    The longest suffix wins, so ``rate_deg_s`` is degrees per second and not seconds.
    """
    parts = name.split("_")
    for first in range(1, len(parts)):
        suffix = "_".join(parts[first:])
        if suffix in UNITS:
            return "_".join(parts[:first]), UNITS[suffix]
    return name, DIMENSIONLESS
