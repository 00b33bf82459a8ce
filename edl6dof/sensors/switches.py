"""Switches of the footpads, and the end switch of the trim wing.

Source: none, a switch says yes or no.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class SwitchesParams(Params):
    """Switches of footpads and trim wing."""

    end_switch: float = param(
        0.95, "opening of the trim wing at which its end switch closes", status="estimate", gt=0.0, lt=1.0
    )


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Read the switches."""
    sensed.footpad_contact = 1 if outputs.pads > 0 else 0
    sensed.wing_open = 1 if outputs.wing_opening > params.end_switch else 0


MEMBER = Member(
    "switches",
    SwitchesParams,
    {"measure": measure},
    "a switch says yes or no",
    writes=("footpad_contact", "wing_open"),
)
