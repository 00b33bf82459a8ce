"""Bank reversal when the heading error leaves a corridor that narrows with the range to go.

The heading error is the angle at the vehicle between its velocity and the great circle to the aim point.
Source: Wu, Cui & Cui 2013, section 4 and Fig. 2, which prints no numbers; the values here are chosen for this
software.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.reach import reversed_in_reach
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import asin, sin
from edl6dof.spatial.vector import clamp


class HeadingCorridorParams(Params):
    """Bank-reversal corridor: allowed heading error, linear in the range to go up to a maximum."""

    near_deg: float = param(1.0, "half width at the aim point", ge=0.0, le=90.0)
    far_deg: float = param(8.0, "half width at far_range_km and beyond", ge=0.0, le=90.0)
    far_range_km: float = param(300.0, "range to go at which the half width reaches far_deg", gt=0.0)


@kernel
def side(params, onboard, nav, memory, out, wanted, sign):
    """Return the side to bank to (+1 right, -1 left), which changes when the heading error leaves the
    corridor on the present side.
    """
    p, radius = params, onboard.planet.equatorial_radius
    error = asin(clamp(sin(out.crossrange / radius) / max(sin(out.range_to_go / radius), 1e-9), -1.0, 1.0))
    limit = p.near + (p.far - p.near) * min(out.range_to_go / p.far_range, 1.0)
    return reversed_in_reach(onboard, nav, out, sign) if sign * error > limit else sign


MEMBER = Member(
    "heading_corridor", HeadingCorridorParams, {"side": side}, "Wu, Cui & Cui 2013, section 4 and Fig. 2"
)
