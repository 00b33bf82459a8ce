"""Stretches of rows in which something holds."""

from __future__ import annotations

import numpy as np


def spans(present: np.ndarray) -> list[tuple[int, int]]:
    """First and one-past-last row of each run of ``True``."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], present, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
