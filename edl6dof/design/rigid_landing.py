"""The powered landing of a rigid body: its limits, its equations of motion and their derivatives, and the
figures of a flown or designed landing.

Position and velocity are east, north and up from the landing point.  The attitude turns the body axes S into
east, north and up; the axes S of a standing lander differ from these by its heading only, and the third is
the thrust axis.  State: mass, position (3), velocity (3), quaternion (4, scalar first), body rates in S (3);
controls: thrust, torque (3).  All functions take many states at once, along any leading axes.

Gravity is constant, there is no air, and torque costs no propellant.
Source: Szmuk & Acikmese 2018, "Successive convexification for 6-DoF Mars rocket powered landing with free
final time", AIAA 2018-0617, section II.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, inf, pi, tan

import numpy as np

STATES, CONTROLS = 14, 4
MASS, POSITION, VELOCITY, ATTITUDE, RATE = 0, slice(1, 4), slice(4, 7), slice(7, 11), slice(11, 14)
THRUST, TORQUE = 0, slice(1, 4)


@dataclass(frozen=True)
class RigidLanding:
    """A powered landing to rest at the origin, upright."""

    start: np.ndarray  # state, shape (14,)
    dry_mass: float  # least mass at the end, kg
    thrust: tuple[float, float]  # least and largest throttled thrust, N
    full_thrust: float  # full thrust at the start, N
    full_time: float  # shortest time at full thrust, s; 0: the engine is throttled from the start
    throttled_time: float  # shortest time in the throttle band, s
    torque: np.ndarray  # largest of the thrusters about each axis of S, shape (3,), N m
    exhaust_speed: float  # thrust over mass flow, m/s
    gravity: float  # downwards, m/s2
    inertia: np.ndarray  # about the axes of S, shape (3,), kg m2
    arm: np.ndarray  # torque over thrust of the main engine, in S, shape (3,), m
    tilt: float  # largest angle of the thrust axis from the vertical, rad
    rate: float  # largest body rate, rad/s
    #: least elevation of the vehicle seen from the landing point, rad; -pi / 2: none
    glide_slope: float = -pi / 2.0
    #: cost of the mean square of torque over its bounds, as a share of the mass at the start: it decides
    #: between histories of torque that need the same fuel
    torque_price: float = 1e-3

    @property
    def starts_full(self) -> bool:
        """True if the engine begins at full thrust."""
        return self.full_time > 0.0


def tilt_of(x: np.ndarray) -> np.ndarray:
    """Angle of the thrust axis from the vertical, rad, of states of shape (..., 14)."""
    return 2.0 * np.arcsin(
        np.minimum(np.hypot(x[..., 8], x[..., 9]) / np.linalg.norm(x[..., 7:11], axis=-1), 1.0)
    )


def thrust_axis(q: np.ndarray) -> np.ndarray:
    """East, north and up parts of the thrust axis, shape (..., 3), of quaternions of shape (..., 4)."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    return np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z], axis=-1)


def motion(landing: RigidLanding, x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Time derivatives of states, shape (..., 14), under controls of shape (..., 4)."""
    change = np.empty_like(x)
    rate, spin = x[..., RATE], landing.inertia * x[..., RATE]
    change[..., MASS] = -u[..., THRUST] / landing.exhaust_speed
    change[..., POSITION] = x[..., VELOCITY]
    change[..., VELOCITY] = (u[..., THRUST] / x[..., MASS])[..., None] * thrust_axis(x[..., ATTITUDE])
    change[..., 6] -= landing.gravity
    change[..., ATTITUDE] = (_turning(rate) @ x[..., ATTITUDE, None])[..., 0]
    torque = u[..., TORQUE] + u[..., THRUST, None] * landing.arm
    change[..., RATE] = (torque - np.cross(rate, spin)) / landing.inertia
    return change


def derivatives(landing: RigidLanding, x: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of :func:`motion` by the state, shape (..., 14, 14), and by the controls, (..., 14, 4)."""
    by_state, by_control = np.zeros((*x.shape, STATES)), np.zeros((*x.shape, CONTROLS))
    mass, thrust = x[..., MASS, None], u[..., THRUST, None]
    axis = thrust_axis(x[..., ATTITUDE])
    by_state[..., range(1, 4), range(4, 7)] = 1.0
    by_state[..., VELOCITY, MASS] = -thrust / mass**2 * axis
    by_state[..., VELOCITY, ATTITUDE] = (thrust / mass)[..., None] * _axis_by_attitude(x[..., ATTITUDE])
    by_state[..., ATTITUDE, ATTITUDE] = _turning(x[..., RATE])
    by_state[..., ATTITUDE, RATE] = _attitude_by_rate(x[..., ATTITUDE])
    spin = landing.inertia * x[..., RATE]
    gyroscopic = _cross(spin) - _cross(x[..., RATE]) * landing.inertia
    by_state[..., RATE, RATE] = gyroscopic / landing.inertia[:, None]
    by_control[..., MASS, THRUST] = -1.0 / landing.exhaust_speed
    by_control[..., VELOCITY, THRUST] = axis / mass
    by_control[..., RATE, THRUST] = landing.arm / landing.inertia
    by_control[..., range(11, 14), range(1, 4)] = 1.0 / landing.inertia
    return by_state, by_control


def _cross(v: np.ndarray) -> np.ndarray:
    """Matrices, shape (..., 3, 3), that multiply a vector to give the cross product of ``v`` with it."""
    x, y, z = np.moveaxis(v, -1, 0)
    nil = np.zeros_like(x)
    return _matrix([[nil, -z, y], [z, nil, -x], [-y, x, nil]])


def _turning(rate: np.ndarray) -> np.ndarray:
    """Matrices, shape (..., 4, 4), that multiply a quaternion to give its time derivative."""
    x, y, z = 0.5 * np.moveaxis(rate, -1, 0)
    nil = np.zeros_like(x)
    return _matrix([[nil, -x, -y, -z], [x, nil, z, -y], [y, -z, nil, x], [z, y, -x, nil]])


def _attitude_by_rate(q: np.ndarray) -> np.ndarray:
    """Derivative of the time derivative of a quaternion by the body rate, shape (..., 4, 3)."""
    w, x, y, z = 0.5 * np.moveaxis(q, -1, 0)
    return _matrix([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]])


def _axis_by_attitude(q: np.ndarray) -> np.ndarray:
    """Derivative of :func:`thrust_axis` by the quaternion, shape (..., 3, 4)."""
    w, x, y, z = 2.0 * np.moveaxis(q, -1, 0)
    return _matrix([[y, z, w, x], [-x, -w, z, y], [w, -x, -y, z]])


def _matrix(rows: list[list[np.ndarray]]) -> np.ndarray:
    """Matrices, in the last two axes, from rows of elements."""
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


@dataclass(frozen=True)
class LandingFigures:
    """Figures of a landing, from its first state to its last."""

    fuel_kg: float  # propellant
    time_s: float  # of flight
    tilt_deg: float  # largest angle of the thrust axis from the vertical
    rate_deg_s: float  # largest body rate
    slope_m: float  # least height over the glide slope
    miss_m: float  # distance from the landing point at the end
    speed_m_s: float  # speed at the end
    end_tilt_deg: float  # tilt at the end


def figures_of(landing: RigidLanding, t: np.ndarray, x: np.ndarray) -> LandingFigures:
    """Figures of the states ``x``, shape (n, 14), at the times ``t``, shape (n,), s."""
    away = np.hypot(x[:, 1], x[:, 2])
    free = landing.glide_slope <= -pi / 2.0
    slope = inf if free else x[:, 3] - tan(landing.glide_slope) * away
    return LandingFigures(
        fuel_kg=float(x[0, 0] - x[-1, 0]),
        time_s=float(t[-1] - t[0]),
        tilt_deg=degrees(np.max(tilt_of(x))),
        rate_deg_s=degrees(np.max(np.linalg.norm(x[:, RATE], axis=1))),
        slope_m=float(np.min(slope)),
        miss_m=float(np.linalg.norm(x[-1, POSITION])),
        speed_m_s=float(np.linalg.norm(x[-1, VELOCITY])),
        end_tilt_deg=degrees(tilt_of(x[-1])),
    )


#: A design checks its limits at some points of each interval (``successive.CHECKED``); between them they may
#: be exceeded by this share [S].  Seen: 3.3 % of the body rate.
TOLERANCE = 0.05
#: Least excess that is reported, deg and deg/s: half of the last place of a figure.
SHOWN = 0.005


@dataclass(frozen=True)
class Excess:
    """A limit that a landing exceeds."""

    what: str  # name of the figure
    by: float  # excess, in ``unit``
    unit: str
    tolerated: bool  # whether it is within ``TOLERANCE``


def excesses(landing: RigidLanding, figures: LandingFigures) -> list[Excess]:
    """The limits of tilt and body rate that a landing exceeds."""
    limits = (
        ("tilt", figures.tilt_deg, degrees(landing.tilt), "deg"),
        ("body rate", figures.rate_deg_s, degrees(landing.rate), "deg/s"),
    )
    return [
        Excess(what, value - limit, unit, value <= (1.0 + TOLERANCE) * limit)
        for what, value, limit, unit in limits
        if value > limit + SHOWN
    ]
