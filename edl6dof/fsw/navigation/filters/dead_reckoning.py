"""Dead reckoning: the solution by inertial unit, star tracker and ground tracking, with its covariance.

Nothing corrects position and velocity. The attitude is that of the star tracker while it has a fix. The
covariance is that of 21 errors: position, velocity and attitude in I; bias of gyros and accelerometers, and
the relative errors (scale factor and misalignment) of both, in B. It is propagated about once a second, with
the change of velocity and roll angle of this interval; the n instruments of a kind count as a balanced set,
whose error variance about each axis is 3/n of that of one instrument. Left out: relative errors of rotation
about other axes than x of B.

Source: Zanetti, Advanced navigation algorithms for precision landing, thesis, The University of Texas at
Austin (2007), dead reckoning of Mars entry; error equations as Titterton and Weston, Strapdown Inertial
Navigation Technology (2004), chapter 12.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.filters.kalman.covariance import deviation
from edl6dof.fsw.navigation.strapdown import adopt_attitude, gravity_I, turn_by
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Member
from edl6dof.spatial.frames import geodetic, ned_to_fixed
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, norm, put3, scale, sub, take3, take4

#: Index of the first component of each error in the covariance, and number of errors.
R, V, TURN, GYRO_BIAS, FORCE_BIAS, GYRO_RELATIVE, FORCE_RELATIVE, ERRORS = range(0, 24, 3)


class DeadReckoningParams(Params):
    """Dead reckoning with its covariance."""

    every_s: float = param(1.0, "time between two steps of the covariance", gt=0.0, le=60.0)
    gravity_m_s2: float = param(
        1e-3, "standard deviation of the error of the gravity model", status="estimate", ge=0.0, le=1.0
    )
    unknown_rate_deg_s: float = param(
        5.0, "standard deviation of the rate during a gap of the gyros", status="estimate", ge=0.0, le=1000.0
    )
    unknown_force_m_s2: float = param(
        5.0, "standard deviation of the specific force while unknown", status="estimate", ge=0.0, le=1000.0
    )


DEAD_RECKONING = record(
    ("covariance", "f8", (ERRORS, ERRORS)),  # of the errors, SI
    ("time", "f8"),  # s, since its last step
    ("age", "f8"),  # s, since the start
    ("v_I", "f8", (3,)),  # m/s, I: velocity at its last step
    ("roll", "f8"),  # rad: angle turned about x of B since its last step
    ("rate_gap", "f8"),  # s: for how long the rate has been bridged
    ("force_gap", "f8"),  # s: for how long the specific force has been unknown
)


@kernel
def start(params, onboard, sensed, solution, memory):
    """Initialise the covariance with the expected errors of tracking, star tracker and instruments."""
    P, known = memory.covariance, onboard.instruments
    gyros, forces = 3.0 / max(known.n_gyros, 1), 3.0 / max(known.n_accelerometers, 1)
    for i in range(ERRORS):
        for j in range(ERRORS):
            P[i, j] = 0.0
    for i in range(3):
        for j in range(3):
            P[R + i, R + j] = known.tracking_position[i, j]
            P[V + i, V + j] = known.tracking_velocity[i, j]
        P[TURN + i, TURN + i] = known.star_sigma**2
        P[GYRO_BIAS + i, GYRO_BIAS + i] = gyros * known.gyro_bias**2
        P[FORCE_BIAS + i, FORCE_BIAS + i] = forces * known.accelerometer_bias**2
        P[GYRO_RELATIVE + i, GYRO_RELATIVE + i] = gyros * known.gyro_scale**2
        P[FORCE_RELATIVE + i, FORCE_RELATIVE + i] = forces * known.accelerometer_scale**2
    memory.time = memory.age = memory.roll = memory.rate_gap = memory.force_gap = 0.0
    put3(memory.v_I, 0, take3(solution.v_I, 0))
    report_covariance(onboard.planet, P, solution)


@kernel
def correct(params, onboard, health, sensed, motion, solution, memory):
    """Adopt the attitude of the star tracker, and propagate the covariance when it is time."""
    P = memory.covariance
    memory.time += motion.dt
    memory.roll += motion.angle[0]
    memory.rate_gap = _widen(
        P, first=TURN, sigma=params.unknown_rate, known=motion.rate_known, dt=motion.dt, gap=memory.rate_gap
    )
    memory.force_gap = _widen(
        P, first=V, sigma=params.unknown_force, known=motion.force_known, dt=motion.dt, gap=memory.force_gap
    )
    adopted = motion.fixes > 0
    if adopted:
        adopt_attitude(sensed, motion, solution)
    if memory.time >= params.every - 0.5 * motion.dt or adopted:
        _step(params.gravity, onboard, motion, solution, memory)
        if adopted:
            _forget(P, TURN, onboard.instruments.star_sigma**2 + motion.fix_doubt)
        report_covariance(onboard.planet, P, solution)


@kernel
def _widen(P, first, sigma, known, dt, gap):
    """Add the variance of three errors while their rate is unknown (standard deviation ``sigma``); returns
    the duration of the gap (s).
    """
    if known != 0:
        return 0.0
    for i in range(first, first + 3):
        P[i, i] += sigma * sigma * dt * (2.0 * gap + dt)
    return gap + dt


@kernel
def _forget(P, first, variance):
    """Reset three errors to a ``variance`` without correlations."""
    for i in range(first, first + 3):
        for j in range(ERRORS):
            P[i, j] = P[j, i] = 0.0
        P[i, i] = variance


@kernel
def _step(gravity, onboard, motion, solution, memory):
    """Propagate the covariance over the interval since its last step; ``gravity``: constant error of the
    gravity model (m/s2).
    """
    P, known, time = memory.covariance, onboard.instruments, memory.time
    gyros, forces = 3.0 / max(known.n_gyros, 1), 3.0 / max(known.n_accelerometers, 1)
    r, v = take3(solution.r_I, 0), take3(solution.v_I, 0)
    gained = sub(sub(v, take3(memory.v_I, 0)), scale(time, gravity_I(onboard.planet, take3(solution.r_I, 0))))
    q = take4(solution.q_I2B)
    middle = turn_by(q, (-0.5 * memory.roll, 0.0, 0.0))
    for _ in range(2):
        _carry(onboard.planet.mu, r, q=middle, gained=gained, roll=memory.roll, time=time, P=P)
        for i in range(ERRORS):
            for j in range(i):
                P[i, j], P[j, i] = P[j, i], P[i, j]
    for i in range(3):
        P[V + i, V + i] += forces * known.accelerometer_noise**2 * time
        P[V + i, V + i] += gravity * gravity * time * (2.0 * memory.age + time)
        P[TURN + i, TURN + i] += gyros * known.gyro_noise**2 * time
        P[GYRO_BIAS + i, GYRO_BIAS + i] += gyros * known.gyro_bias_walk**2 * time
        P[FORCE_BIAS + i, FORCE_BIAS + i] += forces * known.accelerometer_bias_walk**2 * time
    memory.age += time
    memory.time = memory.roll = 0.0
    put3(memory.v_I, 0, v)


@kernel
def _carry(mu, r, q, gained, roll, time, P):
    """Multiply ``P`` by the transition matrix from the left. ``r``: position (m, I), ``q``: attitude in the
    middle of the step, ``gained``: velocity gained by specific force (m/s, I), ``roll``: angle turned about x
    of B (rad).
    """
    r2, size = dot(r, r), norm(gained)
    tide = mu / (r2 * sqrt(r2)) * time
    for j in range(ERRORS):
        e_r = (P[R, j], P[R + 1, j], P[R + 2, j])
        e_v = (P[V, j], P[V + 1, j], P[V + 2, j])
        e_q = (P[TURN, j], P[TURN + 1, j], P[TURN + 2, j])
        lasting = (P[FORCE_BIAS, j], P[FORCE_BIAS + 1, j], P[FORCE_BIAS + 2, j])
        relative = (P[FORCE_RELATIVE, j], P[FORCE_RELATIVE + 1, j], P[FORCE_RELATIVE + 2, j])
        e_v = add(e_v, sub(scale(3.0 * tide * dot(r, e_r) / r2, r), scale(tide, e_r)))
        e_v = add(e_v, cross(e_q, gained))
        e_v = add(e_v, from_frame(q, add(scale(time, lasting), scale(size, relative))))
        lasting = (P[GYRO_BIAS, j], P[GYRO_BIAS + 1, j], P[GYRO_BIAS + 2, j])
        relative = (P[GYRO_RELATIVE, j], P[GYRO_RELATIVE + 1, j], P[GYRO_RELATIVE + 2, j])
        e_q = add(e_q, from_frame(q, add(scale(time, lasting), scale(roll, relative))))
        e_r = add(e_r, scale(time, e_v))
        for i in range(3):
            P[R + i, j], P[V + i, j], P[TURN + i, j] = e_r[i], e_v[i], e_q[i]


@kernel
def report_covariance(planet, P, solution):
    """Write the standard deviations of position (m), velocity (m/s) and attitude (rad) along north, east and
    down, from the covariance ``P`` into ``solution``.
    """
    s_lat, c_lat, s_lon, c_lon, _ = geodetic(
        planet.equatorial_radius, planet.flattening, take3(solution.r_I, 0)
    )
    for i in range(3):
        direction = ned_to_fixed(
            s_lat,
            c_lat,
            s_lon,
            c_lon,
            (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0),
        )
        solution.sigma_r[i] = deviation(P, R, direction)
        solution.sigma_v[i] = deviation(P, V, direction)
        solution.sigma_attitude[i] = deviation(P, TURN, direction)
    solution.sigma_height = solution.sigma_r[2]


MEMBER = Member(
    "dead_reckoning",
    DeadReckoningParams,
    {"start": start, "correct": correct},
    "Zanetti, Advanced navigation algorithms for precision landing, The University of Texas at Austin (2007)",
    memory=DEAD_RECKONING,
    reads=("inertial", "stars", "tracking"),
)
