"""Aerodynamic force and moment of the vehicle in all its configurations: the model chosen, the shape seen."""

from __future__ import annotations

from typing import Literal

from edl6dof.config.base import Hardware, group, param
from edl6dof.config.dtype import dtype_of
from edl6dof.kernels import inlined_kernel
from edl6dof.vehicle.aerodynamics.body import BodyAeroParams, body_aero
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams, capsule_aero
from edl6dof.vehicle.aerodynamics.constant_coefficients import (
    BluffParams,
    ConstantAeroParams,
    LiftDragParams,
    bluff_aero,
    constant_aero,
    lift_drag_aero,
)
from edl6dof.vehicle.aerodynamics.shape import CONFIG_BACKSHELL, CONFIG_CAPSULE

MODEL_CAPSULE, MODEL_CONSTANT, MODEL_NONE, MODEL_LIFT_DRAG, MODEL_BODY = range(5)


def _backshell() -> BluffParams:
    return BluffParams()


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
        "capsule", "which aerodynamic model flies"
    )
    capsule: CapsuleParams = group(CapsuleParams, "entry capsule with its heat shield")
    constant: ConstantAeroParams = group(ConstantAeroParams, "constant coefficients")
    lift_drag: LiftDragParams = group(LiftDragParams, "constant drag and lift")
    body: BodyAeroParams = group(
        BodyAeroParams, "body of any shape; where a part shows a capsule, until that has left"
    )
    backshell: BluffParams = param(
        ..., "backshell and lander, heat shield gone", status="estimate", factory=_backshell
    )
    lander: BluffParams = param(..., "bare lander", status="estimate", factory=_lander)


AERO = dtype_of(AeroParams)


@inlined_kernel
def aerodynamic_wrench(aero, tables, air, configuration, v_air, rate):
    """(Fx, Fy, Fz, Mx, My, Mz, x_ref) of whatever flies.

    Args:
        aero: ``AERO`` record, which chooses the model.
        tables: of a capsule and of a body of any shape.
        air: ``GAS`` record, dynamic pressure (Pa), Mach number and density (kg/m3).
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
