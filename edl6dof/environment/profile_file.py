"""Profiles of the air in csv files: altitude, temperature, density or pressure, optionally winds and sigma.

A column is known by the beginning of its heading, its order does not matter, others are left unread.
"""

from __future__ import annotations

import csv
from functools import lru_cache
from math import isfinite, nan
from pathlib import Path
from typing import NamedTuple

import numpy as np

_DATA = Path(__file__).resolve().parents[1] / "data" / "atmosphere"

#: Beginning of the heading and factor to SI of what is read.
_COLUMNS = {
    "altitude": ("h_", 1e3),
    "density": ("rho", 1.0),
    "pressure": ("P_Pa", 1.0),
    "temperature": ("T_K", 1.0),
    "east": ("EWind", 1.0),
    "north": ("NWind", 1.0),
    "sigma": ("sigma", 0.01),
}
#: Wrong cells of a file that are named one by one.
_NAMED = 5


class Profile(NamedTuple):
    """The air of a csv, SI units, each shape (n,), read-only.

    Attributes:
        altitude: m above the areoid, rising.
        density: kg/m3.
        temperature: K.
        east: mean wind towards east, m/s; zero where the file has none, as the next two.
        north: mean wind towards north, m/s.
        sigma: relative 1-sigma of density.
    """

    altitude: np.ndarray
    density: np.ndarray
    temperature: np.ndarray
    east: np.ndarray
    north: np.ndarray
    sigma: np.ndarray


def profile_path(name: str) -> Path:
    """The csv that a name means: one of edl6dof/data/atmosphere, or an absolute path."""
    return _DATA / name


@lru_cache(maxsize=32)
def read_profile(name: str, content: bytes, gas_constant: float) -> Profile:
    """The profile of a csv; where it gives pressure in place of density, that is p / (R T).

    Args:
        name: of the file, for messages.
        content: of the file.
        gas_constant: R, J/(kg K).

    Raises:
        ValueError: it is no such table; every wrong cell, row and missing column is named.
        LookupError: it is empty.
    """
    columns = _columns(name, content.decode())
    present = {
        key: (heading, values * _to_si(key, heading))
        for key, (prefix, _) in _COLUMNS.items()
        for heading, values in reversed(columns.items())
        if heading.startswith(prefix)
    }
    found = {key: values for key, (_, values) in present.items()}
    if "density" not in found:
        found["density"] = found["pressure"] / (gas_constant * found["temperature"])
    positive = all(np.all(found[key] > 0.0) for key in ("density", "temperature"))
    if np.any(np.diff(found["altitude"]) <= 0.0) or not positive:
        raise ValueError(f"{name}: altitudes must rise, temperatures and densities be positive")
    nothing = np.zeros(len(found["altitude"]))
    return Profile(*(found.get(key, nothing) for key in Profile._fields))


def _to_si(key: str, heading: str) -> float:
    """Altitudes may be in metres too: their heading says so."""
    return 1.0 if key == "altitude" and heading.endswith("_m") else _COLUMNS[key][1]


def _missing(headings: list[str]) -> list[str]:
    """Name the columns that are missing in these headings."""
    missing = [
        f"no column that begins with {_COLUMNS[key][0]!r}"
        for key in ("altitude", "temperature")
        if not any(heading.startswith(_COLUMNS[key][0]) for heading in headings)
    ]
    if not any(heading.startswith(("rho", "P_Pa")) for heading in headings):
        missing.append("no column that begins with 'rho' (density, kg/m3) or 'P_Pa' (pressure)")
    return missing


def _columns(name: str, text: str) -> dict[str, np.ndarray]:
    """Numbers by heading of the columns whose headings are known."""
    lines = [(line, row) for line, row in enumerate(csv.reader(text.splitlines()), 1) if row]
    headings = [heading.strip() for heading in lines[0][1]]
    if missing := _missing(headings):
        raise ValueError(f"{name}: {'; '.join(missing)}")
    if len(lines) < 3:
        raise ValueError(f"{name}: must have a heading and two rows at least")
    known = [k for k, h in enumerate(headings) if h.startswith(tuple(p for p, _ in _COLUMNS.values()))]
    wrong = [
        f"line {line} has {len(row)} of {len(headings)} columns"
        for line, row in lines[1:]
        if len(row) < len(headings)
    ]
    wrong += [
        f"line {line}, {headings[k]}: must be a number (got {row[k]!r})"
        for line, row in lines[1:]
        for k in known
        if k < len(row) and not isfinite(_number(row[k]))
    ]
    if wrong:
        more = f"; and {len(wrong) - _NAMED} more" if len(wrong) > _NAMED else ""
        raise ValueError(f"{name}: {'; '.join(wrong[:_NAMED])}{more}")
    return {headings[k]: np.array([_number(row[k]) for _, row in lines[1:]]) for k in known}


def _number(cell: str) -> float:
    """The number in a cell; not a number where there is none."""
    try:
        return float(cell)
    except ValueError:
        return nan
