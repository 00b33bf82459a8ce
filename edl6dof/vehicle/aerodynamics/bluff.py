"""Bluff body: what is left of the capsule after a jettison, and the bare lander."""

from __future__ import annotations

from edl6dof.config.base import Hardware, param
from edl6dof.jit import kernel
from edl6dof.spatial.vector import norm
from edl6dof.vehicle.aerodynamics.shape import MIN_SPEED


class BluffParams(Hardware):
    """Bluff body after a jettison: CA = CD cos aT and CN = slope sin aT, acting at a centre of pressure on
    the axis.
    """

    reference_area_m2: float = param(
        9.079, "reference area", status="derived", source="pi/4 (3.4 m)^2", gt=0.0
    )
    reference_length_m: float = param(
        3.4, "reference length of the damping", status="published", source="S&T Daily 2021", gt=0.0
    )
    drag_coefficient: float = param(
        1.3, "axial coefficient at aT = 0; its negative at 180 deg", status="estimate", ge=0.0
    )
    normal_slope: float = param(
        0.3,
        "CN = slope sin aT; equal to the drag coefficient it makes the force pure drag",
        status="estimate",
        ge=0.0,
    )
    centre_of_pressure_x_m: float = param(
        -1.4,
        "body station of the centre of pressure; aft of the CG (more negative) is stable",
        status="estimate",
    )
    pitch_damping: float = param(-0.2, "Cmq = Cnr per rad of rate L/2V", status="estimate", le=1.0)


@kernel
def bluff_aero(bluff, qbar, v_air, rate):
    """Force and moment in `B` of a bluff body, moment (pitch and yaw damping only) about
    (bluff.centre_of_pressure_x, 0, 0).

    CA = CD cos aT, CN = slope sin aT.  Source: engineering estimate, see :class:`BluffParams`.
    """
    u, v, w = v_air
    speed = norm(v_air)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    force = qbar * bluff.reference_area / speed
    damping = force * bluff.pitch_damping * 0.5 * bluff.reference_length * bluff.reference_length
    return (
        -force * bluff.drag_coefficient * u, -force * bluff.normal_slope * v, -force * bluff.normal_slope * w,
        0.0, damping * rate[1], damping * rate[2],
    )  # fmt: skip
