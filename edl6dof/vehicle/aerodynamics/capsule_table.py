"""Building of the shared aerodynamic table of a sphere-cone capsule: Mach x total angle 0..180 deg.  Plain
numpy, at load time.

0-16 deg is the published static table, made C1 in angle by monotone cubics (PCHIP) through its points and
their mirror images. Beyond it modified Newtonian flow over the whole capsule, plus a correction that makes
value and slope continuous at the end of the table and fades out at 40 deg.  Free-molecular coefficients by
the same surface integral (:mod:`edl6dof.vehicle.aerodynamics.newtonian`).  A capsule without a table of its
own has all its coefficients from the shape.

The monotone cubics are those of scipy's ``PchipInterpolator`` (a test holds the two together); written out
because importing ``scipy.interpolate`` costs 0.2 s and 26 MiB in every flight.  Source: Fritsch and Butland,
SIAM J. Sci. Stat. Comput. 5 (1984) 300-304.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.config.document.regular import read_regular
from edl6dof.interchange.aero_table import read_aero_csv
from edl6dof.interchange.daveml_vehicle import static_table
from edl6dof.records import record, require_finite
from edl6dof.spatial import arrays
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams
from edl6dof.vehicle.aerodynamics.newtonian import (
    capsule_rings,
    newtonian_coefficients,
    stagnation_pressure_coefficient,
    surface_integrals,
)


def slopes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Slopes at the nodes ``x`` (n,) of ``y`` (..., n): weighted harmonic means, three points at the ends."""
    h = np.diff(x)
    d = np.diff(y) / h
    out = np.empty_like(y)
    w1, w2 = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    same = np.sign(d[..., :-1]) * np.sign(d[..., 1:]) > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (w1 + w2) / (w1 / d[..., :-1] + w2 / d[..., 1:])
    out[..., 1:-1] = np.where(same, mean, 0.0)
    out[..., 0] = _end(h[0], h[1], d[..., 0], d[..., 1])
    out[..., -1] = _end(h[-1], h[-2], d[..., -1], d[..., -2])
    return out


def _end(h0: float, h1: float, d0: np.ndarray, d1: np.ndarray) -> np.ndarray:
    """Slope at an end by three points, limited so that the curve keeps the shape of the data."""
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    slope = np.where(np.sign(slope) != np.sign(d0), 0.0, slope)
    return np.where((np.sign(d0) != np.sign(d1)) & (np.abs(slope) > 3.0 * np.abs(d0)), 3.0 * d0, slope)


def curve(x: np.ndarray, y: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and derivatives at ``at`` (m,), inside the range of ``x``: two arrays (..., m)."""
    node = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    m = slopes(x, y)
    h = x[node + 1] - x[node]
    t = (at - x[node]) / h
    y0, y1, m0, m1 = y[..., node], y[..., node + 1], m[..., node] * h, m[..., node + 1] * h
    c2, c3 = 3.0 * (y1 - y0) - 2.0 * m0 - m1, 2.0 * (y0 - y1) + m0 + m1
    return y0 + t * (m0 + t * (c2 + t * c3)), (m0 + t * (2.0 * c2 + 3.0 * t * c3)) / h


PACKAGED = Path(__file__).parents[2] / "data" / "aerodynamics"
MACH_CAPACITY = 64
ANGLES = 181
FADE_END = 40
#: Mach numbers at which the coefficients of a shape are worked out; the highest ones differ by 1e-3.
NEWTONIAN_MACH = np.array(
    [0.2, 0.4, 0.6, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0, 6.5, 8.0, 10.0]
    + [15.0, 20.0, 30.0, 40.0]
)

#: ``continuum`` [Mach, degree, (CA, dCA, CN, dCN, Cm, dCm, Cmq)] and ``free_molecular`` [degree, (CA ..
#: dCm)], slopes per degree.
AERO_TABLE = record(
    ("n_mach", "i8"),
    ("moment_reference_x", "f8"),
    ("mach", "f8", (MACH_CAPACITY,)),
    ("continuum", "f8", (MACH_CAPACITY, ANGLES, 7)),
    ("free_molecular", "f8", (ANGLES, 6)),
)

#: Parameters that are applied in flight and do not enter the table.
FLOWN = ("axial_factor", "normal_factor", "moment_factor", "moment_bias", "damping_factor")
_UNFLOWN = {name: CapsuleParams.model_fields[name].default for name in FLOWN}


class AeroInputs(NamedTuple):
    """Inputs of the table: the capsule, the ratio of specific heats behind the shock, and the
    content of its static table.
    """

    capsule: CapsuleParams
    heat_capacity_ratio: float
    content: bytes


def aero_inputs(capsule: CapsuleParams, heat_capacity_ratio: float) -> AeroInputs:
    """Gather the inputs of the table of a capsule, in a gas of this ratio of specific heats behind the shock.

    Raises:
        ValueError: there is no static table of this name.
        OSError: the table cannot be read.
    """
    made = capsule.coefficients == "newtonian"
    content = b"" if made else read_regular(_existing(capsule.static_table))
    return AeroInputs(capsule.model_copy(update=_UNFLOWN), heat_capacity_ratio, content)


@lru_cache(maxsize=8)
def build_aero_table(inputs: AeroInputs) -> np.ndarray:
    """Build the table record of a capsule, ``AERO_TABLE`` of shape (1,), read-only, slopes per degree;
    damping on the same Mach grid, so that one look-up serves all coefficients.

    Raises:
        ValueError: no table can be built.
    """
    capsule, heat_capacity_ratio, _ = inputs
    rings = capsule_rings(capsule)
    x_ref = capsule.moment_reference_x_over_d * capsule.diameter_m
    degrees = np.arange(float(ANGLES))
    newton, rare = surface_integrals(rings, np.radians(degrees), capsule.diameter_m, x_ref)
    if capsule.coefficients == "newtonian":
        mach, size = NEWTONIAN_MACH, (capsule.diameter_m, x_ref)
        values = newtonian_coefficients(rings, np.radians(degrees), mach, heat_capacity_ratio, size)
        slopes = _slopes(values)
    else:
        mach, alpha, static = read_static_table(capsule.static_table)
        newton = newton[None] * stagnation_pressure_coefficient(mach, heat_capacity_ratio)[:, None, None]
        values, slopes = _join(alpha, static, newton)
    columns = np.empty((len(mach), ANGLES, 6))
    columns[..., 0::2], columns[..., 1::2] = values, slopes

    grid = np.union1d(mach, capsule.damping_mach)
    grid = grid[(grid >= mach[0]) & (grid <= mach[-1])]
    if len(grid) > MACH_CAPACITY:
        raise ValueError(
            f"{capsule.static_table}: {len(grid)} Mach numbers with those of the damping, at most "
            f"{MACH_CAPACITY}"
        )
    table = np.zeros(1, AERO_TABLE)
    record = table[0]
    record["n_mach"], record["moment_reference_x"] = len(grid), x_ref
    record["mach"][: len(grid)] = grid
    low = np.clip(np.searchsorted(mach, grid, side="right") - 1, 0, len(mach) - 2)
    share = ((grid - mach[low]) / (mach[low + 1] - mach[low]))[:, None, None]
    record["continuum"][: len(grid), :, :6] = (1.0 - share) * columns[low] + share * columns[low + 1]
    record["continuum"][: len(grid), :, 6] = _damping(capsule, grid, degrees)
    record["free_molecular"][:, 0::2] = rare
    record["free_molecular"][:, 1::2] = _slopes(rare[None])[0]
    require_finite(table)
    return table


def static_table_path(name: str) -> Path:
    """Path of an aerodynamic table by its name: a path, or a file of edl6dof/data/aerodynamics."""
    return Path(name) if Path(name).exists() else PACKAGED / name


def read_static_table(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mach, alpha (deg) and coefficients [Mach, alpha, (CA, CN, Cm)] from a csv or DAVE-ML file."""
    path = _existing(name)
    return _static_table(path, read_regular(path))


@lru_cache(maxsize=8)
def _static_table(path: Path, content: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As :func:`read_static_table`; ``content``: of the file."""
    if path.suffix == ".dml":
        mach, alpha, table = static_table(path)
        cd, cl, cm = table[..., 0], table[..., 1], table[..., 2]
        c, s = arrays.cos(np.radians(alpha)), arrays.sin(np.radians(alpha))
        found = np.stack((cd * c - cl * s, cd * s + cl * c, cm), axis=-1)
    else:
        columns = read_aero_csv(path, content)
        if columns.has_beta:
            raise ValueError(
                f"{path}: a capsule's table has no column beta_deg; aero.model body flies one that has"
            )
        mach, alpha, found = columns.mach, columns.alpha_deg, columns.values[:, :, 0, [0, 2, 4]]
    if alpha[0] != 0.0 or np.any(alpha != np.round(alpha)) or not 2.0 <= alpha[-1] < FADE_END:
        raise ValueError(f"{path}: alpha must be whole degrees from 0 to less than {FADE_END}")
    if not (np.isfinite(mach).all() and np.isfinite(found).all()):
        raise ValueError(f"{path}: holds a number that is not finite")
    return mach, alpha, found


def _existing(name: str) -> Path:
    path = static_table_path(name)
    if not path.exists():
        raise ValueError(f"aerodynamic table {name!r}: neither a file nor a name in {PACKAGED}")
    return path


def _join(alpha: np.ndarray, static: np.ndarray, newton: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Join table and Newtonian coefficients: values and slopes per degree [Mach, degree, (CA, CN, Cm)]."""
    end = int(alpha[-1])
    parity = np.array([1.0, -1.0, -1.0])
    mirrored = np.concatenate((static[:, :0:-1] * parity, static), axis=1)
    inside, inside_slopes = (
        np.moveaxis(part, -1, 1)
        for part in curve(
            np.concatenate((-alpha[:0:-1], alpha)), np.moveaxis(mirrored, 1, -1), np.arange(end + 1.0)
        )
    )
    values, slopes = newton.copy(), _slopes(newton)
    gap, gap_slope = inside[:, end] - values[:, end], inside_slopes[:, end] - slopes[:, end]
    for degree in range(end, FADE_END + 1):
        d, length = degree - end, FADE_END - end
        s = d / length
        fade, fade_slope = 1.0 - s * s * (3.0 - 2.0 * s), -6.0 * s * (1.0 - s) / length
        correction = gap + gap_slope * d
        values[:, degree] += correction * fade
        slopes[:, degree] += gap_slope * fade + correction * fade_slope
    values[:, : end + 1], slopes[:, : end + 1] = inside, inside_slopes
    return values, slopes


def _slopes(values: np.ndarray) -> np.ndarray:
    """Central differences per degree of [.., degree, (CA, CN, Cm)], CA even, CN and Cm odd at the ends."""
    parity = np.array([1.0, -1.0, -1.0])
    padded = np.concatenate((values[:, 1:2] * parity, values, values[:, -2:-1] * parity), axis=1)
    return 0.5 * (padded[:, 2:] - padded[:, :-2])


def _damping(capsule: CapsuleParams, mach: np.ndarray, degrees: np.ndarray) -> np.ndarray:
    """Cmq + Cm_alphadot on [Mach, degree], bilinear, clamped outside the parameters' grid."""
    rows = np.array([arrays.interpolate(mach, capsule.damping_mach, row) for row in capsule.damping_table])
    return np.array([arrays.interpolate(degrees, capsule.damping_angle_deg, column) for column in rows.T])
