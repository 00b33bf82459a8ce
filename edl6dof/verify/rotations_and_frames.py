"""Check cases of quaternions and of the conversions between frames."""

from __future__ import annotations

from collections import defaultdict
from math import cos, pi, sin
from typing import Any

import numpy as np
from pyquaternion import Quaternion
from scipy.spatial.transform import Rotation

from edl6dof.spatial import frames as conversions
from edl6dof.spatial import quaternion
from edl6dof.verify.case import Bench, largest

#: Random attitudes, and random places.
_TRIES = 300
#: Tolerances of quaternion algebra other than a few roundings, and why.
_LOOSE = {
    "rate": (1e-9, "central difference over 10 us"),
    "angle between": (1e-13, "digits lost near half a turn"),
    "Euler 3-2-1": (1e-11, "arcsine near the poles"),
}
_RADIUS, _FLATTENING = 3396190.0, 1.0 / 169.89
#: Frame conversions whose errors are lengths.
_LENGTHS = ("foot on ellipsoid", "geodetic height", "F to L")


class _Worst(defaultdict[str, float]):
    """Largest error of each quantity."""

    def __init__(self) -> None:
        super().__init__(float)

    def note(self, name: str, error: float) -> None:
        """Note an error of a quantity."""
        self[name] = max(self[name], error)

    def gap(self, name: str, a: Any, b: Any, size: float = 1.0) -> None:
        """Note the largest difference of two sets of numbers, divided by ``size``."""
        self.note(name, largest(np.asarray(a) - np.asarray(b)) / size)

    def attitude(self, name: str, p: tuple, q: Any) -> None:
        """Note the difference of two quaternions, each of which is the same attitude with either sign."""
        self.note(name, min(largest(np.asarray(p) - np.asarray(q)), largest(np.asarray(p) + np.asarray(q))))


def _tuple(v: np.ndarray) -> tuple[float, ...]:
    return tuple(float(c) for c in v)


def rotations(bench: Bench) -> None:
    """Verifies: quaternion algebra.

    gravity none | atmosphere none | winds none | vehicle none | source: pyquaternion (product, turning,
    axis-angle), scipy Rotation (matrices, rotation vectors, Euler angles), finite difference in time |
    tolerance 1e-14, a few roundings of numbers of size one; 1e-11 rad for Euler angles, whose arcsine
    magnifies rounding near the poles; 1e-13 for angles near half a turn; 1e-9 for the difference over 1e-5 s.

    Compare every operation at random attitudes.
    """
    rng, worst = np.random.default_rng(7), _Worst()
    for _ in range(_TRIES):
        p, q = (_tuple(x / np.linalg.norm(x)) for x in rng.normal(size=(2, 4)))
        v = _tuple(rng.normal(size=3))
        other, turn = Quaternion(q), Rotation.from_quat(q, scalar_first=True)
        worst.gap("product", quaternion.multiply(p, q), (Quaternion(p) * other).elements)
        worst.gap("conjugate", quaternion.conjugate(q), other.conjugate.elements)
        worst.gap("normalise", quaternion.normalise(tuple(2.5 * c for c in q)), other.normalised.elements)
        worst.gap("to inertial", quaternion.from_frame(q, v), other.rotate(v))
        worst.gap("to body", quaternion.to_frame(q, v), other.inverse.rotate(v))
        worst.gap("axes", np.stack(quaternion.axes(q), axis=1), turn.as_matrix())
        worst.attitude("from axes", quaternion.from_axes(*map(_tuple, turn.as_matrix().T)), q)
        worst.gap("rotation vector", quaternion.rotation_vector(q), turn.as_rotvec())
        axis = np.array(v) / np.linalg.norm(v)
        angle = float(rng.uniform(-3.0, 3.0))
        turned = Quaternion(axis=axis, radians=angle).elements
        worst.attitude("about an axis", quaternion.about_axis(_tuple(axis), angle), turned)
        between = (Rotation.from_quat(p, scalar_first=True).inv() * turn).magnitude()
        worst.note("angle between", abs(quaternion.angle_between(p, q) - between))
        yaw, pitch, roll = (float(x) for x in rng.uniform((-3.1, -1.5, -3.1), (3.1, 1.5, 3.1)))
        sequence = Rotation.from_euler("ZYX", (yaw, pitch, roll)).as_quat(scalar_first=True)
        worst.attitude("from Euler 3-2-1", quaternion.from_euler_321(yaw, pitch, roll), sequence)
        worst.gap("Euler 3-2-1", quaternion.euler_321(q), turn.as_euler("ZYX"))
        h = 1e-5
        step = float(np.linalg.norm(v)) * h
        late, early = ((other * Quaternion(axis=axis, radians=a)).elements for a in (step, -step))
        worst.gap("rate", quaternion.rate(q, v), (late - early) / (2.0 * h))
    for name, error in worst.items():
        limit, why = _LOOSE.get(name, (1e-14, "a few roundings"))
        bench.compare(name, error, limit, "-", "quaternion algebra", "pyquaternion, scipy", why)


def frames(bench: Bench) -> None:
    """Verifies: every conversion between frames.

    gravity none | atmosphere none | winds none | vehicle none | source: scipy Rotation (sequences of
    elementary turns) for directions and attitudes; the normal of the ellipsoid for positions; vectors' angle
    for great circles | tolerance 1e-13 for directions and angles of size one (sideslip reaches 1.5 rad, where
    its arcsine magnifies rounding 14 times); 2e-8 m for positions near 1e7 m, where numbers resolve 2e-9 m.

    Compare every conversion at random places, velocities and attitudes.
    """
    rng, worst = np.random.default_rng(8), _Worst()
    for _ in range(_TRIES):
        lat, lon, height = (float(x) for x in rng.uniform((-1.5, -pi, -1e4), (1.5, pi, 1e7)))
        v = rng.normal(size=3) * 1000.0
        spin = float(rng.uniform(-pi, pi))
        turned = conversions.rotate_z(cos(spin), sin(spin), _tuple(v))
        worst.gap("I to F", turned, Rotation.from_euler("z", spin).inv().apply(v), 1e3)
        to_ned = Rotation.from_euler("ZY", (lon, -lat - pi / 2.0))
        _place(worst, lat, lon, height, v, to_ned)
        _wind(worst, _tuple(v), _tuple(to_ned.apply([0.0, 0.0, -1.0])), rng)
        other_lat, other_lon = (float(x) for x in rng.uniform((-1.5, -pi), (1.5, pi)))
        ends = ((lat, lon), (other_lat, other_lon))
        arc, azimuth = conversions.great_circle(*ends)
        here, there = (np.array((cos(a) * cos(b), cos(a) * sin(b), sin(a))) for a, b in ends)
        angle = np.arctan2(np.linalg.norm(np.cross(here, there)), here @ there)
        worst.note("great-circle arc", abs(arc - angle))
        course = to_ned.inv().apply(there)
        worst.note("great-circle azimuth", abs(conversions.wrap(azimuth - np.arctan2(course[1], course[0]))))
    about = ("frame conversions", "scipy Rotation, geometry")
    far = (2e-8, "m", *about, "resolution of numbers near 1e7 m")
    near = (1e-13, "-", *about, "a few roundings")
    for name, error in worst.items():
        bench.compare(name, error, *(far if name in _LENGTHS else near))


def _place(worst: _Worst, lat: float, lon: float, height: float, v: np.ndarray, to_ned: Rotation) -> None:
    """Directions and positions of the geodetic frame: definition of the ellipsoid's normal, and back."""
    trig = (sin(lat), cos(lat), sin(lon), cos(lon))
    worst.gap("F to N", conversions.fixed_to_ned(*trig, _tuple(v)), to_ned.inv().apply(v), 1e3)
    worst.gap("N to F", conversions.ned_to_fixed(*trig, _tuple(v)), to_ned.apply(v), 1e3)
    turned = Rotation.from_quat(conversions.ned_attitude(*trig), scalar_first=True)
    worst.gap("q_F2N", turned.as_matrix(), to_ned.as_matrix())
    up = to_ned.apply([0.0, 0.0, -1.0])
    r = np.array(conversions.from_geodetic(_RADIUS, _FLATTENING, lat, lon, height))
    foot = r - height * up
    normal = foot / np.array([_RADIUS, _RADIUS, _RADIUS * (1.0 - _FLATTENING)]) ** 2
    worst.note("foot on ellipsoid", abs(float(foot @ normal) - 1.0) * _RADIUS / 2.0)
    worst.gap("geodetic normal", normal / np.linalg.norm(normal), up)
    *angles, back = conversions.geodetic(_RADIUS, _FLATTENING, _tuple(r))
    worst.note("geodetic height", abs(back - height))
    worst.gap("latitude, longitude", angles, trig)
    site = np.array(conversions.from_geodetic(_RADIUS, _FLATTENING, lat, lon, 0.0))
    east, north, upward = conversions.fixed_to_enu(_tuple(site), trig, _tuple(site + v))
    worst.gap("F to L", (north, east, -upward), to_ned.inv().apply(v))


def _wind(worst: _Worst, v: tuple[float, ...], up: tuple[float, ...], rng: np.random.Generator) -> None:
    """Bank, angle of attack and sideslip: there by elementary turns of scipy, and back."""
    bank, alpha, beta = (float(x) for x in rng.uniform((-3.1, -3.1, -1.5), (3.1, 3.1, 1.5)))
    q = conversions.attitude_from_wind_angles(v, up, bank, alpha, beta)
    x = np.array(v) / np.linalg.norm(v)
    y = np.cross(x, up)
    y /= np.linalg.norm(y)
    path = Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=1))
    body = path * Rotation.from_euler("XZY", (bank, -beta, alpha))
    turned = Rotation.from_quat(q, scalar_first=True)
    worst.gap("attitude from wind angles", turned.as_matrix(), body.as_matrix())
    v_B = _tuple(body.inv().apply(v))
    speed, alpha_back, beta_back = conversions.wind_angles(v_B)
    worst.note("angle of attack", abs(conversions.wrap(alpha_back - alpha)))
    worst.note("sideslip", abs(beta_back - beta))
    worst.note("airspeed", abs(speed / np.linalg.norm(v) - 1.0))
    total = np.arctan2(np.hypot(v_B[1], v_B[2]), v_B[0])
    worst.note("total angle", abs(conversions.total_angle_of_attack(v_B) - total))
    banked = conversions.bank_angle(v, up, *map(_tuple, body.as_matrix().T))
    worst.note("bank", abs(conversions.wrap(banked - bank)))
    v_air = _tuple(Rotation.from_rotvec(rng.uniform(-0.2, 0.2, 3)).apply(v))
    q = conversions.attitude_in_wind(v, v_air, up, bank, alpha)
    axes = Rotation.from_quat(q, scalar_first=True).as_matrix()
    banked = np.arctan2(axes[:, 1] @ np.cross(x, y), axes[:, 1] @ y)
    worst.note("bank in a wind", abs(conversions.wrap(banked - bank)))
    along = axes.T @ v_air
    worst.note("angle of attack in a wind", abs(conversions.wrap(np.arctan2(along[2], along[0]) - alpha)))
    worst.note("sideslip in a wind", abs(along[1]) / np.linalg.norm(v_air))
