"""What a mission phase is for: the words that missions, figures and faults share."""

from __future__ import annotations

from typing import Literal, get_args

Role = Literal[
    "none",
    "trim",
    "lift",
    "parachute",
    "powered_deceleration",
    "hover_imaging",
    "hazard_avoidance",
    "slow_descent",
    "landed",
]
ROLES: tuple[Role, ...] = get_args(Role)
