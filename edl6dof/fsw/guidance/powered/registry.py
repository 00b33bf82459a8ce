"""The powered guidance laws of the deceleration phase.

A member has one kernel, ``guide(params, vehicle, state, nav, target, memory, out)``: it returns the thrust
acceleration it wants, north, east and up (m/s2, gravity included), and the tilt limit (rad).  ``params`` and
``memory`` are its own; ``vehicle`` is the believed one, ``state`` its mass and what its engines can do now;
``target`` is where it shall be at rest; it writes the time to go into ``out``.
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
