"""An attitude controller of your own: it stops the rates of the body.

Frames and signs, and the fields of ``nav``, ``goal`` and ``inputs``: docs/conventions.md.
"""

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member


class StopRatesParams(Params):
    """Damping of the body rates."""

    damping: float = param(0.8, "angular acceleration per rate, 1/s", gt=0.0, le=10.0)


@kernel
def control(params, nav, goal, inputs, dt, memory):
    """Return the torque that is demanded (N m, B) and the attitude error (rad)."""
    w, inertia, gain = nav.w_B, inputs.inertia, params.damping
    torque = (-gain * inertia[0] * w[0], -gain * inertia[1] * w[1], -gain * inertia[2] * w[2])
    return torque, (0.0, 0.0, 0.0)


FAMILY = "controller"
MEMBER = Member("stop_rates", StopRatesParams, {"control": control}, "proportional damping of the rates")
