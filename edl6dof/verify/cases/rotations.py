"""Verifies: quaternion algebra.

gravity none | atmosphere none | winds none | vehicle none | source: pyquaternion (product, turning,
axis-angle), scipy Rotation (matrices, rotation vectors, Euler angles), finite difference in time | tolerance
1e-14, a few roundings of numbers of size one; 1e-11 rad for Euler angles, whose arcsine magnifies rounding
near the poles; 1e-13 for angles near half a turn; 1e-9 for the difference over 1e-5 s.
"""

from __future__ import annotations

import numpy as np
from pyquaternion import Quaternion
from scipy.spatial.transform import Rotation

from edl6dof.spatial import quaternion as kernels
from edl6dof.verify.case import Outcome, Result, gap, noted

SAMPLES = 300
LOOSE = {
    "rate": (1e-9, "central difference over 10 us"),
    "angle between": (1e-13, "digits lost near half a turn"),
    "Euler 3-2-1": (1e-11, "arcsine near the poles"),
}


def _apart(p: tuple, q: np.ndarray) -> float:
    """Difference of two quaternions that stand for the same turn with either sign."""
    return min(gap(p, q), gap(p, -np.array(q)))


def run() -> Outcome:
    """Compare every operation at random attitudes."""
    rng = np.random.default_rng(7)
    worst, note = noted()
    for _ in range(SAMPLES):
        p, q = (tuple(float(c) for c in x / np.linalg.norm(x)) for x in rng.normal(size=(2, 4)))
        v = tuple(float(c) for c in rng.normal(size=3))
        other, turn = Quaternion(q), Rotation.from_quat(q, scalar_first=True)
        note("product", gap(kernels.multiply(p, q), (Quaternion(p) * other).elements))
        note("conjugate", gap(kernels.conjugate(q), other.conjugate.elements))
        note("normalise", gap(kernels.normalise(tuple(2.5 * c for c in q)), other.normalised.elements))
        note("to inertial", gap(kernels.from_frame(q, v), other.rotate(v)))
        note("to body", gap(kernels.to_frame(q, v), other.inverse.rotate(v)))
        note("axes", gap(np.stack(kernels.axes(q), axis=1), turn.as_matrix()))
        columns = (tuple(float(c) for c in column) for column in turn.as_matrix().T)
        note("from axes", _apart(kernels.from_axes(*columns), np.array(q)))
        note("rotation vector", gap(kernels.rotation_vector(q), turn.as_rotvec()))
        axis = np.array(v) / np.linalg.norm(v)
        angle = float(rng.uniform(-3.0, 3.0))
        turned = Quaternion(axis=axis, radians=angle).elements
        note("about an axis", _apart(kernels.about_axis(tuple(axis.tolist()), angle), turned))
        between = (Rotation.from_quat(p, scalar_first=True).inv() * turn).magnitude()
        note("angle between", abs(kernels.angle_between(p, q) - between))
        yaw, pitch, roll = (float(x) for x in rng.uniform((-3.1, -1.5, -3.1), (3.1, 1.5, 3.1)))
        sequence = Rotation.from_euler("ZYX", (yaw, pitch, roll)).as_quat(scalar_first=True)
        note("from Euler 3-2-1", _apart(kernels.from_euler_321(yaw, pitch, roll), sequence))
        note("Euler 3-2-1", gap(kernels.euler_321(q), turn.as_euler("ZYX")))
        h = 1e-5
        step = float(np.linalg.norm(v)) * h
        late, early = ((other * Quaternion(axis=axis, radians=a)).elements for a in (step, -step))
        note("rate", gap(kernels.rate(q, v), (late - early) / (2.0 * h)))
    results = []
    for name, error in worst.items():
        tolerance, why = LOOSE.get(name, (1e-14, "a few roundings"))
        results.append(Result(name, error, tolerance, "-", "quaternion algebra", "pyquaternion, scipy", why))
    return Outcome(results)
