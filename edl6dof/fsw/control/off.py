"""No attitude control."""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class OffParams(Params):
    """No attitude control: the vehicle flies freely."""


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Demand no torque."""
    return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


MEMBER = Member("off", OffParams, {"control": control}, "none")
