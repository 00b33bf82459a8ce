"""The powered guidance laws of the deceleration phase."""

from __future__ import annotations

from edl6dof.fsw.guidance.powered import gravity_turn, polynomial
from edl6dof.registry import Family

POWERED_LAWS = Family(
    "powered guidance law",
    (
        polynomial.MEMBER,
        gravity_turn.MEMBER,
    ),
)

powered_guidance = POWERED_LAWS.switch("guide", 4)
