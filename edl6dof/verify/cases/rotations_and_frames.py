"""Check cases of quaternions and of the conversions between frames."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, pi, sin

import numpy as np
from pyquaternion import Quaternion
from scipy.spatial.transform import Rotation

from edl6dof.spatial import frames as conversions
from edl6dof.spatial import quaternion
from edl6dof.verify.case import Outcome, Result, gap, noted

_ATTITUDES = 300
LOOSE = {
    "rate": (1e-9, "central difference over 10 us"),
    "angle between": (1e-13, "digits lost near half a turn"),
    "Euler 3-2-1": (1e-11, "arcsine near the poles"),
}


def _apart(p: tuple, q: np.ndarray) -> float:
    """Difference of two quaternions that stand for the same turn with either sign."""
    return min(gap(p, q), gap(p, -np.array(q)))


def rotations() -> Outcome:
    """Verifies: quaternion algebra.

    gravity none | atmosphere none | winds none | vehicle none | source: pyquaternion (product, turning,
    axis-angle), scipy Rotation (matrices, rotation vectors, Euler angles), finite difference in time |
    tolerance 1e-14, a few roundings of numbers of size one; 1e-11 rad for Euler angles, whose arcsine
    magnifies rounding near the poles; 1e-13 for angles near half a turn; 1e-9 for the difference over 1e-5 s.

    Compare every operation at random attitudes.
    """
    rng = np.random.default_rng(7)
    worst, note = noted()
    for _ in range(_ATTITUDES):
        p, q = (tuple(float(c) for c in x / np.linalg.norm(x)) for x in rng.normal(size=(2, 4)))
        v = tuple(float(c) for c in rng.normal(size=3))
        other, turn = Quaternion(q), Rotation.from_quat(q, scalar_first=True)
        note("product", gap(quaternion.multiply(p, q), (Quaternion(p) * other).elements))
        note("conjugate", gap(quaternion.conjugate(q), other.conjugate.elements))
        note("normalise", gap(quaternion.normalise(tuple(2.5 * c for c in q)), other.normalised.elements))
        note("to inertial", gap(quaternion.from_frame(q, v), other.rotate(v)))
        note("to body", gap(quaternion.to_frame(q, v), other.inverse.rotate(v)))
        note("axes", gap(np.stack(quaternion.axes(q), axis=1), turn.as_matrix()))
        columns = (tuple(float(c) for c in column) for column in turn.as_matrix().T)
        note("from axes", _apart(quaternion.from_axes(*columns), np.array(q)))
        note("rotation vector", gap(quaternion.rotation_vector(q), turn.as_rotvec()))
        axis = np.array(v) / np.linalg.norm(v)
        angle = float(rng.uniform(-3.0, 3.0))
        turned = Quaternion(axis=axis, radians=angle).elements
        note("about an axis", _apart(quaternion.about_axis(tuple(axis.tolist()), angle), turned))
        between = (Rotation.from_quat(p, scalar_first=True).inv() * turn).magnitude()
        note("angle between", abs(quaternion.angle_between(p, q) - between))
        yaw, pitch, roll = (float(x) for x in rng.uniform((-3.1, -1.5, -3.1), (3.1, 1.5, 3.1)))
        sequence = Rotation.from_euler("ZYX", (yaw, pitch, roll)).as_quat(scalar_first=True)
        note("from Euler 3-2-1", _apart(quaternion.from_euler_321(yaw, pitch, roll), sequence))
        note("Euler 3-2-1", gap(quaternion.euler_321(q), turn.as_euler("ZYX")))
        h = 1e-5
        step = float(np.linalg.norm(v)) * h
        late, early = ((other * Quaternion(axis=axis, radians=a)).elements for a in (step, -step))
        note("rate", gap(quaternion.rate(q, v), (late - early) / (2.0 * h)))
    results = []
    for name, error in worst.items():
        tolerance, why = LOOSE.get(name, (1e-14, "a few roundings"))
        results.append(Result(name, error, tolerance, "-", "quaternion algebra", "pyquaternion, scipy", why))
    return Outcome(results)


_PLACES = 300
RADIUS, FLATTENING = 3396190.0, 1.0 / 169.89
LENGTHS = ("foot on ellipsoid", "geodetic height", "F to L")


def _tuple(v: np.ndarray) -> tuple[float, ...]:
    return tuple(float(c) for c in v)


def frames() -> Outcome:
    """Verifies: every conversion between frames.

    gravity none | atmosphere none | winds none | vehicle none | source: scipy Rotation (sequences of
    elementary turns) for directions and attitudes; the normal of the ellipsoid for positions; vectors' angle
    for great circles | tolerance 1e-13 for directions and angles of size one (sideslip reaches 1.5 rad, where
    its arcsine magnifies rounding 14 times); 2e-8 m for positions near 1e7 m, where numbers resolve 2e-9 m.

    Compare every conversion at random places, velocities and attitudes.
    """
    rng = np.random.default_rng(8)
    worst, note = noted()
    for _ in range(_PLACES):
        lat, lon, height = (float(x) for x in rng.uniform((-1.5, -pi, -1e4), (1.5, pi, 1e7)))
        v = rng.normal(size=3) * 1000.0
        spin = float(rng.uniform(-pi, pi))
        turned = conversions.rotate_z(cos(spin), sin(spin), _tuple(v))
        note("I to F", gap(turned, Rotation.from_euler("z", spin).inv().apply(v)) / 1e3)
        to_ned = Rotation.from_euler("ZY", (lon, -lat - pi / 2.0))
        _place(note, lat, lon, height, v, to_ned)
        _wind(note, _tuple(v), _tuple(to_ned.apply([0.0, 0.0, -1.0])), rng)
        other_lat, other_lon = (float(x) for x in rng.uniform((-1.5, -pi), (1.5, pi)))
        ends = ((lat, lon), (other_lat, other_lon))
        arc, azimuth = conversions.great_circle(*ends)
        here, there = (np.array((cos(a) * cos(b), cos(a) * sin(b), sin(a))) for a, b in ends)
        note("great-circle arc", abs(arc - np.arctan2(np.linalg.norm(np.cross(here, there)), here @ there)))
        course = to_ned.inv().apply(there)
        note("great-circle azimuth", abs(conversions.wrap(azimuth - np.arctan2(course[1], course[0]))))
    about = ("frame conversions", "scipy Rotation, geometry")
    far = (2e-8, "m", *about, "resolution of numbers near 1e7 m")
    near = (1e-13, "-", *about, "a few roundings")
    return Outcome(
        [Result(name, error, *(far if name in LENGTHS else near)) for name, error in worst.items()]
    )


def _place(
    note: Callable[[str, float], None], lat: float, lon: float, height: float, v: np.ndarray, to_ned: Rotation
) -> None:
    """Directions and positions of the geodetic frame: definition of the ellipsoid's normal, and back."""
    trig = (sin(lat), cos(lat), sin(lon), cos(lon))
    note("F to N", gap(conversions.fixed_to_ned(*trig, _tuple(v)), to_ned.inv().apply(v)) / 1e3)
    note("N to F", gap(conversions.ned_to_fixed(*trig, _tuple(v)), to_ned.apply(v)) / 1e3)
    turned = Rotation.from_quat(conversions.ned_attitude(*trig), scalar_first=True)
    note("q_F2N", gap(turned.as_matrix(), to_ned.as_matrix()))
    up = to_ned.apply([0.0, 0.0, -1.0])
    r = np.array(conversions.from_geodetic(RADIUS, FLATTENING, lat, lon, height))
    foot = r - height * up
    normal = foot / np.array([RADIUS, RADIUS, RADIUS * (1.0 - FLATTENING)]) ** 2
    note("foot on ellipsoid", abs(float(foot @ normal) - 1.0) * RADIUS / 2.0)
    note("geodetic normal", gap(normal / np.linalg.norm(normal), up))
    *angles, back = conversions.geodetic(RADIUS, FLATTENING, _tuple(r))
    note("geodetic height", abs(back - height))
    note("latitude, longitude", gap(angles, trig))
    site = np.array(conversions.from_geodetic(RADIUS, FLATTENING, lat, lon, 0.0))
    east, north, upward = conversions.fixed_to_enu(_tuple(site), trig, _tuple(site + v))
    note("F to L", gap((north, east, -upward), to_ned.inv().apply(v)))


def _wind(
    note: Callable[[str, float], None], v: tuple[float, ...], up: tuple[float, ...], rng: np.random.Generator
) -> None:
    """Bank, angle of attack and sideslip: there by elementary turns of scipy, and back."""
    bank, alpha, beta = (float(x) for x in rng.uniform((-3.1, -3.1, -1.5), (3.1, 3.1, 1.5)))
    q = conversions.attitude_from_wind_angles(v, up, bank, alpha, beta)
    x = np.array(v) / np.linalg.norm(v)
    y = np.cross(x, up)
    y /= np.linalg.norm(y)
    path = Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=1))
    body = path * Rotation.from_euler("XZY", (bank, -beta, alpha))
    turned = Rotation.from_quat(q, scalar_first=True)
    note("attitude from wind angles", gap(turned.as_matrix(), body.as_matrix()))
    v_B = _tuple(body.inv().apply(v))
    speed, alpha_back, beta_back = conversions.wind_angles(v_B)
    note("angle of attack", abs(conversions.wrap(alpha_back - alpha)))
    note("sideslip", abs(beta_back - beta))
    note("airspeed", abs(speed / np.linalg.norm(v) - 1.0))
    total = np.arctan2(np.hypot(v_B[1], v_B[2]), v_B[0])
    note("total angle", abs(conversions.total_angle_of_attack(v_B) - total))
    axes = (_tuple(column) for column in body.as_matrix().T)
    note("bank", abs(conversions.wrap(conversions.bank_angle(v, up, *axes) - bank)))
