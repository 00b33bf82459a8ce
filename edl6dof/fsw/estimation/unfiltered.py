"""The unexplained torque and force without a filter: the fastest and the noisiest estimate.

Source: the limit of Hu et al. 2022, eqs. 9-12, for an infinite convergence speed (deadbeat); the noise of the
inertial measurement unit enters the demand unfiltered.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.vector import clamp


class UnfilteredParams(Params):
    """The unexplained torque and force of the last cycle."""

    torque_limit_nm: float = param(400.0, "largest torque that is estimated on an axis", gt=0.0)


@kernel
def estimate(params, measured, dt, memory, out):
    """Use the unexplained force and torque of the last cycle as the estimate."""
    for i in range(3):
        out.force[i] = measured.unexplained[i]
        out.torque[i] = clamp(measured.unexplained[3 + i], -params.torque_limit, params.torque_limit)
    out.pole = 1.0 / dt


MEMBER = Member("unfiltered", UnfilteredParams, {"estimate": estimate}, "Hu et al. 2022, eqs. 9-12")
