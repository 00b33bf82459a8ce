"""The methods of thruster allocation.

A member has one kernel, ``share_out(params, shared, vehicle, healthy, effectiveness, demand, memory, duty,
unallocated)``: it writes ``duty`` (0..1 each) and what these leave of the demand.  ``params`` and ``memory``
are its own, ``shared`` what all methods have in common.  What was worked out from the effectiveness no
longer holds when ``effectiveness.mark`` changes.  An unallocated torque stops the integrators of attitude
control.  On the nominal flight
(``tests/flights/test_allocation_methods.py`` flies both):

    method          propellant   largest roll error   thrust direction   body rate at touchdown
    least_squares   137.0 kg     0.21 deg             10.3 deg           0.18 deg/s
    table           142.2 kg     0.42 deg             6.2 deg            0.36 deg/s

The table fires four thrusters for a roll torque where two would do, and lets one axis disturb the next.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import param
from edl6dof.fsw.allocation import least_squares, table
from edl6dof.registry import Family

ALLOCATORS = Family("thruster allocation", (least_squares.MEMBER, table.MEMBER))

_Methods: Any = ALLOCATORS.params_model(
    "AllocationMethods", "method", "least_squares", "Thruster allocation."
)


class AllocationParams(_Methods):
    """Thruster allocation: the method, and what all share."""

    torque_scale_nm: float = param(
        250.0, "torque error that weighs one; a fifth of it unallocated counts as saturated", gt=0.0
    )
    fine_share: float = param(
        0.8, "share of the fine thrusters' authority up to which they work alone", ge=0.0, le=1.0
    )


share_out = ALLOCATORS.role(
    "share_out",
    *("params", "shared", "vehicle", "healthy", "effectiveness", "demand", "memory", "duty", "unallocated"),
    own=("params", "memory"),
)
