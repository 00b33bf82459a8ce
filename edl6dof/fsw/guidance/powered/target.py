"""Where powered deceleration ends: at rest, at a height above a point that keeps clear of the backshell.

The point is chosen once, where the engine lights: ahead of the lander by a share of its drift over the time
that a constant deceleration takes, less a divert against the drift; or where
coarse hazard avoidance has chosen it.  Source of backshell avoidance: Hu et al.
2022, section 6.2; the rule is an estimate.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.vector import clamp

#: Least height above the target (m) and descent rate (m/s) from which the time of arrival is worked out.
LEAST_HEIGHT, LEAST_DESCENT = 50.0, 5.0
#: Share of the target's height at which the lander may come to rest where it cannot at the target.
LEAST_SHARE = 0.3


class PoweredTargetParams(Params):
    """Target of powered deceleration, which all powered laws share."""

    height_m: float = param(
        100.0,
        "height above ground at which velocity is zero",
        status="published",
        source="S1",
        gt=0.0,
        usual=(0.5, 1000, "airbags cut loose to hover"),
    )
    time_factor: float = param(
        1.0,
        "expected duration over 2 height / descent rate, that of a constant deceleration",
        status="estimate",
        gt=0.2,
        le=3.0,
    )
    drift_share: float = param(
        0.33, "share of velocity times expected duration by which the target leads the lander", ge=0.0, le=1.0
    )
    divert_m: float = param(
        120.0, "divert against the direction of drift, away from backshell and parachute", ge=0.0
    )


POWERED_TARGET = np.dtype(
    [
        ("set", FLAG),  # the target has been chosen
        ("arrival", "f8"),  # s: flight time at which the lander is expected there
        ("point_L", "f8", (2,)),  # m, L: east and north of the landing site
        ("height", "f8"),  # m: above the ground
        ("least_height", "f8"),  # m: above the ground, to come to rest at where the target cannot be reached
    ],
    align=True,
)


@kernel
def choose_target(p, nav, point, target):
    """Set ``target`` unless it is set already.

    Args:
        p: ``target`` section of powered guidance.
        nav: ``NAV`` record.
        point: ``LANDING_POINT`` record: its coarse point is taken where one is chosen.
        target: ``POWERED_TARGET`` record.
    """
    if target.set != 0:
        return
    target.set = 1
    target.height, target.least_height = p.height, LEAST_SHARE * p.height
    descent = max(nav.v_N[2], LEAST_DESCENT)
    duration = p.time_factor * 2.0 * max(nav.height - p.height, LEAST_HEIGHT) / descent
    target.arrival = nav.t + duration
    east, north = nav.v_N[1], nav.v_N[0]
    drift = sqrt(east * east + north * north)
    ahead = p.drift_share * duration
    back_e, back_n = (east / drift, north / drift) if drift > 0.5 else (0.0, 1.0)
    if point.coarse_known != 0:
        target.point_L[0], target.point_L[1] = point.coarse_L[0], point.coarse_L[1]
        return
    target.point_L[0] = nav.site_L[0] + ahead * east - p.divert * back_e
    target.point_L[1] = nav.site_L[1] + ahead * north - p.divert * back_n


@kernel
def meet(floor, lateral_floor, t_go, nav, target):
    """Thrust acceleration north, east, up (m/s2, gravity included) that is at rest at the target in ``t_go``
    s; below the floors (s) its gains of height and lateral ones grow no further.
    """
    t = max(t_go, floor)
    up = 6.0 * (target.height - nav.height) / (t * t) + 4.0 * nav.v_N[2] / t
    t = max(t_go, lateral_floor)
    k_r, k_v = 12.0 / (t * t), 6.0 / t
    north = k_r * (target.point_L[1] - nav.site_L[1]) - k_v * nav.v_N[0]
    east = k_r * (target.point_L[0] - nav.site_L[0]) - k_v * nav.v_N[1]
    return north, east, clamp(up + nav.gravity, 0.5 * nav.gravity, 20.0)
