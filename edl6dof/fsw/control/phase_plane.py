"""Three-axis phase-plane control with hysteresis, for the trim-angle-of-attack phase in vacuum and thin air.

Source: Hu et al. 2022, section 3; the switching function is the minimum-time parabola of a double integrator widened to a deadband
(Bryson, Control of Spacecraft and Aircraft, chapter 7).
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.control.frames import inertia_torque, wind_attitude_error
from edl6dof.jit import kernel
from edl6dof.registry import Member


class PhasePlaneParams(Params):
    """Phase-plane controller with hysteresis switching curves."""

    deadband_deg: float = param(2.0, "angle error that is left alone", gt=0.0, le=5.0)
    hysteresis: float = param(0.96, "share of the deadband down to which a firing goes on", gt=0.0, lt=1.0)
    rate_deadband_deg_s: float = param(0.15, "rate that is left alone inside the deadband", ge=0.0)
    rate_limit_deg_s: float = param(4.0, "rate beyond which the axis coasts", gt=0.0)
    acceleration_deg_s2: float = param(1.2, "angular acceleration of a firing", gt=0.0)


MEMORY = np.dtype([("firing", "i8", (3,))], align=True)


@kernel
def switch_axis(p, firing, error, rate):
    """-1, 0 or +1: torque direction for one axis, with ``error`` = goal minus actual (rad) and ``rate`` (rad/s)."""
    switching = error - rate * abs(rate) / (2.0 * p.acceleration) - 0.5 * rate
    threshold = p.deadband * (p.hysteresis if firing != 0 else 1.0)
    if abs(switching) < threshold:
        return 0
    wanted = 1 if switching > 0.0 else -1
    if wanted * rate > p.rate_limit:
        return 0
    if abs(error) < p.deadband and abs(rate) < p.rate_deadband:
        return 0
    return wanted


@kernel
def control(onboard, nav, guide, dt, fsw):
    """Demand torque on each axis whose switching curve is crossed."""
    p = onboard.control.phase_plane
    memory = fsw.control.phase_plane
    error, rate = wind_attitude_error(nav, guide)
    demand = fsw.demand
    acceleration = (
        p.acceleration * switch_axis(p, memory.firing[0], error[0], rate[0]),
        p.acceleration * switch_axis(p, memory.firing[1], error[1], rate[1]),
        p.acceleration * switch_axis(p, memory.firing[2], error[2], rate[2]),
    )
    for i in range(3):
        memory.firing[i] = 1 if acceleration[i] > 0.0 else (-1 if acceleration[i] < 0.0 else 0)
        fsw.attitude_error[i] = error[i]
    torque = inertia_torque(onboard, fsw.configuration, acceleration)
    for i in range(3):
        demand[3 + i] = torque[i]


MEMBER = Member("phase_plane", PhasePlaneParams, {"control": control}, "Hu et al. 2022, section 3", MEMORY)
