"""The attitude controllers a mission phase can name."""

from __future__ import annotations

from edl6dof.fsw.control import bank_to_steer, off, phase_plane, rate_damping, thrust_vector
from edl6dof.registry import Family

CONTROLLERS = Family(
    "attitude controller",
    (
        off.MEMBER,
        phase_plane.MEMBER,
        bank_to_steer.MEMBER,
        rate_damping.MEMBER,
        thrust_vector.MEMBER,
    ),
)

attitude_control = CONTROLLERS.switch("control", 5)
