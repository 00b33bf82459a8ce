"""What powered guidance gave up to land at all."""

from __future__ import annotations

import numpy as np


def relaxation_figures(relaxed: np.void) -> dict[str, float]:
    """Figures of a ``RELAXED`` record; none where every constraint was kept."""
    noted = np.flatnonzero(relaxed["t"] > 0.0)
    if not len(noted):
        return {}
    most = int(noted[-1])
    return {"constraints_relaxed": most + 1.0, "landing_error_m": float(relaxed["landing_error"][most])}
