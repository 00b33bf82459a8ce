"""Commands from outside: after a part of the flight software has run, a command replaces its result, if one
is given.

The part runs all the same, so that it can take over at any time, and its own result is stored (``OWN``). The
later parts use the command as its result: bank rate, throttle band, shortest pulses and the abilities of the
vehicle still limit the command.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.guidance.powered.terminal_descent import start_or_throttle
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.vector import clamp, put3, put4, take3

#: Last results of the flight software itself, before a command replaces them.
OWN = record(
    ("bank", "f8"),  # rad: of entry guidance
    ("thrust_N", "f8", (3,)),  # N, north, east, down: thrust vector of powered guidance
    ("torque_B", "f8", (3,)),  # N m, B: of attitude control
    ("duty", "f8", (MAX_THRUSTERS,)),  # of each thruster: of allocation
)


@kernel
def replace_estimate(external, estimate):
    """Put the commanded state into the ``ESTIMATE`` record of navigation."""
    if external.given.estimate == 0:
        return
    put3(estimate.r_I, 0, take3(external.r_I, 0))
    put3(estimate.v_I, 0, take3(external.v_I, 0))
    put3(estimate.w_B, 0, take3(external.w_B, 0))
    put4(estimate.q_I2B, external.q_I2B)
    estimate.height_above_ground = external.height_above_ground


@kernel
def replace_landing_point(external, point):
    """Put the commanded spots into the ``LANDING_POINT`` record of hazard detection."""
    if external.given.coarse_spot != 0:
        point.coarse_L[0], point.coarse_L[1] = external.coarse_L[0], external.coarse_L[1]
        point.coarse_known = 1
    if external.given.safe_spot != 0:
        point.fine_L[0], point.fine_L[1] = external.fine_L[0], external.fine_L[1]
        point.fine_known = 1


@kernel
def replace_bank(external, limit, before, dt, goal):
    """Set the bank angle of ``goal`` to the commanded one, or change it at the commanded rate, in both cases
    from ``before`` (rad), the bank angle of the last cycle, at no more than ``limit`` (rad/s).
    """
    if external.given.bank != 0:
        goal.bank = clamp(external.bank, before - limit * dt, before + limit * dt)
    elif external.given.bank_rate != 0:
        goal.bank = before + clamp(external.bank_rate, -limit, limit) * dt


@kernel
def replace_thrust(external, powered, state, t, goal):
    """Set the thrust of ``goal`` to the commanded vector or magnitude while the engine burns; a commanded
    vector replaces the lateral force of the thrusters. ``powered``: parameters of powered guidance.
    """
    given = external.given
    if state.ignited == 0 or (given.thrust == 0 and given.throttle == 0):
        return
    goal.full_wanted = 0
    if given.thrust != 0:
        x, y, z = take3(external.thrust_N, 0)
        size = sqrt(x * x + y * y + z * z)
        if size > 0.0:
            put3(goal.thrust_direction_N, 0, (x / size, y / size, z / size))
        goal.thrust, goal.translating = size, 0
    if given.throttle != 0:
        goal.thrust = external.throttle * state.engine.full_thrust
    weak, elapsed = state.thrust_lost > 0.0, t - state.ignition_time
    start_or_throttle(state.engine, weak, powered.full_time, powered.full_again, elapsed, out=goal)


@kernel
def replace_health(external, count, healthy):
    """Take thrusters that are isolated from outside out of use; ``count``: number of thrusters."""
    if external.given.isolate == 0:
        return
    for i in range(count):
        if external.isolated[i] != 0:
            healthy[i] = 0


@kernel
def replace_torque(external, torque, own):
    """Return the commanded torque (N m, B), or else ``torque`` of attitude control, which is stored in
    ``own``.
    """
    put3(own.torque_B, 0, torque)
    return take3(external.torque_B, 0) if external.given.torque != 0 else torque


@kernel
def replace_duties(external, count, duty, own):
    """Replace the duties of ``count`` thrusters by the commanded ones; ``own`` stores those of allocation."""
    for i in range(count):
        own.duty[i] = duty[i]
    if external.given.duties != 0:
        for i in range(count):
            duty[i] = clamp(external.duty[i], 0.0, 1.0)
