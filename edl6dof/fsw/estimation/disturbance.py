"""Disturbance torque and force estimators, sampled at the control rate.

Continuous form (Hu et al. 2022): torque d = xi + lambda J w, xi' = -lambda (-w x J w + T + d) (eq. 9); force
F = eta + lambda_v m v_d, v_d' = a_b, eta' = -lambda_v (F + F_c) (eqs. 10-12).  Put together each says x' =
lambda (seen - x): the estimate follows the torque J w' + w x J w - T, or the force m a_b - F_c, that the
commands do not explain, with the single pole -lambda.  (Eq. 9 prints J_est in one place and J in the other;
one believed tensor serves both here.)  Sampled, increments over one cycle stand for the derivatives,

    x += (1 - exp(-lambda dt)) (seen - x),

which has the pole of the continuous form at every rate, is stable for every lambda dt, and never integrates J
w or m v_d against the commands over long times.  T and F_c are means over just that cycle
(:mod:`edl6dof.fsw.estimation.activity`), so neither rounding by the modulator nor the age of the measurement
is mistaken for a disturbance.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel
from edl6dof.records import FLAG
from edl6dof.spatial.vector import add, clamp, cross, inertia_times, put3, scale, sub, take3


class DisturbanceParams(Params):
    """Estimators of disturbance torque and force."""

    torque_pole_rad_s: float = param(
        8.0, "convergence speed of the torque, lambda: 5 % after 3 / lambda", gt=0.0, le=50.0
    )
    torque_limit_nm: float = param(400.0, "largest torque that is estimated on an axis", gt=0.0)
    force_pole_rad_s: float = param(8.0, "convergence speed of the force, lambda_v", gt=0.0, le=50.0)


DISTURBANCE = np.dtype(
    [
        ("rate", "f8", (3,)),
        ("gain", "f8", (3,)),
        ("seen", "f8", (6,)),  # force and torque of the last cycle that the commands do not explain
        ("torque", "f8", (3,)),
        ("force", "f8", (3,)),
        ("started", FLAG),
    ],
    align=True,
)


@kernel
def unexplained_torque(inertia, w, last, applied, dt):
    """Mean torque (N m, B) over a cycle in which the rate went from ``last`` to ``w`` (rad/s), less the
    ``applied`` one.
    """
    growth = inertia_times(inertia, scale(1.0 / dt, sub(w, last)))
    middle = scale(0.5, add(w, last))
    return sub(add(growth, cross(middle, inertia_times(inertia, middle))), applied)


@kernel
def unexplained_force(mass, gain, last, applied, dt):
    """Mean force (N, B) over a cycle from the velocity gained (m/s, B), less the ``applied`` one."""
    return sub(scale(mass / dt, sub(gain, last)), applied)


@kernel
def estimate(params, inertia, mass, w, gain, applied, dt, memory):
    """Update the estimates ``memory.torque`` (N m) and ``memory.force`` (N), both in B.

    Args:
        params: disturbance record.
        inertia: believed tensor (xx, yy, zz, xy, xz, yz), kg m2.
        mass: believed mass, kg.
        w: measured body rate, rad/s.
        gain: measured velocity gain, integral of the specific force, m/s; only its increments count.
        applied: mean commanded force and torque (6) over the cycle that the two measurements end, N and N m.
        dt: cycle, s.
        memory: ``DISTURBANCE`` record.
    """
    if memory.started != 0:
        force = unexplained_force(mass, gain, take3(memory.gain, 0), take3(applied, 0), dt)
        torque = unexplained_torque(inertia, w, take3(memory.rate, 0), take3(applied, 3), dt)
        put3(memory.seen, 0, force)
        put3(memory.seen, 3, torque)
        limit = params.torque_limit
        torque_step, force_step = 1.0 - exp(-params.torque_pole * dt), 1.0 - exp(-params.force_pole * dt)
        for i in range(3):
            memory.force[i] += force_step * (force[i] - memory.force[i])
            memory.torque[i] = clamp(
                memory.torque[i] + torque_step * (torque[i] - memory.torque[i]), -limit, limit
            )
    memory.started = 1
    put3(memory.rate, 0, w)
    put3(memory.gain, 0, gain)
