"""What an attitude controller may know beside navigation and the goal of guidance."""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.vector import put3, take3

CONTROL_INPUTS = np.dtype(
    [
        ("phase_time", "f8"),  # s: since the mission phase began
        ("bandwidth", "f8"),  # wanted in this phase, over that of the controller's gains
        ("hold_alpha", FLAG),  # in this phase thrusters hold the angle of attack
        ("inertia", "f8", (3,)),  # kg m2, B: believed principal moments about the axes of B
        ("saturated", FLAG),  # the thrusters could not deliver the last demand
        ("wing_commanded", FLAG),  # the trim wing was commanded open
        # N m, B: estimated; acts on the vehicle, so a controller subtracts it
        ("disturbance_torque", "f8", (3,)),
        ("disturbance_pole", "f8"),  # rad/s: convergence speed of that estimate
        # N m, B: what the valve intervals of the last cycle gave beyond the duties they stand for
        ("modulation_torque", "f8", (3,)),
    ],
    align=True,
)


@kernel
def gather_inputs(vehicle, state, phase, phase_time, disturbance, saturated, excess, inputs):
    """Fill the ``CONTROL_INPUTS`` record of this control cycle.

    Args:
        vehicle: believed vehicle.
        state: ``VEHICLE_STATE`` record.
        phase: mission phase.
        phase_time: since it began, s.
        disturbance: ``DISTURBANCE`` record.
        saturated: whether the last demand was not delivered.
        excess: torque that modulation gave beyond its duties, N m, B.
        inputs: written.
    """
    inputs.phase_time, inputs.bandwidth, inputs.hold_alpha = phase_time, phase.bandwidth, phase.hold_alpha
    put3(inputs.inertia, 0, take3(vehicle.configuration[state.configuration].inertia, 0))
    inputs.saturated = saturated
    inputs.wing_commanded = state.wing_commanded
    put3(inputs.disturbance_torque, 0, take3(disturbance.torque, 0))
    inputs.disturbance_pole = disturbance.pole
    put3(inputs.modulation_torque, 0, excess)
