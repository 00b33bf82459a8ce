"""Pulse-width modulation: a demanded duty becomes valve intervals of at least the minimum pulse.

Each thruster collects the on-time it owes.  When that reaches its minimum pulse, the valve opens; a pulse
longer than the control cycle goes on in the next one.  The mean thrust follows the demand down to a deadband,
no pulse is shorter than the minimum, and a thruster that is no longer asked for forgets what it owed.
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
        ("duty below which a valve stays shut, and distance from one within which it stays open"),
        ge=0.0,
        lt=1.0,
    )


MODULATOR = np.dtype([("owed", "f8", (MAX_THRUSTERS,)), ("busy_until", "f8", (MAX_THRUSTERS,))], align=True)


@kernel
def modulate(params, thrusters, count, duty, t, cycle, memory, opens, closes):
    """Turn duties into valve intervals for the cycle that starts at ``t``.

    Args:
        params: modulation record.
        thrusters: believed thrusters (minimum pulse).
        count: how many there are.
        duty: demanded duty of each, 0..1.
        t: start of the cycle, s.
        cycle: its length, s.
        memory: ``MODULATOR`` record.
        opens: written, opening time of each valve, s.
        closes: written, closing time of each valve, s; equal to the opening time for no pulse.
    """
    for i in range(count):
        shortest = thrusters[i].minimum_pulse
        wanted = duty[i] if duty[i] > params.deadband else 0.0
        if wanted > 1.0 - params.deadband:
            wanted = 1.0
        owed = memory.owed[i] + wanted * cycle if wanted > 0.0 else 0.0
        running = memory.busy_until[i] > t + 1e-9
        if running or owed >= shortest - 1e-9:
            closed = t + max(owed, 0.0)
            if not running:
                closed = max(closed, t + shortest)
                memory.busy_until[i] = t + shortest
            closed = max(closed, memory.busy_until[i])
            end = min(closed, t + cycle)
            opens[i], closes[i] = t, end
            owed -= end - t
        else:
            opens[i], closes[i] = t, t
        memory.owed[i] = max(owed, -shortest)
