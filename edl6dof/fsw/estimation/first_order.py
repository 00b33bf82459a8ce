"""First-order estimators of disturbance torque and force, sampled at the control rate.

Continuous form (Hu et al. 2022): torque d = xi + lambda J w, xi' = -lambda (-w x J w + T + d) (eq. 9); force
F = eta + lambda_v m v_d, v_d' = a_b, eta' = -lambda_v (F + F_c) (eqs. 10-12). Combined, each pair gives x' =
lambda (seen - x): the estimate x follows the unexplained torque J w' + w x J w - T, or the unexplained force
m a_b - F_c, with the single pole -lambda. (Eq. 9 prints J_est in one place and J in the other; here both are
the believed tensor.) In the sampled form, increments over one cycle replace the derivatives:

    x += (1 - exp(-lambda dt)) (seen - x),

which has the pole of the continuous form at every rate, is stable for every lambda dt, and never integrates J
w or m v_d against the commands over long times.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import clamp


class FirstOrderParams(Params):
    """First-order estimators of disturbance torque and force."""

    torque_pole_rad_s: float = param(
        8.0, "convergence speed of the torque, lambda: 5 % after 3 / lambda", gt=0.0, le=50.0
    )
    torque_limit_nm: float = param(400.0, "largest torque that is estimated on an axis", gt=0.0)
    force_pole_rad_s: float = param(8.0, "convergence speed of the force, lambda_v", gt=0.0, le=50.0)


@kernel
def estimate(params, measured, dt, memory, out):
    """Filter the unexplained force and torque into the estimates ``out``."""
    limit, unexplained = params.torque_limit, measured.unexplained
    torque_step, force_step = 1.0 - exp(-params.torque_pole * dt), 1.0 - exp(-params.force_pole * dt)
    for i in range(3):
        out.force[i] += force_step * (unexplained[i] - out.force[i])
        out.torque[i] = clamp(
            out.torque[i] + torque_step * (unexplained[3 + i] - out.torque[i]), -limit, limit
        )
    out.pole = params.torque_pole


MEMBER = Member("first_order", FirstOrderParams, {"estimate": estimate}, "Hu et al. 2022, eqs. 9-12")
