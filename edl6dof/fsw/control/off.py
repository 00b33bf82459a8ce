"""No attitude control."""

from __future__ import annotations

from edl6dof.config.base import Params
from edl6dof.jit import kernel
from edl6dof.registry import Member


class OffParams(Params):
    """No attitude control: the vehicle flies freely."""


@kernel
def control(onboard, nav, guide, dt, fsw):
    """Demand nothing; no error is left to remove."""
    fsw.attitude_error[0] = fsw.attitude_error[1] = fsw.attitude_error[2] = 0.0


MEMBER = Member("off", OffParams, {"control": control}, "none")
