"""Vectors of three, and quaternions, as tuples of scalars: nothing here allocates."""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel


@kernel
def take3(a, start):
    """Components ``start .. start+2`` of an array as a tuple."""
    return a[start], a[start + 1], a[start + 2]


@kernel
def put3(a, start, v):
    """Write a tuple into components ``start .. start+2`` of an array."""
    a[start] = v[0]
    a[start + 1] = v[1]
    a[start + 2] = v[2]


@kernel
def take4(q):
    """Components of an array of four as a tuple."""
    return q[0], q[1], q[2], q[3]


@kernel
def put4(a, q):
    """Write a tuple of four into an array."""
    a[0], a[1], a[2], a[3] = q[0], q[1], q[2], q[3]


@kernel
def add(a, b):
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def sub(a, b):
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scale(s, a):
    """Scalar times vector."""
    return s * a[0], s * a[1], s * a[2]


@kernel
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """Return the vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def norm(a):
    """Euclidean length."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@kernel
def unit(a):
    """Direction of a vector; the zero vector stays zero."""
    length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    inverse = 1.0 / length if length > 0.0 else 0.0
    return a[0] * inverse, a[1] * inverse, a[2] * inverse


@kernel
def clamp(x, low, high):
    """``x`` limited to the closed interval [low, high]."""
    return min(max(x, low), high)


@kernel
def inertia_times(inertia, w):
    """Symmetric inertia tensor (Ixx, Iyy, Izz, Ixy, Ixz, Iyz) times a vector."""
    return (
        inertia[0] * w[0] + inertia[3] * w[1] + inertia[4] * w[2],
        inertia[3] * w[0] + inertia[1] * w[1] + inertia[5] * w[2],
        inertia[4] * w[0] + inertia[5] * w[1] + inertia[2] * w[2],
    )


@kernel
def inertia_solve(inertia, m):
    """Solve I x = m for a symmetric 3x3 tensor by its adjugate."""
    xx, yy, zz, xy, xz, yz = inertia
    a = yy * zz - yz * yz
    b = xz * yz - xy * zz
    c = xy * yz - xz * yy
    inverse = 1.0 / (xx * a + xy * b + xz * c)
    d = xx * zz - xz * xz
    e = xy * xz - xx * yz
    f = xx * yy - xy * xy
    return (
        inverse * (a * m[0] + b * m[1] + c * m[2]),
        inverse * (b * m[0] + d * m[1] + e * m[2]),
        inverse * (c * m[0] + e * m[1] + f * m[2]),
    )


@kernel
def along_track(r, v, parts):
    """The vector (I) with given parts along the radius, along the track and across it."""
    radial, across = unit(r), unit(cross(r, v))
    along = cross(across, radial)
    return add(scale(parts[0], radial), add(scale(parts[1], along), scale(parts[2], across)))
