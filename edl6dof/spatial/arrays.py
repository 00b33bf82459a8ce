"""Functions of arrays that give the same bits on every machine, for host code between a file and a record.

numpy chooses its trigonometry by processor, its products call BLAS, and ``np.interp`` and ``np.arange`` of
floats contain multiplications and additions that some compilers fuse.  The functions here loop in kernels, in
one order, over :mod:`edl6dof.spatial.elementary`.
"""

from __future__ import annotations

from functools import partial
from math import sqrt
from typing import Any

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.kernels.functions import choice
from edl6dof.spatial import elementary

# ---------------------------------------------------------------- functions of each number


@kernel
def _normal_share(x):
    return 0.5 * elementary.erfc(-x * sqrt(0.5))


@kernel
def _normal_quantile(share):
    """Wichura, Applied Statistics 37(3), 1988, algorithm AS 241 (PPND16)."""
    q = share - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        over = (2.5090809287301226727e3 * r + 3.3430575583588128105e4) * r + 6.7265770927008700853e4
        over = ((over * r + 4.5921953931549871457e4) * r + 1.3731693765509461125e4) * r
        over = ((over + 1.9715909503065514427e3) * r + 1.3314166789178437745e2) * r + 3.3871328727963666080e0
        under = (5.2264952788528545610e3 * r + 2.8729085735721942674e4) * r + 3.9307895800092710610e4
        under = ((under * r + 2.1213794301586595867e4) * r + 5.3941960214247511077e3) * r
        under = ((under + 6.8718700749205790830e2) * r + 4.2313330701600911252e1) * r + 1.0
        return q * over / under
    r = sqrt(-elementary.log(share if q < 0.0 else 1.0 - share))
    if r <= 5.0:
        r -= 1.6
        over = (7.74545014278341407640e-4 * r + 2.27238449892691845833e-2) * r + 2.41780725177450611770e-1
        over = ((over * r + 1.27045825245236838258e0) * r + 3.64784832476320460504e0) * r
        over = (
            (over + 5.76949722146069140550e0) * r + 4.63033784615654529590e0
        ) * r + 1.42343711074968357734e0
        under = (1.05075007164441684324e-9 * r + 5.47593808499534494600e-4) * r + 1.51986665636164571966e-2
        under = ((under * r + 1.48103976427480074590e-1) * r + 6.89767334985100004550e-1) * r
        under = ((under + 1.67638483018380384940e0) * r + 2.05319162663775882187e0) * r + 1.0
    else:
        r -= 5.0
        over = (2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r + 1.24266094738807843860e-3
        over = ((over * r + 2.65321895265761230930e-2) * r + 2.96560571828504891230e-1) * r
        over = (
            (over + 1.78482653991729133580e0) * r + 5.46378491116411436990e0
        ) * r + 6.65790464350110377720e0
        under = (2.04426310338993978564e-15 * r + 1.42151175831644588870e-7) * r + 1.84631831751005468180e-5
        under = ((under * r + 7.86869131145613259100e-4) * r + 1.48753612908506148525e-2) * r
        under = ((under + 1.36929880922735805310e-1) * r + 5.99832206555887937690e-1) * r + 1.0
    size = over / under
    return -size if q < 0.0 else size


#: The functions of one number, then those of two.
_UNARY = (
    *(elementary.sin, elementary.cos, elementary.tan, elementary.asin, elementary.acos, elementary.atan),
    *(elementary.exp, elementary.log, _normal_quantile, _normal_share),
)
_BINARY = (elementary.atan2, elementary.hypot, elementary.pow)
_FUNCTIONS = dict(enumerate((*_UNARY, *_BINARY)))
_value = choice(
    "elementary_function",
    _FUNCTIONS,
    ("x", "y"),
    {index: ("x",) if index < len(_UNARY) else ("x", "y") for index in _FUNCTIONS},
)


@kernel
def _fill(function, x, y, found):
    for k in range(x.size):
        found[k] = _value(function, x[k], y[k])


def _each(function: int, x: Any, y: Any = 0.0) -> Any:
    """Apply a function to numbers or arrays that broadcast; a number for numbers."""
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    found = np.empty(x.shape)
    _fill(function, *(np.ascontiguousarray(given).reshape(-1) for given in (x, y)), found.reshape(-1))
    return found[()]


#: Elementary functions of each number; angles in rad, as :mod:`edl6dof.spatial.elementary` has them.
sin, cos, tan, asin, acos, atan, exp, log = (partial(_each, index) for index in range(8))
#: Quantile of the standard normal distribution at each probability, to 15 digits; probability of a standard
#: normal below each value.
normal_quantile, normal_share = (partial(_each, index) for index in (8, 9))
#: Functions of pairs that broadcast: angle (rad) of a point (x, y), y first; length of (x, y); x to the y.
atan2, hypot, pow = (partial(_each, index) for index in (10, 11, 12))


def interpolate(x: Any, places: Any, values: Any) -> Any:
    """Value at each ``x`` on straight lines through points with ascending ``places``; constant beyond both
    ends.
    """
    x = np.asarray(x, dtype=float)
    places, values = (np.ascontiguousarray(given, dtype=float) for given in (places, values))
    found = np.empty(x.shape)
    _interpolate(np.ascontiguousarray(x).reshape(-1), places, values, found.reshape(-1))
    return found[()]


@kernel
def _interpolate(x, places, values, found):
    for k in range(x.size):
        found[k] = _interpolated(x[k], places, values)


@kernel
def _interpolated(x, places, values):
    last = places.size - 1
    if x != x:
        return x
    if x >= places[last]:
        return values[last]
    if x <= places[0]:
        return values[0]
    k, above = 0, last  # x lies from places[k] on and below places[above]
    while above - k > 1:
        middle = (k + above) // 2
        if places[middle] <= x:
            k = middle
        else:
            above = middle
    share = (x - places[k]) / (places[k + 1] - places[k])
    return values[k] + share * (values[k + 1] - values[k])


# ---------------------------------------------------------------- sums and products


def total(values: Any) -> float:
    """Sum in the order given.  Python's ``sum`` adds floats in another way since 3.12."""
    found = 0.0
    for value in values:
        found += float(value)
    return found


def lengths(vectors: np.ndarray) -> np.ndarray:
    """Length of each vector along the last axis."""
    square = vectors[..., 0] * vectors[..., 0]
    for k in range(1, vectors.shape[-1]):
        square = square + vectors[..., k] * vectors[..., k]
    return np.sqrt(square)


def product(a: Any, b: Any) -> np.ndarray:
    """Matrix product of (..., n, k) or (k,) and (k, m) or (k,), each sum in the order of k."""
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    found = np.zeros((*a.shape[:-1], *b.shape[1:]))
    for k in range(len(b)):
        found += a[(..., k, *(None,) * (b.ndim - 1))] * b[k]
    return found


def cholesky(matrix: np.ndarray) -> np.ndarray:
    """Lower triangle L of a symmetric matrix L L^T, shape (n, n).

    Raises:
        ValueError: the matrix is not positive definite.
    """
    matrix = np.asarray(matrix, dtype=float)
    lower = np.zeros_like(matrix)
    for j in range(len(matrix)):
        for i in range(j, len(matrix)):
            rest = matrix[i, j] - total(lower[i, k] * lower[j, k] for k in range(j))
            if i > j:
                lower[i, j] = rest / lower[j, j]
            elif rest > 0.0:
                lower[j, j] = sqrt(rest)
            else:
                raise ValueError("the matrix is not positive definite")
    return lower


def pseudo_inverse(columns: np.ndarray) -> np.ndarray:
    """The matrix P, shape (n, m), for which P y are the coefficients of the least-squares fit of independent
    ``columns``, shape (m, n), to y.

    Gram and Schmidt's orthogonalisation, done twice so that it is good to the last digits (Giraud et al.,
    Numerische Mathematik 101, 2005).
    """
    q = np.array(columns, dtype=float)
    count = q.shape[1]
    triangle = np.eye(count)
    for j in range(count):
        for _ in range(2):
            along = product(q[:, :j].T, q[:, j])
            q[:, j] -= product(q[:, :j], along)
            triangle[:j, j] += along
        triangle[j, j] = lengths(q[:, j])
        q[:, j] /= triangle[j, j]
    found = np.zeros((count, q.shape[0]))
    for j in reversed(range(count)):
        found[j] = (q[:, j] - product(triangle[j, j + 1 :], found[j + 1 :])) / triangle[j, j]
    return found


# ---------------------------------------------------------------- quadrature and waves


def gauss_legendre(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes, ascending in -1 .. 1, and weights of the Gauss-Legendre rule, each of shape (points,).

    Newton's method on Legendre's polynomial (Davis and Rabinowitz, Methods of Numerical Integration, 1984,
    section 2.7).
    """
    nodes = -cos(np.pi * (np.arange(points) + 0.75) / (points + 0.5))
    slope = np.ones(points)
    for _ in range(6):
        before, value = np.ones(points), nodes
        for n in range(2, points + 1):
            before, value = value, ((2 * n - 1) * nodes * value - (n - 1) * before) / n
        slope = points * (nodes * value - before) / (nodes * nodes - 1.0)
        nodes = nodes - value / slope
    return nodes, 2.0 / ((1.0 - nodes * nodes) * slope * slope)


def real_waves(amplitude: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Sum over (k, l) of ``amplitude[k, l]`` cos(2 pi (k x + l y) / n + ``phase[k, l]``) at whole (x, y).

    Args:
        amplitude: shape (n, n), n a power of two.
        phase: rad, same shape.

    Returns:
        Values, shape (n, n).
    """
    real, imaginary = amplitude * cos(phase), amplitude * sin(phase)
    for _ in range(2):
        _transform_rows(real, imaginary)
        real, imaginary = np.ascontiguousarray(real.T), np.ascontiguousarray(imaginary.T)
    return real


@kernel
def _transform_rows(real, imaginary):
    """Sum over k of z[k] exp(2 pi i k x / n), in place, for every row (Cooley and Tukey, radix 2)."""
    rows, n = real.shape
    for row in range(rows):
        re, im = real[row], imaginary[row]
        j = 0
        for i in range(1, n):  # bit reversal
            bit = n >> 1
            while j & bit:
                j ^= bit
                bit >>= 1
            j |= bit
            if i < j:
                re[i], re[j] = re[j], re[i]
                im[i], im[j] = im[j], im[i]
    half = 1
    while half < n:
        for k in range(half):
            s, c = elementary.sincos(np.pi * k / half)
            for row in range(rows):
                re, im = real[row], imaginary[row]
                for i in range(k, n, 2 * half):
                    x, y = c * re[i + half] - s * im[i + half], s * re[i + half] + c * im[i + half]
                    re[i], re[i + half] = re[i] + x, re[i] - x
                    im[i], im[i + half] = im[i] + y, im[i] - y
        half *= 2
