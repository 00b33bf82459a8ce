"""Quaternions in arrays, in plain numpy: scalar first, shape (..., 4), Hamilton products, ``rotate`` turns
vectors.

The scalar kernels are in ``edl6dof.spatial.quaternion``. Importing scipy's ``Rotation`` would cost more
memory than the replay itself needs, and a tenth of a second. A test compares these functions with
pyquaternion and scipy.
"""

from __future__ import annotations

import numpy as np


def multiply(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Hamilton product: ``rotate(multiply(p, q), v)`` turns by ``q`` first, then by ``p``."""
    pw, pv, qw, qv = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    scalar = pw * qw - (pv * qv).sum(axis=-1, keepdims=True)
    return np.concatenate([scalar, pw * qv + qw * pv + np.cross(pv, qv)], axis=-1)


def rotate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """``v`` turned by the unit quaternion ``q``; both broadcast."""
    w, u = q[..., :1], q[..., 1:]
    twice = 2.0 * np.cross(u, v)
    return v + w * twice + np.cross(u, twice)


def about_z(angle: np.ndarray) -> np.ndarray:
    """Turn by ``angle`` (rad) about z."""
    zero = np.zeros_like(angle)
    return np.stack([np.cos(0.5 * angle), zero, zero, np.sin(0.5 * angle)], axis=-1)


def from_axes(axes: np.ndarray) -> np.ndarray:
    """The turn that carries x, y, z into the columns of ``axes``, shape (..., 3, 3).

    Shepperd's method in matrix form: the rows of the symmetric matrix below are all multiples of the
    quaternion; the one with the largest diagonal entry is the best conditioned.
    """
    m = np.asarray(axes, dtype=float)
    trace = np.trace(m, axis1=-2, axis2=-1)
    outer = np.empty((*m.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1.0 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        outer[..., i + 1, i + 1] = 1.0 + 2.0 * m[..., i, i] - trace
        outer[..., 0, i + 1] = outer[..., i + 1, 0] = m[..., k, j] - m[..., j, k]
        outer[..., j + 1, k + 1] = outer[..., k + 1, j + 1] = m[..., k, j] + m[..., j, k]
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(outer, best[..., None, None], axis=-2)[..., 0, :]
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def from_x_to(direction: np.ndarray) -> np.ndarray:
    """The shortest turn that carries x into ``direction``, of any length but zero."""
    unit = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    w, zero = 1.0 + unit[..., 0], np.zeros_like(unit[..., 0])
    back = w < 1e-12  # the opposite direction: half a turn about z
    q = np.stack([w, zero, -unit[..., 2], np.where(back, 1.0, unit[..., 1])], axis=-1)
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def xyzw(q: np.ndarray) -> np.ndarray:
    """Return quaternions with the scalar last, as rerun and scipy expect, of quaternions with the scalar
    first; shape (..., 4).
    """
    return np.roll(q, -1, axis=-1)
