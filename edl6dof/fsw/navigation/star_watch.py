"""Whether the star tracker has failed: no fix for long, though it is above the air, the body turns slowly,
and the event that ends its view is still to come.

It is given back with the next fix.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.spatial.frames import geodetic
from edl6dof.spatial.vector import norm, take3

#: Share of the largest rate at which it must see stars.
_SLOWLY = 0.8


class StarWatchParams(Params):
    """Exclusion of the star tracker."""

    enabled: bool = param(True, "whether it is excluded")
    patience_s: float = param(2.0, "time without a fix, though there should be one", gt=0.0, le=1e4)
    margin_m: float = param(
        500.0, "how far above the lowest altitude at which it sees stars it must do so", ge=0.0, le=1e6
    )


STAR_WATCH = np.dtype([("without", "f8")], align=True)  # s: for how long a fix has been missed


@kernel
def watch_stars(params, planet, instruments, requested, stars, motion, solution, health, memory):
    """Exclude the star tracker, or give it back, after a cycle of ``motion``.

    Args:
        requested: one flag for each event of the mission that was requested.
    """
    if params.enabled == 0 or instruments.star_sigma == 0.0:
        return
    if instruments.star_until > 0 and requested[instruments.star_until - 1] != 0:
        return
    if stars.valid != 0:
        memory.without, health.star_tracker = 0.0, 1
        return
    slow = norm(take3(motion.rate, 0)) < _SLOWLY * instruments.star_rate
    _, _, _, _, altitude = geodetic(planet.equatorial_radius, planet.flattening, take3(solution.r_I, 0))
    if slow and altitude > instruments.star_lowest + params.margin:
        memory.without += motion.dt
        if memory.without > params.patience:
            health.star_tracker = 0
