"""Roles of mission phases: the purpose of a phase, independent of its name.

Figures, reports, studies and fault cases ask for the role of a phase; its name belongs to the scenario and is
only displayed. Several phases may share a role: then it lasts from the beginning of the first to the end of
the last, with the phases between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

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
(
    NO_ROLE,
    TRIM,
    LIFT,
    PARACHUTE,
    POWERED_DECELERATION,
    HOVER_IMAGING,
    HAZARD_AVOIDANCE,
    SLOW_DESCENT,
    LANDED,
) = ROLES


def begun(role: str) -> str:
    """Key of the time at which a role begins, among the keys of events."""
    return f"role.{role}"


def span(roles: Sequence[str], role: str) -> tuple[int, int]:
    """Index of the first phase of a role and the index after its last; (0, 0) where no phase has it.

    Args:
        roles: role of each phase in their order.
        role: role to find.
    """
    found = [index for index, own in enumerate(roles) if own == role]
    return (found[0], found[-1] + 1) if found else (0, 0)


def during(phase: np.ndarray, roles: Sequence[str], role: str) -> np.ndarray:
    """Rows in which a role lasts, shape (rows,), bool; ``phase`` is the channel ``guide.phase``."""
    first, end = span(roles, role)
    return (phase >= first) & (phase < end)
