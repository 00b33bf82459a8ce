"""Three-axis phase-plane control with hysteresis, for the trim-angle-of-attack phase in vacuum and thin air.

Source: Hu et al. 2022, section 3; the switching function is the minimum-time parabola of a double integrator
with a rate lead, widened to a deadband (Bryson, Control of Spacecraft and Aircraft, chapter 7).

Limit cycle without disturbance, with error e, rate w, deadband d, hysteresis h, lead T and acceleration a: a
firing begins at e = d - w^2/2a - T w on the way out and ends at e = h d + w^2/2a + T w on the way back; half
a period is the firing, 2 w / a, and the coast between these errors of opposite sign, so that

    2 T w + w^2 / a = (1 - h) d,   amplitude d - T w,   period 4 (d - T w) / w + 2 w / a,

as long as one minimum pulse changes the rate by less than 2 w; after a larger change q the rates before and
after the pulse add up to q. With the defaults: w = 0.075 deg/s, amplitude 1.96 deg, period 104 s.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.control.attitude_error import inertia_torque, wind_attitude_error
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.registry import Member
from edl6dof.spatial.vector import take3


class PhasePlaneParams(Params):
    """Phase-plane controller with hysteresis switching curves."""

    deadband_deg: float = param(2.0, "angle error within which no torque is demanded", gt=0.0, le=5.0)
    hysteresis: float = param(0.96, "share of the deadband at which a firing ends", gt=0.0, lt=1.0)
    lead_s: float = param(0.5, "time by which the switching function predicts the error by the rate", gt=0.0)
    rate_limit_deg_s: float = param(4.0, "rate towards the goal beyond which no torque is demanded", gt=0.0)
    acceleration_deg_s2: float = param(1.2, "angular acceleration of a firing", gt=0.0)


MEMORY = record(("firing", whole(-1, 1), (3,)))


@kernel
def switch_axis(p, firing, error, rate):
    """Return the direction of torque on an axis, -1, 0 or +1, for ``error`` (goal minus actual, rad) and
    ``rate`` (rad/s).
    """
    switching = error - rate * abs(rate) / (2.0 * p.acceleration) - p.lead * rate
    threshold = p.deadband * (p.hysteresis if firing != 0 else 1.0)
    if abs(switching) < threshold:
        return 0
    wanted = 1 if switching > 0.0 else -1
    if wanted * rate > p.rate_limit:
        return 0
    return wanted


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Return the torque on each axis whose switching curve is crossed, and the attitude error."""
    p = params
    error, rate = wind_attitude_error(nav, goal)
    acceleration = (
        p.acceleration * switch_axis(p, memory.firing[0], error[0], rate[0]),
        p.acceleration * switch_axis(p, memory.firing[1], error[1], rate[1]),
        p.acceleration * switch_axis(p, memory.firing[2], error[2], rate[2]),
    )
    for i in range(3):
        memory.firing[i] = 1 if acceleration[i] > 0.0 else (-1 if acceleration[i] < 0.0 else 0)
    return inertia_torque(take3(inputs.inertia, 0), acceleration), error


MEMBER = Member("phase_plane", PhasePlaneParams, {"control": control}, "Hu et al. 2022, section 3", MEMORY)
