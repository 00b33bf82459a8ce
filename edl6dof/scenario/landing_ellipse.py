"""The planned landing ellipse of a scenario, as maps draw it."""

from __future__ import annotations

import numpy as np

from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import cos, sin


def planned_ellipse(length: float, width: float, azimuth: float) -> tuple[np.ndarray, np.ndarray]:
    """East and north (m) of an ellipse around the site with its long axis along ``azimuth`` (rad); shape
    (361,) each.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    along, across = 0.5 * length * arrays.cos(turn), 0.5 * width * arrays.sin(turn)
    return along * sin(azimuth) + across * cos(azimuth), along * cos(azimuth) - across * sin(azimuth)
