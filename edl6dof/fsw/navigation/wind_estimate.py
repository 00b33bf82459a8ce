"""Wind from the direction of the flow, as ports or the force across the body axis show it: the difference
from the expected wind.

Pressure ports, where they are carried, show the components (v, w) of the velocity (u, v, w) in air across the
body axis over that along it (:mod:`.flow_at_ports`). Without ports the force does: across the body axis it
grows with the angle of attack, a_y / a_x = k v / u and a_z / a_x = k w / u, with the believed slope k of
C_N / C_A. The navigated velocity less (v, w) gives two components of the wind, along the axes y and z. A
Kalman filter with the horizontal difference from the expected wind as its two states makes them consistent.
It observes the component along the flight only as far as the path is inclined.

A thruster that is stuck open and not diagnosed also pushes aside, and the force takes it for wind. The slope
is one number at trim and one about zero, but varies in between: without ports a vehicle that enters at a
large angle of attack, as that of MSL, shows a wrong wind along the flight.

The force of thrusters, swings and gusts disturb the shown angle independently after ``swing_time_s``. The
errors of the slope, of the ports, and of the navigated attitude and velocity last; they count as noise that
is independent after ``lasting_s``.

Sources: Karlgaard, Kutty, Schoenenberger, Munk, Little, Kuhl and Shidner, Mars Science Laboratory entry
atmospheric data system trajectory reconstruction, Journal of Spacecraft and Rockets 51(4), 2014 (pressure
ports in place of the force); the filter: this project.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import side_force
from edl6dof.fsw.navigation.flow_at_ports import flow_at_ports, static_pressure
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import add, scale, sub, take3, take4


class WindEstimateParams(Params):
    """Estimate of the wind from pressure ports, or from the force across the body axis."""

    enabled: bool = param(False, "whether the wind is estimated")
    sigma_m_s: float = param(
        30.0, "standard deviation of the difference from the expected wind", status="estimate", gt=0.0, le=200
    )
    change_m_s: float = param(
        0.7, "random walk of this difference in one second", status="estimate", ge=0.0, le=100.0
    )
    swing_deg: float = param(
        0.3, "standard deviation of the shown angle of attack", status="estimate", gt=0.0, le=20.0
    )
    swing_time_s: float = param(
        1.0, "time after which its error is independent", status="estimate", gt=0.0, le=100.0
    )
    slope_error: float = param(
        0.05, "relative standard deviation of the slope of the force", status="estimate", ge=0.0, lt=1.0
    )
    lasting_s: float = param(
        30.0, "time after which its effect counts as independent", status="estimate", gt=0.0, le=1000.0
    )
    reading_deg: float = param(
        1.5, "standard deviation of the angle in one reading", status="estimate", gt=0.0, le=20.0
    )
    gate: float = param(
        3.0, "standard deviations from which on a reading is not used", status="estimate", gt=0.0, le=100.0
    )
    least_force_m_s2: float = param(0.5, "axial force from which on it is used", status="estimate", gt=0.0)


#: Difference from the expected wind, and its covariance.
WIND_ESTIMATE = record(
    ("begun", FLAG),  # there was a reading
    ("t", "f8"),  # s: flight time of the last reading
    ("shift_N", "f8", (2,)),  # m/s, N: north and east
    ("variance", "f8", (2, 2)),  # m2/s2, N
)


@kernel
def shown_flow(params, onboard, pressure, ahead, nav):
    """Return the measured components along y and z of the velocity in air over that along x, and the spectral
    density of their errors, s.

    Args:
        params, onboard: ``WindEstimateParams`` record; ``ONBOARD`` record.
        pressure: readings of the ports, Pa.
        ahead: predicted velocity in air (3, B), m/s.
        nav: ``NAV`` record.
    """
    swing = params.swing**2 * params.swing_time
    if onboard.instruments.n_ports > 0:
        static = static_pressure(nav.dynamic_pressure, nav.mach)
        shown, variance, most = flow_at_ports(onboard.instruments, pressure, static, ahead)
        port = onboard.instruments.port_bias**2 + (onboard.instruments.port_scale * most) ** 2
        lasting = port * params.lasting
        return shown, (swing + lasting * variance[0], swing + lasting * variance[1])
    slope, offset = side_force(onboard.vehicle, nav.mach, nav.wing_open)
    force, share = nav.specific_force_B, params.slope_error**2 * params.lasting
    y, z = force[1] / force[0] / slope, (force[2] / force[0] - offset) / slope
    return (y, z), (swing + share * y * y, swing + share * z * z)


@kernel
def estimate_wind(params, onboard, expected_N, solution, pressure, nav, memory):
    """Correct ``memory`` (``WIND_ESTIMATE``) by the measured flow of this cycle, in free flight.

    Args:
        params, onboard: ``WindEstimateParams`` record; ``ONBOARD`` record.
        expected_N: wind that is expected here, north and east, m/s.
        solution: ``SOLUTION`` record, for its standard deviations.
        pressure: readings of the pressure ports, Pa.
        nav: ``NAV`` record.
        memory: updated.
    """
    no_ports = onboard.instruments.n_ports == 0
    if params.enabled == 0 or no_ports and side_force(onboard.vehicle, nav.mach, nav.wing_open)[0] == 0.0:
        return
    P = memory.variance
    if memory.begun == 0:
        memory.begun, memory.t = 1, nav.t
        P[0, 0] = P[1, 1] = params.sigma**2
    dt = nav.t - memory.t
    memory.t = nav.t
    if -nav.specific_force_B[0] < params.least_force or dt <= 0.0:
        return
    for i in range(2):
        P[i, i] += params.change**2 * dt
    q = take4(nav.q_I2B)
    north, east = to_frame(q, take3(nav.north_I, 0)), to_frame(q, take3(nav.east_I, 0))
    ground = to_frame(q, take3(nav.v_rel_I, 0))
    expected = sub(ground, add(scale(expected_N[0], north), scale(expected_N[1], east)))
    shift = add(scale(memory.shift_N[0], north), scale(memory.shift_N[1], east))
    shown, density = shown_flow(params, onboard, pressure, sub(expected, shift), nav)
    navigated = navigation_error(solution, nav.speed)
    for i in range(1, 3):
        noise = (density[i - 1] * nav.speed * nav.speed + navigated * params.lasting) / dt
        share = shown[i - 1]
        h = (north[i] - share * north[0], east[i] - share * east[0])
        rest = expected[i] - share * expected[0] - h[0] * memory.shift_N[0] - h[1] * memory.shift_N[1]
        spread = h[0] * (P[0, 0] * h[0] + 2.0 * P[0, 1] * h[1]) + P[1, 1] * h[1] * h[1]
        spread += (params.reading * nav.speed) ** 2
        if rest * rest < params.gate * params.gate * spread:
            correct_wind(h, noise, rest, memory)


@kernel
def navigation_error(solution, speed):
    """Return the variance of the navigated velocity across the body axis, m2/s2."""
    turned, moved = solution.sigma_attitude, solution.sigma_v
    attitude = max(turned[0], turned[1], turned[2]) * speed
    velocity = max(moved[0], moved[1], moved[2])
    return attitude * attitude + velocity * velocity


@kernel
def correct_wind(h, noise, rest, memory):
    """Kalman update by a wind component ``rest`` (m/s) above its expected value, with sensitivities ``h``."""
    P = memory.variance
    product = (P[0, 0] * h[0] + P[0, 1] * h[1], P[1, 0] * h[0] + P[1, 1] * h[1])
    total = h[0] * product[0] + h[1] * product[1] + noise
    for i in range(2):
        memory.shift_N[i] += product[i] / total * rest
        for k in range(2):
            P[i, k] -= product[i] * product[k] / total
