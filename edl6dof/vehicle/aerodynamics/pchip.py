"""Monotone piecewise cubic interpolation of table columns, while a table is built.

The same curve as scipy's ``PchipInterpolator`` (a test holds the two together); written out because importing
``scipy.interpolate`` costs 0.2 s and 26 MiB in every flight.  Source: Fritsch and Butland, SIAM J. Sci. Stat.
Comput. 5 (1984) 300-304.
"""

from __future__ import annotations

import numpy as np


def slopes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Slopes at the nodes ``x`` (n,) of ``y`` (..., n): weighted harmonic means inside, one-sided three-point
    formula at the ends.
    """
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
    """End slope that keeps the shape of the data."""
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
