"""The attitude controllers a mission phase can name.

A member has one kernel, ``control(params, nav, goal, inputs, dt, memory)``: it returns the torque it demands
(N m, B) and the attitude error it works on (rad), three numbers each.  ``params`` and ``memory`` are its own;
``nav``, ``goal`` (what guidance wants) and ``inputs`` (:mod:`edl6dof.fsw.control.inputs`) are there to be
read; ``dt`` is the control cycle (s).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from edl6dof.fsw.control import bank_to_steer, off, phase_plane, rate_damping, thrust_vector
from edl6dof.fsw.control.inputs import CONTROL_INPUTS
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

#: What each takes notice of among what a phase may ask for; of those of plugins it is not known.
HEEDS = {
    "off": (),
    "phase_plane": (),
    "bank_to_steer": ("hold_alpha",),
    "rate_damping": (),
    "thrust_vector": ("bandwidth",),
}

if TYPE_CHECKING:
    ControllerName = str
else:  # which controllers there are, plugins included, is known only when it runs
    ControllerName = Literal[CONTROLLERS.names]

CONTROL = np.dtype([("inputs", CONTROL_INPUTS), ("law", CONTROLLERS.memory)], align=True)

attitude_control = CONTROLLERS.role(
    "control", "params", "nav", "goal", "inputs", "dt", "memory", own=("params", "memory")
)
