"""How hard the engines work: what shakes instruments and raises dust."""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def thrust_share(case, outputs):
    """Thrust of all engines over their full thrust together; 0 without engines."""
    full = 0.0
    for i in range(case.vehicle.n_engines):
        full += case.vehicle.engines[i].full_thrust
    return outputs.engine_thrust / full if full > 0.0 else 0.0
