"""The points to land at that hazard detection has chosen: all that guidance and the mission see of it."""

from __future__ import annotations

import numpy as np

from edl6dof.records import FLAG

LANDING_POINT = np.dtype(
    [
        ("coarse_known", FLAG),  # coarse hazard avoidance has chosen
        # m, L: east and north of the landing site, above which powered descent ends
        ("coarse_L", "f8", (2,)),
        ("fine_known", FLAG),  # hazard avoidance has chosen the spot to land on
        ("fine_L", "f8", (2,)),  # m, L: east and north of the landing site, where the lander is to stand
    ],
    align=True,
)
