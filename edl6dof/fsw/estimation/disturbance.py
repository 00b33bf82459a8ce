"""Disturbance-torque estimator, sampled at the control rate.

Continuous form (Hu et al. 2022, eq. 9): d = xi + lambda J w, xi' = -lambda (-w x J w + T + d), which makes the estimate follow the true
disturbance with the single pole -lambda.  Here the rate increment over one cycle takes the place of the derivative,

    d += (1 - exp(-lambda dt)) (J (w - w_last) / dt + w x J w - T - d),

which has the same pole at every rate and never integrates J w against the torque over long times.  T is the mean torque of the valve
intervals commanded for that cycle, so what the modulator rounds is not mistaken for a disturbance.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel
from edl6dof.spatial.vector import cross, inertia_times, take3


class DisturbanceParams(Params):
    """Disturbance-torque estimator."""

    pole_rad_s: float = param(1.5, "convergence speed lambda", gt=0.0, le=20.0)
    limit_nm: float = param(400.0, "largest torque that is estimated on an axis", gt=0.0)


DISTURBANCE = np.dtype([("torque", "f8", (3,)), ("rate", "f8", (3,)), ("started", "i8")], align=True)


@kernel
def estimate(params, inertia, w, applied, dt, memory):
    """Update and return the disturbance torque estimate (N m, B).

    Args:
        params: disturbance record.
        inertia: believed tensor (xx, yy, zz, xy, xz, yz).
        w: body rate now, rad/s.
        applied: mean thruster torque over the last cycle, N m.
        dt: cycle, s.
        memory: ``DISTURBANCE`` record.
    """
    if memory.started != 0:
        last = take3(memory.rate, 0)
        growth = inertia_times(inertia, ((w[0] - last[0]) / dt, (w[1] - last[1]) / dt, (w[2] - last[2]) / dt))
        gyroscopic = cross(w, inertia_times(inertia, w))
        gain = 1.0 - exp(-params.pole * dt)
        for i in range(3):
            seen = growth[i] + gyroscopic[i] - applied[i]
            new = memory.torque[i] + gain * (seen - memory.torque[i])
            memory.torque[i] = min(max(new, -params.limit), params.limit)
    memory.started = 1
    for i in range(3):
        memory.rate[i] = w[i]
    return take3(memory.torque, 0)
