"""Pulse-width modulation, and all other openings of valves: only this module writes valve intervals.

The demanded on-time of each thruster is accumulated. When a share h of its shortest pulse w is due, the valve
opens; it closes when no on-time is due any more, but not before w is over. It opens at the start of a control
cycle, stays open for as many cycles as needed, and closes at any time within a cycle. A constant duty d then
gives pulses of

    w max(1, h / (1 - d))   every   w max(1, h / (1 - d)) / d,

longer at a larger duty, and the mean thrust is proportional to the duty between deadband and saturation. A
valve never closes for so short a time that thrust would begin again before it has ended. On-time that is due
is dropped when the duty falls into the deadband.

The share h trades the number of openings against delay: at 1 a valve opens least often, at 1/2 the on-time
leads the demand as often as it lags. Figures: docs/modulation.md. Source: Hu et al. 2022, section 4.2 (linear
modulation with deadband and saturation; 40 ms and 128 ms minimum pulses); pulses whose width and spacing both
follow the demand: Wie, Space Vehicle Dynamics and Control, 2008 (pulse-width pulse-frequency modulation).
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.kernels import kernel
from edl6dof.records import record


class ModulationParams(Params):
    """Pulse modulation of the thrusters."""

    deadband: float = param(
        0.03,
        "duty up to which a valve stays shut; within the same distance of one it stays open",
        ge=0.0,
        lt=1.0,
    )
    opening_share: float = param(
        0.65, "on-time due, over the shortest pulse, from which a valve opens", ge=0.5, le=1.0
    )
    shortest_gap_s: float = param(
        0.012,
        "shortest time for which a valve closes, so that thrust ends before it begins again",
        status="estimate",
        source="decay of 12 ms",
        ge=0.0,
        le=0.1,
    )


MODULATION = record(
    ("residual", "f8", (MAX_THRUSTERS,)),  # s: on-time that is due
    ("busy_until", "f8", (MAX_THRUSTERS,)),  # s, flight time: end of the shortest pulse under way
    ("duty", "f8", (MAX_THRUSTERS,)),  # 0..1: last demanded duty
    ("open_time", "f8", (MAX_THRUSTERS,)),  # s, flight time: opening in the control cycle
    ("close_time", "f8", (MAX_THRUSTERS,)),  # s, flight time: closing; equal to the opening for no pulse
)


@kernel
def modulate(params, vehicle, duty, t, cycle, memory):
    """Turn duties (0..1) into the valve intervals of the cycle that starts at ``t`` and lasts ``cycle`` (s);
    ``memory``: ``MODULATION`` record, updated.
    """
    open_time, close_time = memory.open_time, memory.close_time
    for i in range(vehicle.n_thrusters):
        shortest = vehicle.thrusters[i].minimum_pulse
        wanted = duty[i] if duty[i] > params.deadband else 0.0
        if wanted > 1.0 - params.deadband:
            wanted = 1.0
        residual = memory.residual[i] + wanted * cycle if wanted > 0.0 else 0.0
        is_open = close_time[i] > open_time[i] and close_time[i] > t - 1e-9
        if not is_open and residual >= params.opening_share * shortest - 1e-9:
            is_open, memory.busy_until[i] = True, t + shortest
        on = min(max(residual, memory.busy_until[i] - t, 0.0), cycle) if is_open else 0.0
        if on > 0.0 and cycle - on < params.shortest_gap - 1e-9:
            on = cycle
        memory.open_time[i], memory.close_time[i] = t, t + on
        memory.duty[i] = duty[i]
        memory.residual[i] = max(residual - on, -shortest)


@kernel
def open_alone(thruster, on, count, t, memory):
    """Open the valve of one thruster for ``on`` seconds from ``t``, and shut all others."""
    for i in range(count):
        memory.open_time[i] = memory.close_time[i] = t
    memory.close_time[thruster] = t + on


@kernel
def open_for_test(i, vehicle, t, cycle, memory):
    """Open valve ``i`` for the shortest pulse, at least for a cycle, independently of the demand."""
    end = t + max(vehicle.thrusters[i].minimum_pulse, cycle)
    memory.open_time[i], memory.close_time[i] = t, t + cycle
    memory.busy_until[i] = end
    memory.residual[i] = end - memory.close_time[i]


@kernel
def close_for_test(i, memory):
    """Keep valve ``i`` closed during the cycle, independently of the demand."""
    memory.close_time[i] = memory.open_time[i]


@kernel
def command_valves(count, memory, command):
    """Command the valve intervals of the control cycle."""
    for i in range(count):
        command.valve_open_time[i], command.valve_close_time[i] = memory.open_time[i], memory.close_time[i]


@kernel
def excess_torque(effectiveness, count, cycle, memory):
    """Torque (N m, B) of the valve intervals of the last cycle less that of the duties; rows of
    ``effectiveness``: N, N m.

    As pulses have a minimum length and small duties are in the deadband, the mean torque is slightly smaller,
    or larger, than the demanded one.
    """
    open_time, close_time, duty = memory.open_time, memory.close_time, memory.duty
    x, y, z = 0.0, 0.0, 0.0
    for i in range(count):
        if close_time[i] > open_time[i] or duty[i] > 0.0:
            excess = (close_time[i] - open_time[i]) / cycle - duty[i]
            x += excess * effectiveness[i, 3]
            y += excess * effectiveness[i, 4]
            z += excess * effectiveness[i, 5]
    return x, y, z
