"""Perfect instruments at the centre of mass: gyro, accelerometer, inertial position and velocity, attitude,
ground range, and the switches of footpads and trim wing, without error or delay.

Source: none, this is the null member of the family.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY


class PerfectParams(Params):
    """Instruments without error or delay."""

    end_switch: float = param(
        0.95, "opening of the trim wing at which its end switch closes", status="estimate", gt=0.0, lt=1.0
    )


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Copy the true state."""
    y = plant.y
    for i in range(3):
        sensed.r_I[i] = y[POSITION + i]
        sensed.v_I[i] = y[VELOCITY + i]
        sensed.w_B[i] = y[RATE + i]
        sensed.specific_force_B[i] = outputs.specific_force_B[i]
    for i in range(4):
        sensed.q_I2B[i] = y[ATTITUDE + i]
    sensed.height_above_ground = outputs.height
    sensed.footpad_contact = 1 if outputs.pads > 0 else 0
    sensed.wing_open = 1 if outputs.wing_opening > params.end_switch else 0


MEMBER = Member(
    "perfect",
    PerfectParams,
    {"measure": measure},
    "null member",
    writes=(
        *("r_I", "v_I", "w_B", "specific_force_B", "q_I2B"),
        *("height_above_ground", "footpad_contact", "wing_open"),
    ),
)
