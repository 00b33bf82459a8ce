"""Unit quaternions, scalar first, Hamilton product.

``q_A2B`` describes the attitude of frame B relative to A and turns components in A into components in B:
``v_B = to_frame(q_A2B, v_A)`` and back ``v_A = from_frame(q_A2B, v_B)``.  In pyquaternion's terms ``q_A2B``
is the rotation that carries the axes of A onto the axes of B, so ``Quaternion(q_A2B).inverse.rotate(v_A)``
gives ``v_B``.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import asin, atan2, cos, sin, sincos


@kernel
def multiply(p, q):
    """Hamilton product p q.  ``q_A2C = multiply(q_A2B, q_B2C)``."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@kernel
def conjugate(q):
    """Inverse of a unit quaternion: ``q_B2A = conjugate(q_A2B)``."""
    return q[0], -q[1], -q[2], -q[3]


@kernel
def normalise(q):
    """Quaternion of length one in the same direction."""
    inverse = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return q[0] * inverse, q[1] * inverse, q[2] * inverse, q[3] * inverse


@kernel
def from_frame(q, v):
    """Components in A of a vector given in B, for ``q = q_A2B`` (q v q*)."""
    s, x, y, z = q
    tx = 2.0 * (y * v[2] - z * v[1])
    ty = 2.0 * (z * v[0] - x * v[2])
    tz = 2.0 * (x * v[1] - y * v[0])
    return v[0] + s * tx + y * tz - z * ty, v[1] + s * ty + z * tx - x * tz, v[2] + s * tz + x * ty - y * tx


@kernel
def to_frame(q, v):
    """Components in B of a vector given in A, for ``q = q_A2B`` (q* v q)."""
    return from_frame((q[0], -q[1], -q[2], -q[3]), v)


@kernel
def rate(q, w):
    """Time derivative of ``q_A2B`` for the rate ``w`` of B relative to A in B, rad/s: q (0, w) / 2."""
    return (
        -0.5 * (q[1] * w[0] + q[2] * w[1] + q[3] * w[2]),
        0.5 * (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]),
        0.5 * (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]),
        0.5 * (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]),
    )


@kernel
def about_axis(axis, angle):
    """Rotation by ``angle`` (rad) about a unit axis."""
    s = sin(0.5 * angle)
    return cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]


@kernel
def from_axes(x, y, z):
    """``q_A2B`` from the unit axes of B given in A (Shepperd's method, largest element first)."""
    trace = x[0] + y[1] + z[2]
    if trace > 0.0:
        s = 2.0 * sqrt(1.0 + trace)
        q = (0.25 * s, (y[2] - z[1]) / s, (z[0] - x[2]) / s, (x[1] - y[0]) / s)
    elif x[0] > y[1] and x[0] > z[2]:
        s = 2.0 * sqrt(1.0 + x[0] - y[1] - z[2])
        q = ((y[2] - z[1]) / s, 0.25 * s, (y[0] + x[1]) / s, (z[0] + x[2]) / s)
    elif y[1] > z[2]:
        s = 2.0 * sqrt(1.0 + y[1] - x[0] - z[2])
        q = ((z[0] - x[2]) / s, (y[0] + x[1]) / s, 0.25 * s, (z[1] + y[2]) / s)
    else:
        s = 2.0 * sqrt(1.0 + z[2] - x[0] - y[1])
        q = ((x[1] - y[0]) / s, (z[0] + x[2]) / s, (z[1] + y[2]) / s, 0.25 * s)
    return normalise(q)


@kernel
def axes(q):
    """Unit axes of B in A for ``q = q_A2B``."""
    return from_frame(q, (1.0, 0.0, 0.0)), from_frame(q, (0.0, 1.0, 0.0)), from_frame(q, (0.0, 0.0, 1.0))


@kernel
def rotation_vector(q):
    """Rotation vector (axis times angle, rad, at most pi) of a unit quaternion."""
    s, x, y, z = q
    if s < 0.0:
        s, x, y, z = -s, -x, -y, -z
    sine = sqrt(x * x + y * y + z * z)
    factor = 2.0 * atan2(sine, s) / sine if sine > 1e-12 else 2.0
    return factor * x, factor * y, factor * z


@kernel
def from_euler_321(yaw, pitch, roll):
    """Quaternion of the yaw-pitch-roll sequence (3-2-1), angles in rad."""
    sy, cy = sincos(0.5 * yaw)
    sp, cp = sincos(0.5 * pitch)
    sr, cr = sincos(0.5 * roll)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


@kernel
def euler_321(q):
    """Yaw, pitch, roll (3-2-1), rad, of a unit quaternion."""
    s, x, y, z = q
    yaw = atan2(2.0 * (s * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    pitch = asin(min(max(2.0 * (s * y - z * x), -1.0), 1.0))
    roll = atan2(2.0 * (s * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    return yaw, pitch, roll


@kernel
def angle_between(p, q):
    """Angle (rad) of the rotation between two attitudes."""
    s, x, y, z = multiply(conjugate(p), q)
    return 2.0 * atan2(sqrt(x * x + y * y + z * z), abs(s))
