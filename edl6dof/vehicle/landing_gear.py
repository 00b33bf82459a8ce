"""Footpads on springs and dampers with Coulomb friction, each on the plane of the ground under it; points of
the underside meet the ground in the same way.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated

from edl6dof.config.base import Capacity, Hardware, Vec3, param
from edl6dof.config.dtype import dtype_of
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import cross

MAX_FOOTPADS = 8
MAX_CONTACTS = 2 * MAX_FOOTPADS


class LandingGearParams(Hardware):
    """Legs that end in footpads; each presses along the ground's normal."""

    footpads_m: Annotated[list[Vec3], Capacity(MAX_FOOTPADS)] = param(
        None, "footpad positions in B with the legs out", factory=list, max_length=MAX_FOOTPADS
    )
    underside_m: Annotated[list[Vec3], Capacity(MAX_FOOTPADS)] = param(
        None,
        "points of the underside in B that a rock may reach: its corners, the nozzle",
        factory=list,
        max_length=MAX_FOOTPADS,
    )
    stiffness_n_m: float = param(
        60000.0, "spring constant of a leg, or of a point of the underside", status="estimate", gt=0.0
    )
    damping_n_s_m: float = param(6000.0, "damping of one leg while it is pressed", status="estimate", ge=0.0)
    friction: float = param(
        0.6,
        "Coulomb friction coefficient of a footpad on the soil",
        status="estimate",
        ge=0.0,
        le=2.0,
        usual=(0.05, 1.5, "ice to rough rock"),
    )
    slip_speed_m_s: float = param(0.05, "speed over which friction builds up (keeps it smooth)", gt=0.0)


LANDING_GEAR = dtype_of(LandingGearParams)


@kernel
def leg_force(gear, depth, v_normal, v_slip):
    """Force of one leg: (along the outward normal, friction force per unit slip velocity).

    Args:
        gear: landing-gear record.
        depth: how far the footpad is below the ground, m.
        v_normal: velocity of the footpad along the outward normal, m/s.
        v_slip: magnitude of its velocity along the ground, m/s.
    """
    if depth <= 0.0:
        return 0.0, 0.0
    # the ground pushes but never pulls
    normal = max(gear.stiffness * depth - gear.damping * v_normal, 0.0)
    return normal, -gear.friction * normal / sqrt(v_slip * v_slip + gear.slip_speed * gear.slip_speed)


@kernel
def contact(gear, point, centre, plane, motion):
    """Ground reaction on a point of the vehicle: force and moment about the origin of B (two tuples), and
    True if it touches.

    Args:
        gear: landing-gear record.
        point: the point in B, m.
        centre: centre of mass in B, m.
        plane: of the ground under the point: outward normal in B, and height of the centre of mass above the
            plane along the normal, m.
        motion: relative to the ground, in B: velocity of the centre of mass, m/s, and body rate, rad/s.
    """
    (up_B, clearance), (v_B, w_B) = plane, motion
    arm = (point[0] - centre[0], point[1] - centre[1], point[2] - centre[2])
    depth = -(clearance + arm[0] * up_B[0] + arm[1] * up_B[1] + arm[2] * up_B[2])
    if depth <= 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), False
    spin = cross(w_B, arm)
    vx, vy, vz = v_B[0] + spin[0], v_B[1] + spin[1], v_B[2] + spin[2]
    vn = vx * up_B[0] + vy * up_B[1] + vz * up_B[2]
    sx, sy, sz = vx - vn * up_B[0], vy - vn * up_B[1], vz - vn * up_B[2]
    normal, drag = leg_force(gear, depth, vn, sqrt(sx * sx + sy * sy + sz * sz))
    force = (normal * up_B[0] + drag * sx, normal * up_B[1] + drag * sy, normal * up_B[2] + drag * sz)
    return force, cross(point, force), True


@kernel
def contacts(gear):
    """Number of points that can meet the ground: the footpads, then those of the underside."""
    return gear.n_footpads + gear.n_underside


@kernel
def contact_point(gear, k):
    """Point ``k`` of those that can meet the ground, in B, m."""
    if k < gear.n_footpads:
        p = gear.footpads[k]
    else:
        p = gear.underside[k - gear.n_footpads]
    return p[0], p[1], p[2]
