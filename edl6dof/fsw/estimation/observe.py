"""One control cycle of estimation: what the thrusters should have done, and the force and torque that they do
not explain.
"""

from __future__ import annotations

from edl6dof.config.base import Params, group, param
from edl6dof.fsw.estimation.activity import expect
from edl6dof.fsw.estimation.disturbance import DisturbanceParams, estimate
from edl6dof.jit import kernel
from edl6dof.spatial.vector import take3


class EstimationParams(Params):
    """Disturbance estimation."""

    disturbance: DisturbanceParams = group(DisturbanceParams, "disturbance torque and force")
    valve_lag_s: float = param(
        0.006,
        "time by which thrust follows the valve, half its rise",
        status="estimate",
        source="rise and decay of 12 ms",
        ge=0.0,
        le=0.02,
    )


@kernel
def observe(onboard, dt, fsw):
    """Update ``fsw.activity`` and ``fsw.disturbance`` from the latest inertial measurement;
    ``fsw.allocator.effect`` must be filled.
    """
    nav, p = fsw.nav, onboard.estimation
    end = nav.t - onboard.imu_delay
    expect(fsw.allocator.effect, onboard.vehicle.n_thrusters, end - dt, end, p.valve_lag, fsw.activity)
    inertia = onboard.vehicle.configuration[fsw.configuration].inertia
    tensor = (inertia[0], inertia[1], inertia[2], 0.0, 0.0, 0.0)
    rate, gain = take3(nav.imu_rate_B, 0), take3(nav.imu_gain_B, 0)
    estimate(p.disturbance, tensor, fsw.mass, rate, gain, fsw.activity.wrench, dt, fsw.disturbance)
