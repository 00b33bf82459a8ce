"""Pulse-width modulation, and all that opens a valve: the valve intervals are written here and nowhere else.

A demanded duty becomes valve intervals of at least the minimum pulse: each thruster collects the on-time that
is demanded of it, and when this residual reaches its minimum pulse, the valve opens; a pulse longer than the
control cycle goes on in the next one.  The mean thrust follows the demand down to a deadband, no pulse is
shorter than the minimum, and the residual of a thruster that is no longer asked for is dropped.
Source: Hu et al. 2022, section 4.2 (linear modulation with deadband and saturation; 40 ms and 128 ms minimum
pulses).
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.jit import kernel


class ModulationParams(Params):
    """Pulse modulation of the thrusters."""

    deadband: float = param(
        0.03,
        "duty below which a valve stays shut, and distance from one within which it stays open",
        ge=0.0,
        lt=1.0,
    )


MODULATION = np.dtype(
    [
        ("residual", "f8", (MAX_THRUSTERS,)),  # s: on-time demanded and not yet given
        ("busy_until", "f8", (MAX_THRUSTERS,)),  # s, flight time: end of the shortest pulse under way
    ],
    align=True,
)


@kernel
def modulate(params, vehicle, duty, t, cycle, memory, opens, closes):
    """Turn duties into valve intervals for the cycle that starts at ``t``.

    Args:
        params: modulation record.
        vehicle: believed vehicle (thrusters: minimum pulse).
        duty: demanded duty of each, 0..1.
        t: start of the cycle, s.
        cycle: its length, s.
        memory: ``MODULATION`` record.
        opens: written, opening time of each valve, s.
        closes: written, closing time of each valve, s; equal to the opening time for no pulse.
    """
    for i in range(vehicle.n_thrusters):
        shortest = vehicle.thrusters[i].minimum_pulse
        wanted = duty[i] if duty[i] > params.deadband else 0.0
        if wanted > 1.0 - params.deadband:
            wanted = 1.0
        residual = memory.residual[i] + wanted * cycle if wanted > 0.0 else 0.0
        running = memory.busy_until[i] > t + 1e-9
        if running or residual >= shortest - 1e-9:
            closed = t + max(residual, 0.0)
            if not running:
                closed = max(closed, t + shortest)
                memory.busy_until[i] = t + shortest
            closed = max(closed, memory.busy_until[i])
            end = min(closed, t + cycle)
            opens[i], closes[i] = t, end
            residual -= end - t
        else:
            opens[i], closes[i] = t, t
        memory.residual[i] = max(residual, -shortest)


@kernel
def open_alone(thruster, on, count, t, opens, closes):
    """Open the valve of one thruster for ``on`` seconds from ``t``, and shut all others."""
    for i in range(count):
        opens[i] = closes[i] = t
    closes[thruster] = t + on


@kernel
def open_for_test(i, vehicle, t, cycle, memory, opens, closes):
    """Open the valve of thruster ``i`` for its shortest pulse, at least a cycle; no demand is charged for
    it.
    """
    end = t + max(vehicle.thrusters[i].minimum_pulse, cycle)
    opens[i], closes[i] = t, t + cycle
    memory.busy_until[i] = end
    memory.residual[i] = end - closes[i]


@kernel
def excess_torque(effectiveness, count, opens, closes, duty, cycle):
    """Torque (N m, B) that the valve intervals of the last cycle gave beyond the duties they stand for.

    Pulses are never shorter than the minimum and small duties fall into the deadband, so on average a
    thruster set gives a little less, or more, than it was asked for.
    """
    x, y, z = 0.0, 0.0, 0.0
    for i in range(count):
        if closes[i] > opens[i] or duty[i] > 0.0:
            excess = (closes[i] - opens[i]) / cycle - duty[i]
            x += excess * effectiveness[i, 3]
            y += excess * effectiveness[i, 4]
            z += excess * effectiveness[i, 5]
    return x, y, z
