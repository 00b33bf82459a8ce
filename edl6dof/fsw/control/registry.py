"""The family of attitude controllers that a mission phase can name, and the record of inputs that they share.

A member has one kernel, ``control(params, nav, goal, inputs, dt, memory)``: it returns the demanded torque (N
m, B) and the attitude error (rad), three numbers each. ``params`` and ``memory`` belong to the member; it
reads ``nav``, ``goal`` (the ``GUIDE`` record of guidance) and ``inputs`` (``CONTROL_INPUTS``); ``dt`` is the
control cycle (s).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from edl6dof.fsw.control import bank_to_steer, off, phase_plane, rate_damping, thrust_vector
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Family
from edl6dof.spatial.vector import put3, take3

CONTROLLERS = Family(
    "attitude controller",
    (off.MEMBER, phase_plane.MEMBER, bank_to_steer.MEMBER, rate_damping.MEMBER, thrust_vector.MEMBER),
)

#: Settings of a phase that each controller uses; unknown for controllers from plugins.
HEEDS = {
    "off": (),
    "phase_plane": (),
    "bank_to_steer": ("hold_alpha",),
    "rate_damping": (),
    "thrust_vector": ("bandwidth",),
}

if TYPE_CHECKING:
    ControllerName = str
else:  # the names, plugins included, are known only at run time
    ControllerName = Literal[CONTROLLERS.names]

#: Inputs of a controller in addition to navigation and the goal of guidance.
CONTROL_INPUTS = record(
    ("phase_time", "f8"),  # s: since the mission phase began
    ("bandwidth", "f8"),  # bandwidth of the attitude loop in this phase, over the one that the gains give
    ("hold_alpha", FLAG),  # in this phase thrusters hold the angle of attack
    ("inertia", "f8", (3,)),  # kg m2, B: believed principal moments about the axes of B
    ("saturated", FLAG),  # the thrusters could not deliver the last demand
    ("wing_commanded", FLAG),  # the trim wing was commanded open
    # N m, B: estimated torque on the vehicle, which a controller subtracts
    ("disturbance_torque", "f8", (3,)),
    ("disturbance_pole", "f8"),  # rad/s: convergence speed of that estimate
    # N m, B: mean torque of the valve intervals of the last cycle less that of the duties
    ("modulation_torque", "f8", (3,)),
)
CONTROL = record(("inputs", CONTROL_INPUTS), ("law", CONTROLLERS.memory))

attitude_control = CONTROLLERS.role(
    "control", "params", "nav", "goal", "inputs", "dt", "memory", own=("params", "memory")
)


@kernel
def gather_inputs(vehicle, state, phase, phase_time, disturbance, saturated, excess, inputs):
    """Fill ``inputs`` (``CONTROL_INPUTS``) for a control cycle ``phase_time`` s after the phase began;
    ``excess``: torque of the valve intervals less that of the duties (N m, B).
    """
    inputs.phase_time, inputs.bandwidth, inputs.hold_alpha = phase_time, phase.bandwidth, phase.hold_alpha
    put3(inputs.inertia, 0, take3(vehicle.configuration[state.configuration].inertia, 0))
    inputs.saturated = saturated
    inputs.wing_commanded = state.wing_commanded
    put3(inputs.disturbance_torque, 0, take3(disturbance.torque, 0))
    inputs.disturbance_pole = disturbance.pole
    put3(inputs.modulation_torque, 0, excess)
