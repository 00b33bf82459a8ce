"""Tables of aerodynamic coefficients in csv: a heading, and a row for every point of a complete grid.

Columns, in any order: ``mach``, ``alpha_deg``, for a body without symmetry ``beta_deg``, and coefficients:
``CD`` and ``CL``, or ``CA`` and ``CN`` (the first pair if a file has both), ``Cm``, and with ``beta_deg``
also ``CY``, ``Cl`` and ``Cn``, zero where they are missing.  Lines that begin with # are remarks.
"""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.interchange.number_csv import read_number_csv
from edl6dof.spatial import arrays

_AXES = ("mach", "alpha_deg", "beta_deg")
_COEFFICIENTS = ("CD", "CL", "CA", "CN", "Cm", "CY", "Cl", "Cn")
_KNOWN = {name: name for name in (*_AXES, *_COEFFICIENTS)} | {"alpha": "alpha_deg", "beta": "beta_deg"}


class AeroColumns(NamedTuple):
    """A complete grid: nodes of ``mach``, ``alpha_deg`` and ``beta_deg`` (one node where the file has none),
    and ``values`` [Mach, alpha, beta, (CA, CY, CN, Cl, Cm, Cn)].
    """

    mach: np.ndarray
    alpha_deg: np.ndarray
    beta_deg: np.ndarray
    values: np.ndarray
    has_beta: bool


def read_aero_csv(path: Path, content: bytes) -> AeroColumns:
    """Read the table of a csv file.

    Raises:
        ValueError: the file is wrong; the message has file, line and column.
    """
    table = read_number_csv(str(path), content, _named)
    return _grid(path, table.lines, table.columns)


def _named(heading: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names of the columns, and what is wrong with them."""
    names = []
    for word in heading:
        # a moment coefficient may say what it is about: Cm_xcg0253
        stem = word.split("_")[0] if word not in _AXES else word
        names.append(_KNOWN.get(word, _KNOWN.get(word.lower(), stem if stem in _COEFFICIENTS else "")))
    unknown = [word for word, name in zip(heading, names, strict=True) if not name]
    wrong = [
        f"lacks the column {name}{_meant(name, unknown)}"
        for name in ("mach", "alpha_deg", "Cm")
        if name not in names
    ]
    if not ({"CD", "CL"} <= set(names) or {"CA", "CN"} <= set(names)):
        wrong.append(f"lacks the columns CD and CL, or CA and CN{_meant('CD', unknown)}")
    if unknown:
        wrong.append(f"unknown column {unknown[0]!r} (known: {', '.join((*_AXES, *_COEFFICIENTS))})")
    if twice := sorted({name for name in names if name and names.count(name) > 1}):
        wrong.append(f"the column {twice[0]} stands twice")
    return names, wrong


def _meant(name: str, unknown: list[str]) -> str:
    near = get_close_matches(name, unknown, n=1, cutoff=0.3)
    return f"; is it the one called {near[0]!r}?" if near else ""


def _grid(path: Path, lines: np.ndarray, columns: dict[str, np.ndarray]) -> AeroColumns:
    has_beta = "beta_deg" in columns
    columns.setdefault("beta_deg", np.zeros(len(lines)))
    axes = [np.unique(columns[name]) for name in _AXES]
    shape = tuple(map(len, axes))
    place = np.ravel_multi_index(
        tuple(np.searchsorted(axis, columns[name]) for axis, name in zip(axes, _AXES, strict=True)), shape
    )
    order = np.argsort(place, kind="stable")
    repeated = np.flatnonzero(np.diff(place[order]) == 0)
    if len(repeated):
        first, again = lines[order[repeated[0]]], lines[order[repeated[0] + 1]]
        raise ValueError(f"{path}:{again}: gives the same point as line {first}")
    if len(place) != np.prod(shape):
        absent = np.setdiff1d(np.arange(np.prod(shape)), place)[0]
        point = [axis[k] for axis, k in zip(axes, np.unravel_index(absent, shape), strict=True)]
        shown = ", ".join(f"{name} {value:g}" for name, value in zip(_AXES, point, strict=True))
        if not has_beta:
            shown = shown.rpartition(",")[0]
        raise ValueError(f"{path}: not a complete Mach x alpha table: {shown} is missing")
    if shape[0] < 2 or shape[1] < 2:
        raise ValueError(f"{path}: needs at least two Mach numbers and two angles of attack")
    ordered = {name: values[order].reshape(shape) for name, values in columns.items()}
    zero = np.zeros(shape)
    if "CD" in ordered and "CL" in ordered:
        c, s = arrays.cos(np.radians(ordered["alpha_deg"])), arrays.sin(np.radians(ordered["alpha_deg"]))
        cd, cl = ordered["CD"], ordered["CL"]
        axial, normal = cd * c - cl * s, cd * s + cl * c
    else:
        axial, normal = ordered["CA"], ordered["CN"]
    rest = [ordered.get(name, zero) for name in ("CY", "Cl", "Cm", "Cn")]
    values = np.stack((axial, rest[0], normal, *rest[1:]), axis=-1)
    return AeroColumns(axes[0], axes[1], axes[2], values, has_beta)
