"""Rows of a series that a picture needs: those that shape the curve, and every peak."""

from __future__ import annotations

import numpy as np

#: Share of a column's range by which a drawn curve may miss a row, and halvings of the rows at most.
SHARE, HALVINGS = 1.0 / 4000.0, 6


def rows_to_draw(along: np.ndarray, values: np.ndarray, most: int) -> np.ndarray:
    """Return the rows (sorted, first and last included) that, joined by straight lines, draw the columns as
    all rows would.

    Args:
        along: what the columns are drawn over, rising, shape (n,); the number of the row for a curve in a
            plane.
        values: the columns, shape (n, columns); NaN is a gap.
        most: if more rows than this remain, they are divided into stretches, of which only the ends and the
            extremes of every column are kept: peaks keep their height and place.
    """
    rows = bends(along, values)
    if len(rows) > most:
        rows = rows[extremes(values[rows], max(most // (1 + 2 * values.shape[1]), 1))]
    return rows


def bends(along: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return rows whose joining lines miss every other row by at most ``SHARE`` of the range of its column,
    and the rows in which a column is least and greatest.

    Every other row is dropped where a line between its neighbours passes near enough, again and again; the
    errors of these passes add up to no more than the share.
    """
    if not len(values):
        return np.empty(0, int)
    columns = np.ascontiguousarray(values.T)  # numpy is quick along the rows of an array
    finite = np.where(np.isfinite(columns), columns, np.nan)
    gap: np.ndarray = np.logical_or.reduce(np.isnan(finite), axis=0)
    low, high = (np.where(np.isnan(finite), far, finite) for far in (np.inf, -np.inf))
    near = np.maximum(high.max(axis=1) - low.min(axis=1), 0.0)[:, None] * SHARE / HALVINGS
    kept = ~gap
    kept[1:] |= ~gap[:-1]
    kept[:-1] |= ~gap[1:]
    kept[[0, -1]] = True
    for _ in range(HALVINGS):
        rows = np.flatnonzero(kept)
        x, y = along[rows], finite[:, rows]
        share = (x[1:-1:2] - x[:-2:2]) / (x[2::2] - x[:-2:2])
        line = y[:, :-2:2] + share * (y[:, 2::2] - y[:, :-2:2])
        straight = np.all(np.abs(y[:, 1:-1:2] - line) <= near, axis=0)
        if not straight.any():
            break
        kept[rows[1:-1:2][straight]] = False
    kept[low.argmin(axis=1)] = kept[high.argmax(axis=1)] = True
    return np.flatnonzero(kept)


def extremes(values: np.ndarray, stretches: int) -> np.ndarray:
    """Rows at the ends and at the extremes of every column of equal stretches, and edges of gaps."""
    n = len(values)
    size = -(-n // stretches)
    padded = np.concatenate([values, np.full((-n % size, values.shape[1]), np.nan)])
    parts = padded.reshape(-1, size, values.shape[1])
    starts = np.arange(0, n, size)
    kept = np.zeros(len(padded), bool)
    kept[starts] = kept[[0, n - 1]] = True
    for fill, pick in ((np.inf, np.argmin), (-np.inf, np.argmax)):
        kept[starts[:, None] + pick(np.where(np.isnan(parts), fill, parts), axis=1)] = True
    gap = np.any(np.isnan(values), axis=1)
    edge = np.flatnonzero(gap[1:] != gap[:-1])
    kept[edge] = kept[edge + 1] = True
    return np.flatnonzero(kept[:n])


def spans(present: np.ndarray) -> list[tuple[int, int]]:
    """First and one-past-last row of each run of ``True``."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], present, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
