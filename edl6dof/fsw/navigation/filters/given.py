"""No filter: navigation copies the readings of ideal instruments.

Source: none, this is the null member of the family.
"""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class GivenParams(Params):
    """The state measured by ideal instruments."""


@kernel
def start(params, onboard, sensed, solution, memory):
    """Do nothing at the start."""


@kernel
def correct(params, onboard, health, sensed, motion, solution, memory):
    """Correct nothing."""


MEMBER = Member(
    "given",
    GivenParams,
    {"start": start, "correct": correct},
    "null member",
    reads=(
        *("r_I", "v_I", "w_B", "specific_force_B", "q_I2B", "height_above_ground"),
        *("imu_rate_B", "imu_gain_B"),
    ),
)
