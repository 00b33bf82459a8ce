"""Polynomial guidance: the thrust acceleration that meets a final position at rest at a given time to go.

Upwards a = 6 (r_f - r) / t_go^2 - 4 v / t_go, linear in time, with free final acceleration; sideways
a = 12 (r_f - r) / t_go^2 - 6 v / t_go, quadratic in time, whose final acceleration is zero: the thrust ends
upright, as S1 6.2 asks, and most of the divert comes at the start.  Gravity is added.  The final point lies
above a divert target that keeps clear of the backshell.  Source: the quadratic law of Apollo's powered
descent (Klumpp, Automatica 10 (1974) 133-146), without and with a given final acceleration; used for
Tianwen-1's powered deceleration as an estimate (the flown law is published elsewhere).
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class PolynomialParams(Params):
    """Polynomial powered guidance with a divert away from the backshell."""

    final_height_m: float = param(
        100.0, "height above ground at which velocity is zero", status="published", source="S1", gt=0.0
    )
    time_factor: float = param(
        1.0, "time to go over 2 height / descent rate", status="estimate", gt=0.2, le=3.0
    )
    drift_share: float = param(
        0.33, "share of velocity times time to go by which the target leads the vehicle", ge=0.0, le=1.0
    )
    divert_m: float = param(
        120.0, "divert against the direction of drift, away from backshell and parachute", ge=0.0
    )
    tilt_limit_deg: float = param(25.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)
    time_floor_s: float = param(2.5, "smallest time to go used in the gains of height", gt=0.0)
    lateral_time_floor_s: float = param(
        10.0, "smallest time to go used in the lateral gains, which the attitude has to follow", gt=0.0
    )


MEMORY = np.dtype([("started", FLAG), ("end", "f8"), ("target_L", "f8", (2,))], align=True)


@kernel
def guide(params, vehicle, nav, memory, out):
    """Commanded thrust acceleration north, east, up (m/s2, gravity included) and the tilt limit (rad)."""
    p = params
    if memory.started == 0:
        memory.started = 1
        descent = max(nav.v_N[2], 5.0)
        duration = p.time_factor * 2.0 * max(nav.height - p.final_height, 50.0) / descent
        memory.end = nav.t + duration
        east, north = nav.v_N[1], nav.v_N[0]
        drift = sqrt(east * east + north * north)
        ahead = p.drift_share * duration
        back_e, back_n = (east / drift, north / drift) if drift > 0.5 else (0.0, 1.0)
        memory.target_L[0] = nav.site_L[0] + ahead * east - p.divert * back_e
        memory.target_L[1] = nav.site_L[1] + ahead * north - p.divert * back_n
    out.time_to_go = memory.end - nav.t
    t_go = max(out.time_to_go, p.time_floor)
    up = 6.0 * (p.final_height - nav.height) / (t_go * t_go) + 4.0 * nav.v_N[2] / t_go
    t_go = max(out.time_to_go, p.lateral_time_floor)
    k_r, k_v = 12.0 / (t_go * t_go), 6.0 / t_go
    north = k_r * (memory.target_L[1] - nav.site_L[1]) - k_v * nav.v_N[0]
    east = k_r * (memory.target_L[0] - nav.site_L[0]) - k_v * nav.v_N[1]
    return north, east, clamp(up + nav.gravity, 0.5 * nav.gravity, 20.0), p.tilt_limit


MEMBER = Member(
    "polynomial", PolynomialParams, {"guide": guide}, "Klumpp 1974 (Apollo quadratic guidance)", MEMORY
)
