"""Means and maxima over a window that moves along the rows; beyond the ends, the first and last row hold.

``scipy.ndimage`` has both, but importing it takes longer than all that the replay computes.
"""

from __future__ import annotations

import numpy as np


def moving_mean(values: np.ndarray, width: int) -> np.ndarray:
    """Mean over ``width`` rows (odd) around each row, shape as ``values``, whose rows are along axis 0."""
    total = np.cumsum(_extended(values, width), axis=0)
    total[width:] -= total[:-width].copy()
    return total[width - 1 :] / width


def moving_largest(values: np.ndarray, width: int) -> np.ndarray:
    """Largest of ``width`` rows (odd) around each row, shape (rows,)."""
    windows = np.lib.stride_tricks.sliding_window_view(_extended(values, width), width)
    return np.asarray(windows.max(axis=-1))


def _extended(values: np.ndarray, width: int) -> np.ndarray:
    half = width // 2
    return np.pad(values, [(half, half)] + [(0, 0)] * (values.ndim - 1), mode="edge")
