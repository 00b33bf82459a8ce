"""Surfaces that unfold, such as the trim wing (trim tab) of the Tianwen-1 entry capsule: a plate next to the
backshell, opened before parachute deployment.

The wing cancels the moment of the radial CG offset, which moves the trim angle from -10 deg to 0.
"""

from __future__ import annotations

from edl6dof.config.base import REQUIRED, Hardware, Key, param
from edl6dof.config.dtype import dtype_of
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sincos
from edl6dof.spatial.vector import norm


class SurfaceParams(Hardware):
    """Size, place and effectiveness of a plate that is unfolded once, such as a trim wing."""

    name: Key = param(REQUIRED, "name in events", record=False)
    carried_by: str | None = param(
        None, "part that it leaves with; none: it stays on the vehicle", record=False
    )
    area_m2: float = param(
        REQUIRED, "area of the plate", ge=0.0, usual=(0.01, 20, "trim wings and flaps of capsules")
    )
    force_coefficient: float = param(
        REQUIRED,
        "normal force coefficient of the plate, broadside to the flow",
        ge=0.0,
        usual=(0.5, 3, "flat plate in hypersonic to subsonic flow"),
    )
    position_x_m: float = param(REQUIRED, "body station of the centre of the plate")
    position_z_m: float = param(
        REQUIRED, "body z of the centre of the plate, on the side of the centre-of-mass offset"
    )
    normal_tilt_deg: float = param(
        0.0,
        "tilt of the open plate's normal from +x away from the axis",
        status="estimate",
        gt=-90.0,
        lt=90.0,
    )
    deploy_time_s: float = param(
        REQUIRED, "time from closed to open", gt=0.0, usual=(0.05, 30, "springs to motors")
    )
    moment_factor: float = param(
        1.0, "multiplies the effectiveness (force, hence moment); 0 is a lost wing", ge=0.0, le=10.0
    )


SURFACE = dtype_of(SurfaceParams)


@kernel
def wing_opening(wing, elapsed):
    """Deflection 0..1 at ``elapsed`` s after the command: cubic ramp s^2 (3 - 2 s), engineering choice."""
    if elapsed <= 0.0:
        return 0.0
    if elapsed >= wing.deploy_time:
        return 1.0
    share = elapsed / wing.deploy_time
    return share * share * (3.0 - 2.0 * share)


@kernel
def extension(case, plant, i, t):
    """Opening 0..1 of surface ``i`` of the vehicle at ``t`` (s), reduced by faults."""
    return min(wing_opening(case.vehicle.surfaces[i], t - plant.wing_start[i]), 1.0 - plant.wing_lost[i])


@kernel
def wing_force(wing, deflection, qbar, v_air):
    """(Fx, Fy, Fz, Mx, My, Mz) in `B` (N, N m) of the wing, moment about the `B` origin.

    ``deflection`` 0 closed (no force) .. 1 open, ``qbar`` Pa, ``v_air`` air-relative velocity in `B` (m/s).
    Newtonian plate: F = -deflection qbar A C (n.v/V)^2 n on its windward side, n the normal of the open
    plate; the capsule's disturbance of the local flow is inside the coefficient.  Source: Newtonian impact
    theory; numbers tianwen1.md 1.4 [E].
    """
    speed = norm(v_air)
    if speed < 1e-9 or deflection <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x, z = wing.position_x, wing.position_z
    n_z, n_x = sincos(wing.normal_tilt)
    if z < 0.0:
        n_z = -n_z
    incidence = max((n_x * v_air[0] + n_z * v_air[2]) / speed, 0.0)
    force = (
        deflection * qbar * wing.area * wing.force_coefficient * wing.moment_factor * incidence * incidence
    )
    fx, fz = -force * n_x, -force * n_z
    return fx, 0.0, fz, 0.0, z * fx - x * fz, 0.0
