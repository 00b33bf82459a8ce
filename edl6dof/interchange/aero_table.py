"""Tables of aerodynamic coefficients in csv: a heading, and a row for every point of a complete grid.

Columns, in any order: ``mach``, ``alpha_deg``, for a body without symmetry ``beta_deg``, and coefficients:
``CD`` and ``CL``, or ``CA`` and ``CN`` (the first pair if a file has both), ``Cm``, and with ``beta_deg``
also ``CY``, ``Cl`` and ``Cn``, zero where they are missing.  Lines that begin with # are remarks.
"""

from __future__ import annotations

import csv
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple

import numpy as np

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
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is not a text file") from None
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise ValueError(f"{path}: is empty")
    names = _heading(path, *numbered[0])
    lines = np.array([number for number, _ in numbered[1:]])
    rows = np.array([_row(path, number, line, names) for number, line in numbered[1:]])
    if not len(rows):
        raise ValueError(f"{path}: has a heading and no row")
    columns = {name: rows[:, k] for k, name in enumerate(names) if name}
    return _grid(path, lines, columns)


def _heading(path: Path, number: int, line: str) -> list[str]:
    """Names of the columns; empty for a column that is not read."""
    words = [word.strip() for word in next(csv.reader([line]))]
    if all(_is_number(word) for word in words):
        raise ValueError(f"{path}:{number}: needs a heading such as mach,alpha_deg,CD,CL,Cm above its rows")
    names = []
    for word in words:
        # a moment coefficient may say what it is about: Cm_xcg0253
        stem = word.split("_")[0] if word not in _AXES else word
        names.append(_KNOWN.get(word, _KNOWN.get(word.lower(), stem if stem in _COEFFICIENTS else "")))
    unknown = [word for word, name in zip(words, names, strict=True) if not name]
    for name in ("mach", "alpha_deg", "Cm"):
        if name not in names:
            raise ValueError(f"{path}:{number}: lacks the column {name}{_meant(name, unknown)}")
    if not ({"CD", "CL"} <= set(names) or {"CA", "CN"} <= set(names)):
        raise ValueError(f"{path}:{number}: lacks the columns CD and CL, or CA and CN{_meant('CD', unknown)}")
    if unknown:
        raise ValueError(
            f"{path}:{number}: unknown column {unknown[0]!r} (known: {', '.join((*_AXES, *_COEFFICIENTS))})"
        )
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"{path}:{number}: the column {twice[0]} stands twice")
    return names


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _meant(name: str, unknown: list[str]) -> str:
    near = get_close_matches(name, unknown, n=1, cutoff=0.3)
    return f"; is it the one called {near[0]!r}?" if near else ""


def _row(path: Path, number: int, line: str, names: list[str]) -> list[float]:
    words = next(csv.reader([line]))
    if len(words) != len(names):
        raise ValueError(f"{path}:{number}: has {len(words)} entries, its heading {len(names)}")
    values = []
    for name, word in zip(names, words, strict=True):
        if not _is_number(word):
            raise ValueError(f"{path}:{number}: {name} must be a number (got {word.strip()[:30]!r})")
        values.append(float(word))
        if not np.isfinite(values[-1]):
            raise ValueError(f"{path}:{number}: {name} is not finite (got {word.strip()!r})")
    return values


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
