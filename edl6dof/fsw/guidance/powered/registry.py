"""The powered guidance laws of the deceleration phase.

A member has one kernel, ``guide(params, vehicle, state, nav, target, memory, out)``. It returns the demanded
thrust acceleration north, east and up (m/s2, including the part that balances gravity) and the tilt limit
(rad), and writes the time to go into ``out``. ``params`` and ``memory`` belong to the member; ``vehicle`` is
the on-board model of the vehicle, ``state`` its mass and the present ability of its engines, ``target`` the
point of rest.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.powered import apollo, constant_thrust, e_guidance, gravity_turn, polynomial
from edl6dof.fsw.guidance.powered.convex import law as convex
from edl6dof.registry import Family

POWERED_LAWS = Family(
    "powered guidance law",
    (
        polynomial.MEMBER,
        gravity_turn.MEMBER,
        e_guidance.MEMBER,
        apollo.MEMBER,
        constant_thrust.MEMBER,
        convex.MEMBER,
    ),
)

powered_guidance = POWERED_LAWS.role(
    "guide", *("params", "vehicle", "state", "nav", "target", "memory", "out"), own=("params", "memory")
)
