"""Aerodynamic force and moment of the vehicle in all its configurations: the convention of every model,
bodies of constant coefficients, and the choice of the model by the shape that faces the air.

Every model takes the air-relative velocity (u, v, w) in body axes `B` (x forward through the nose, y right, z
down, m/s), the dynamic pressure ``qbar`` (Pa) and the rates (p, q, r) (rad/s), and returns (Fx, Fy, Fz, Mx,
My, Mz) in `B` (N, N m).  Moments are about a point on the x axis: ``table.moment_reference_x`` (capsule),
``bluff.centre_of_pressure_x``, ``constant.moment_reference_x``.  The caller adds (r_ref - r_cg) x F;
:func:`aerodynamic_wrench` returns the station as well.

Axisymmetric bodies are described by the total angle aT between velocity and +x, 0..pi, and the direction e =
(0, v, w)/|(v, w)|: F = qbar A (-CA, -CN e_y, -CN e_z), M = qbar A D Cm (0, e_z, -e_y).  CN and Cm vanish with
aT: zero lateral velocity is regular.
"""

from __future__ import annotations

from math import sqrt
from typing import Literal

from edl6dof.config.base import Hardware, group, param
from edl6dof.config.dtype import dtype_of
from edl6dof.kernels import inlined_kernel, kernel
from edl6dof.spatial.vector import norm
from edl6dof.vehicle.aerodynamics.body import BodyAeroParams, body_aero
from edl6dof.vehicle.aerodynamics.capsule import MIN_SPEED, CapsuleParams, capsule_aero
from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE


class ConstantAeroParams(Hardware):
    """Constant drag and rate damping (NASA NESC check cases: sphere, brick, cannonball)."""

    drag_coefficient: float = param(0.0, "CD, force against the velocity", ge=0.0)
    roll_damping: float = param(0.0, "Clp per rad of p span/2V")
    pitch_damping: float = param(0.0, "Cmq per rad of q chord/2V")
    yaw_damping: float = param(0.0, "Cnr per rad of r span/2V")
    reference_area_m2: float = param(1.0, "reference area", gt=0.0)
    span_m: float = param(1.0, "reference length of roll and yaw", gt=0.0)
    chord_m: float = param(1.0, "reference length of pitch", gt=0.0)
    moment_reference_x_m: float = param(
        0.0, "station where the drag acts; the CG for a body without static moment"
    )


class LiftDragParams(Hardware):
    """Constant drag and lift coefficient whatever the attitude: the vehicle of point-mass studies."""

    reference_area_m2: float = param(
        1.0, "reference area", gt=0.0, usual=(0.1, 1000, "probes to crewed landers")
    )
    drag_coefficient: float = param(1.0, "CD, force against the velocity", gt=0.0)
    lift_to_drag: float = param(
        0.0,
        "L/D; lift is normal to the velocity in the x-z plane of B, towards -z",
        ge=-5.0,
        le=5.0,
        usual=(0, 1.5, "ballistic capsule to lifting body"),
    )


@kernel
def constant_aero(aero, qbar, v_air, rate):
    """Constant drag and rate damping in `B`, moment about (constant.moment_reference_x, 0, 0): L = qbar S b
    Clp p b/2V, M = qbar S c Cmq q c/2V, N = qbar S b Cnr r b/2V.  Source: NASA/TM-2015-218675, cases 3 and 4.
    """
    constant = aero.constant
    u, v, w = v_air
    p, q, r = rate
    speed = norm(v_air)
    if speed < MIN_SPEED:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    force = qbar * constant.reference_area / speed
    drag = force * constant.drag_coefficient
    b2, c2 = 0.5 * constant.span**2, 0.5 * constant.chord**2
    return (
        -drag * u, -drag * v, -drag * w,
        force * b2 * constant.roll_damping * p, force * c2 * constant.pitch_damping * q,
        force * b2 * constant.yaw_damping * r,
    )  # fmt: skip


@kernel
def lift_drag_aero(lift_drag, qbar, v_air):
    """Force in `B` of constant drag D against the velocity and lift L along y_B x velocity."""
    u, v, w = v_air
    speed, plane = norm(v_air), sqrt(u * u + w * w)
    if plane < MIN_SPEED:
        return 0.0, 0.0, 0.0
    drag = qbar * lift_drag.reference_area * lift_drag.drag_coefficient
    along, across = -drag / speed, drag * lift_drag.lift_to_drag / plane
    return along * u + across * w, along * v, along * w - across * u


class BluffParams(Hardware):
    """Bluff body after a jettison: CA = CD cos aT, CN = slope sin aT at a centre of pressure on the axis."""

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
    (bluff.centre_of_pressure_x, 0, 0).  Source: engineering estimate, see :class:`BluffParams`.
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


MODEL_CAPSULE, MODEL_CONSTANT, MODEL_NONE, MODEL_LIFT_DRAG, MODEL_BODY = range(5)


def _lander() -> BluffParams:
    return BluffParams(
        reference_area_m2=5.0,
        reference_length_m=2.5,
        drag_coefficient=1.2,
        normal_slope=1.0,
        centre_of_pressure_x_m=-1.1,
        pitch_damping=-0.2,
    )


class AeroParams(Hardware):
    """Aerodynamics of the vehicle in all its configurations."""

    model: Literal["capsule", "constant", "none", "lift_drag", "body"] = param(
        "capsule", "aerodynamic model that flies"
    )
    capsule: CapsuleParams = group(CapsuleParams, "entry capsule with its heat shield")
    constant: ConstantAeroParams = group(ConstantAeroParams, "constant coefficients")
    lift_drag: LiftDragParams = group(LiftDragParams, "constant drag and lift")
    body: BodyAeroParams = group(
        BodyAeroParams,
        "body of any shape; flown until a part with the shape of a capsule has left, if there is one",
    )
    backshell: BluffParams = param(
        ..., "backshell and lander, heat shield gone", status="estimate", factory=BluffParams
    )
    lander: BluffParams = param(..., "bare lander", status="estimate", factory=_lander)


AERO = dtype_of(AeroParams)


@inlined_kernel
def aerodynamic_wrench(aero, tables, air, configuration, v_air, rate):
    """Force and moment (Fx, Fy, Fz, Mx, My, Mz) in `B` of the vehicle in its present configuration, and the
    station ``x_ref`` (m) of the point that the moment is about.

    Args:
        aero: ``AERO`` record, which chooses the model.
        tables: aerodynamic tables of a capsule and of a body of any shape.
        air: tuple of ``GAS`` record, dynamic pressure (Pa), Mach number and density (kg/m3).
        configuration: ``CONFIG_...``.
        v_air: velocity relative to the air, m/s, B.
        rate: angular velocity relative to the air, rad/s, B.
    """
    table, body_table = tables
    qbar = air[1]
    if aero.model == MODEL_NONE:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if aero.model == MODEL_CONSTANT:
        fx, fy, fz, mx, my, mz = constant_aero(aero, qbar, v_air, rate)
        return fx, fy, fz, mx, my, mz, aero.constant.moment_reference_x
    if aero.model == MODEL_LIFT_DRAG:
        fx, fy, fz = lift_drag_aero(aero.lift_drag, qbar, v_air)
        return fx, fy, fz, 0.0, 0.0, 0.0, 0.0
    if aero.model == MODEL_BODY and (configuration == CONFIG_CAPSULE or body_table.sheds == 0):
        fx, fy, fz, mx, my, mz = body_aero(aero, body_table, air, v_air, rate)
        return fx, fy, fz, mx, my, mz, aero.body.moment_reference[0]
    if aero.model == MODEL_CAPSULE and configuration == CONFIG_CAPSULE:
        fx, fy, fz, mx, my, mz = capsule_aero(aero, table, air, v_air, rate)
        return fx, fy, fz, mx, my, mz, table.moment_reference_x
    bluff = aero.backshell if configuration == CONFIG_BACKSHELL else aero.lander
    fx, fy, fz, mx, my, mz = bluff_aero(bluff, qbar, v_air, rate)
    return fx, fy, fz, mx, my, mz, bluff.centre_of_pressure_x
