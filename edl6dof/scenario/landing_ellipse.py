"""The planned landing ellipse of a scenario, as maps draw it."""

from __future__ import annotations

import numpy as np


def planned_ellipse(length: float, width: float, azimuth: float) -> tuple[np.ndarray, np.ndarray]:
    """East and north (m) of an ellipse around the site with its long axis along ``azimuth`` (rad); shape
    (361,) each.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    along, across = 0.5 * length * np.cos(turn), 0.5 * width * np.sin(turn)
    return along * np.sin(azimuth) + across * np.cos(azimuth), along * np.cos(azimuth) - across * np.sin(
        azimuth
    )
