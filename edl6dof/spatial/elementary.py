"""Elementary functions that give the same bits on every processor, operating system and library version.

Each function is a fixed sequence of ``+ - * /``, ``sqrt`` and operations on the bits of a number.  IEEE 754
rounds each of these in one way only.  None is a fused multiply-add.  The functions of a C library and of
numpy are chosen by processor and differ in the last bit.  Use the functions of this module in every kernel,
and in all code between a scenario file and a record.

Errors are below 1 ulp; special values are those of C99, annex F.  ``tests/unit/spatial/test_elementary.py``
tests both.

Sources.  Algorithms and coefficients: fdlibm 5.3, "Copyright (C) 1993 by Sun Microsystems, Inc. All rights
reserved. Developed at SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and
distribute this software is freely granted, provided that this notice is preserved", and its continuation in
FreeBSD's msun (``log10``, ``tan``).  Reduction of large angles: Payne and Hanek, ACM SIGNUM Newsletter 18(1),
1983.  ``exp`` and ``log`` by tables: Tang, ACM TOMS 15(2), 1989, and 16(4), 1990.  ``hypot``: Borges, "An
Improved Algorithm for hypot(a,b)", arXiv:1904.09481 (2019).
"""

from __future__ import annotations

from math import copysign, inf, isqrt, nan, sqrt

import numpy as np

from edl6dof.kernels import inlined_kernel, kernel

_MANTISSA = 0x000F_FFFF_FFFF_FFFF
_ONE = 0x3FF0_0000_0000_0000  # bits of 1.0
_SQRT_HALF = 0x3FE6_A09E_0000_0000  # of sqrt(1/2), to 20 bits
_HIGH = -0x1_0000_0000  # the upper 32 bits
#: Adding and subtracting it rounds a number below 2**51 to the nearest integer.
_ROUND = 6755399441055744.0

# ---------------------------------------------------------------- bits


@inlined_kernel
def _bits(x):
    """The bits of a number as a signed integer."""
    return np.float64(x).view(np.int64)


@inlined_kernel
def _number(bits):
    """The number with these bits."""
    return np.int64(bits).view(np.float64)


@inlined_kernel
def _head(x):
    """The number without the lower 32 bits: products of two heads are exact to the last few bits."""
    return _number(_bits(x) & _HIGH)


@inlined_kernel
def _scaled(x, k):
    """``x * 2**k`` for x near 1 and an integer k; rounds once, also where the result is subnormal."""
    if -1022 <= k <= 1023:
        return x * _number((k + 1023) << 52)
    if k > 1023:
        return x * 2.0 * _number((min(k, 1024) + 1022) << 52)
    return x * _number((max(k, -1200) + 1223) << 52) * 2.0**-200


@inlined_kernel
def _exact_product(a, b):
    """The product of two numbers and its rounding error (Veltkamp, Dekker)."""
    product = a * b
    c, d = 134217729.0 * a, 134217729.0 * b
    a1, b1 = c - (c - a), d - (d - b)
    a2, b2 = a - a1, b - b1
    return product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2


# ---------------------------------------------------------------- angles

_PI, _PI_LOW = 3.14159265358979311600e00, 1.22464679914735317720e-16
_HALF_PI, _HALF_PI_LOW = 1.57079632679489655800e00, 6.12323399573676603587e-17
_QUARTER_PI, _QUARTER_PI_LOW = 7.85398163397448278999e-01, 3.06161699786838301793e-17
_TWO_OVER_PI = 6.36619772367581382433e-01
#: pi/2 in parts of 33 bits, and the remainders after the second and the third.
_P1, _P2, _P3 = 1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624871116645580e-21
_P2_LOW, _P3_LOW = 2.02226624879595063154e-21, 8.47842766036889956997e-32
#: Above it the products with these parts are no longer exact.
_LARGE = 2.0**20 * _HALF_PI


def _bits_of_two_over_pi(words: int) -> np.ndarray:
    """2/pi in words of 64 bits after a word of zeros, by Machin's formula in integers."""
    one = 1 << 64 * (words + 1)

    def arccot(n: int) -> int:
        term, total, k = one // n, 0, 0
        while term:
            total += (-1) ** k * (term // (2 * k + 1))
            term, k = term // (n * n), k + 1
        return total

    pi = 4 * (4 * arccot(5) - arccot(239))
    value = 2 * one * one // pi >> 64
    found = [value >> 64 * (words - 1 - k) & 0xFFFF_FFFF_FFFF_FFFF for k in range(words)]
    return np.array([0, *found], dtype=np.uint64)


_WORDS_OF_TWO_OVER_PI = _bits_of_two_over_pi(20)
_U32, _LOW_32 = np.uint64(32), np.uint64(0xFFFF_FFFF)


@kernel
def _word(start, k):
    """64 bits of 2/pi from bit ``start + 64 k`` on."""
    place, shift = (start >> 6) + k, np.uint64(start & 63)
    word = _WORDS_OF_TWO_OVER_PI[place]
    if shift == np.uint64(0):
        return word
    return (word << shift) | (_WORDS_OF_TWO_OVER_PI[place + 1] >> (np.uint64(64) - shift))


@kernel
def _upper_product(a, b):
    """The upper 64 bits of the product of two unsigned integers of 64 bits."""
    a1, a0, b1, b0 = a >> _U32, a & _LOW_32, b >> _U32, b & _LOW_32
    middle = a1 * b0 + ((a0 * b0) >> _U32)
    other = a0 * b1 + (middle & _LOW_32)
    return a1 * b1 + (middle >> _U32) + (other >> _U32)


@kernel
def _reduce_large(x):
    """As :func:`_reduce`, of any finite angle: times 192 bits of 2/pi, in integers (Payne and Hanek)."""
    bits = _bits(abs(x))
    mantissa = np.uint64((bits & _MANTISSA) | (_MANTISSA + 1))
    start = (bits >> 52) - 1075 + 62  # bits of 2/pi above it give whole turns
    w0, w1, w2 = _word(start, 0), _word(start, 1), _word(start, 2)
    low = mantissa * w2
    carried = _upper_product(mantissa, w2)
    middle = mantissa * w1 + carried
    carry = np.uint64(1) if middle < carried else np.uint64(0)
    high = mantissa * w0 + _upper_product(mantissa, w1) + carry
    quadrant = np.int64(high >> np.uint64(62))
    two, rest = np.uint64(2), np.uint64(62)
    high, middle, low = (high << two) | (middle >> rest), (middle << two) | (low >> rest), low << two
    sign = 1.0
    if high >> np.uint64(63) == np.uint64(1):  # more than half a quadrant: go down from the next
        quadrant, sign = quadrant + 1, -1.0
        high, middle, low = ~high, ~middle, ~low
    p0, p1 = float(high >> _U32) * 2.0**-32, float(high & _LOW_32) * 2.0**-64
    p2, p3 = float(middle >> _U32) * 2.0**-96, float(middle & _LOW_32) * 2.0**-128
    p4 = float(low >> _U32) * 2.0**-160
    share = (((p4 + p3) + p2) + p1) + p0
    share_low = ((((p0 - share) + p1) + p2) + p3) + p4
    y, error = _exact_product(share, _HALF_PI)
    error += share * _HALF_PI_LOW + share_low * _HALF_PI
    total = y + error
    tail = (y - total) + error
    if x < 0.0:
        quadrant, sign = -quadrant, -sign
    return quadrant & 3, sign * total, sign * tail


@inlined_kernel
def _reduce(x):
    """Quadrant (0 to 3), angle within pi/4 of zero and its rounding error: x less quadrants of pi/2."""
    if not abs(x) < _LARGE:
        if x - x != 0.0:
            return np.int64(0), nan, nan
        return _reduce_large(x)
    n = (x * _TWO_OVER_PI + _ROUND) - _ROUND
    whole = x - n * _P1
    part = n * _P2
    rest = whole - part
    part = n * _P2_LOW - ((whole - rest) - part)
    y = rest - part
    if abs(y) < abs(x) * 2.0**-49:  # close to a multiple of pi/2
        whole = rest
        part = n * _P3
        rest = whole - part
        part = n * _P3_LOW - ((whole - rest) - part)
        y = rest - part
    return np.int64(n) & 3, y, (rest - y) - part


@inlined_kernel
def _sin_near_zero(x, tail):
    """Sine of x + tail within pi/4 of zero (fdlibm, k_sin.c)."""
    z = x * x
    w = z * z
    r = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
    r += z * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    v = z * x
    return x - ((z * (0.5 * tail - v * r) - tail) - v * -1.66666666666666324348e-01)


@inlined_kernel
def _cos_near_zero(x, tail):
    """Cosine of x + tail within pi/4 of zero (fdlibm, k_cos.c)."""
    z = x * x
    w = z * z
    r = z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05))
    r += (
        w
        * w
        * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))
    )
    half = 0.5 * z
    w = 1.0 - half
    return w + (((1.0 - w) - half) + (z * r - x * tail))


@kernel
def sincos(x):
    """Sine and cosine of an angle (rad)."""
    quadrant, y, tail = _reduce(x)
    s, c = _sin_near_zero(y, tail), _cos_near_zero(y, tail)
    if quadrant & 1:
        s, c = c, -s
    if quadrant & 2:
        s, c = -s, -c
    return s, c


@kernel
def sin(x):
    """Sine of an angle (rad)."""
    quadrant, y, tail = _reduce(x)
    value = _cos_near_zero(y, tail) if quadrant & 1 else _sin_near_zero(y, tail)
    return -value if quadrant & 2 else value


@kernel
def cos(x):
    """Cosine of an angle (rad)."""
    quadrant, y, tail = _reduce(x)
    value = _sin_near_zero(y, tail) if quadrant & 1 else _cos_near_zero(y, tail)
    return -value if (quadrant + 1) & 2 else value


@kernel
def tan(x):
    """Tangent of an angle (rad) (FreeBSD, k_tan.c)."""
    if x == 0.0:  # of either sign
        return x
    quadrant, x, tail = _reduce(x)
    sign, reciprocal = 1.0, quadrant & 1 == 1
    near = abs(x) < 0.6744
    if not near:
        if x < 0.0:
            sign, x, tail = -1.0, -x, -tail
        x, tail = (_QUARTER_PI - x) + (_QUARTER_PI_LOW - tail), 0.0
    z = x * x
    w = z * z
    odd = 5.88041240820264096874e-04 + w * (7.81794442939557092300e-05 + w * -1.85586374855275456654e-05)
    odd = 2.18694882948595424599e-02 + w * (3.59207910759131235356e-03 + w * odd)
    odd = 1.33333333333201242699e-01 + w * odd
    even = 2.46463134818469906812e-04 + w * (7.14072491382608190305e-05 + w * 2.59073051863633712884e-05)
    even = 8.86323982359930005737e-03 + w * (1.45620945432529025516e-03 + w * even)
    even = z * (5.39682539762260521377e-02 + w * even)
    s = z * x
    r = tail + z * (s * (odd + even) + tail)
    r += 3.33333333333334091986e-01 * s
    value = x + r
    if not near:
        v = -1.0 if reciprocal else 1.0
        return sign * (v - 2.0 * (x - (value * value / (value + v) - r)))
    if not reciprocal:
        return value
    head = _head(value)
    inverse = -1.0 / value
    short = _head(inverse)
    return short + inverse * ((1.0 + short * head) + short * (r - (head - x)))


@inlined_kernel
def _asin_ratio(z):
    """(asin(s) - s) / s at s**2 = z, for z up to 1/4."""
    p = -4.00555345006794114027e-02 + z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)
    p = 1.66666666666666657415e-01 + z * (
        -3.25565818622400915405e-01 + z * (2.01212532134862925881e-01 + z * p)
    )
    q = 2.02094576023350569471e00 + z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)
    return z * p / (1.0 + z * (-2.40339491173441421878e00 + z * q))


@kernel
def asin(x):
    """Angle (rad) within pi/2 of zero with this sine; NaN beyond -1 .. 1 (fdlibm, e_asin.c)."""
    size = abs(x)
    if size < 0.5:
        return x + x * _asin_ratio(x * x)
    z = 0.5 * (1.0 - size)
    if not z >= 0.0:
        return nan
    ratio, s = _asin_ratio(z), sqrt(z)
    if size >= 0.975:
        angle = _HALF_PI - (2.0 * (s + s * ratio) - _HALF_PI_LOW)
    else:
        head = _head(s)
        low = (z - head * head) / (s + head)
        small = 2.0 * s * ratio - (_HALF_PI_LOW - 2.0 * low)
        angle = _QUARTER_PI - (small - (_QUARTER_PI - 2.0 * head))
    return copysign(angle, x)


@kernel
def acos(x):
    """Angle (rad) from 0 to pi with this cosine; NaN beyond -1 .. 1 (fdlibm, e_acos.c)."""
    if abs(x) < 0.5:
        return _HALF_PI - (x - (_HALF_PI_LOW - x * _asin_ratio(x * x)))
    z = 0.5 * (1.0 - abs(x))
    if not z >= 0.0:
        return nan
    ratio, s = _asin_ratio(z), sqrt(z)
    if x < 0.0:
        return _PI - 2.0 * (s + (ratio * s - _HALF_PI_LOW))
    if z == 0.0:
        return 0.0
    head = _head(s)
    return 2.0 * (head + (ratio * s + (z - head * head) / (s + head)))


@inlined_kernel
def _atan_in_parts(size, tail):
    """Arc tangent of a number that is not negative, plus a small angle ``tail``, as a known angle and a small
    one to take from it (fdlibm, s_atan.c).
    """
    base, base_low = 0.0, 0.0
    if size < 0.4375:
        t = size
    elif size < 0.6875:
        t = (2.0 * size - 1.0) / (2.0 + size)
        base, base_low = 4.63647609000806093515e-01, 2.26987774529616870924e-17
    elif size < 1.1875:
        t = (size - 1.0) / (size + 1.0)
        base, base_low = _QUARTER_PI, _QUARTER_PI_LOW
    elif size < 2.4375:
        t = (size - 1.5) / (1.0 + 1.5 * size)
        base, base_low = 9.82793723247329054082e-01, 1.39033110312309984516e-17
    else:
        t = -1.0 / size
        base, base_low = _HALF_PI, _HALF_PI_LOW
    z = t * t
    w = z * z
    odd = 6.66107313738753120669e-02 + w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02)
    odd = 1.42857142725034663711e-01 + w * (9.09088713343650656196e-02 + w * odd)
    odd = z * (3.33333333333329318027e-01 + w * odd)
    even = -7.69187620504482999495e-02 + w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02)
    even = w * (-1.99999999998764832476e-01 + w * (-1.11111104054623557880e-01 + w * even))
    return base, (t * (odd + even) - (base_low + tail)) - t


@kernel
def atan(x):
    """Angle (rad) within pi/2 of zero with this tangent."""
    base, less = _atan_in_parts(abs(x), 0.0)
    return copysign(base - less, x)


@kernel
def atan2(y, x):
    """Angle (rad) from -pi to pi of the point (x, y) (cases: fdlibm, e_atan2.c)."""
    if x != x or y != y:
        return nan
    up, along = abs(y), abs(x)
    if up == 0.0:
        return copysign(0.0 if copysign(1.0, x) > 0.0 else _PI, y)
    if along == 0.0:
        return copysign(_HALF_PI, y)
    base, less = _QUARTER_PI, -_QUARTER_PI_LOW
    if up != along:  # which two infinities are not
        ratio, tail = up / along, 0.0
        if 1e-30 < ratio < 1e30:
            unit = 2.0**-600 if up > 2.0**400 else (2.0**600 if up < 2.0**-400 else 1.0)
            product, error = _exact_product(ratio, unit * along)
            tail = ((unit * up - product) - error) / (unit * along * (1.0 + ratio * ratio))
        base, less = _atan_in_parts(ratio, tail)
    if x > 0.0:
        return copysign(base - less, y)
    from_pi = _PI - base
    return copysign(from_pi + (less + (((_PI - from_pi) - base) + _PI_LOW)), y)


@kernel
def hypot(x, y):
    """Length of (x, y), without overflow in between (Borges 2019, corrected, without fma)."""
    if abs(x) == inf or abs(y) == inf:
        return inf
    a, b = max(abs(x), abs(y)), min(abs(x), abs(y))
    if x != x or y != y:
        return nan
    if b <= a * 2.0**-54:
        return a + b
    unit = 1.0
    if a > 2.0**511:
        unit, a, b = 2.0**600, a * 2.0**-600, b * 2.0**-600
    elif b < 2.0**-459:
        unit, a, b = 2.0**-600, a * 2.0**600, b * 2.0**600
    h = sqrt(a * a + b * b)
    if h <= 2.0 * b:
        d = h - b
        excess = a * (2.0 * d - a) + (d - 2.0 * (a - b)) * d
    else:
        d = h - a
        excess = 2.0 * d * (a - 2.0 * b) + ((4.0 * d - b) * b + d * d)
    return unit * (h - excess / (2.0 * h))


# ---------------------------------------------------------------- exponentials and logarithms

_LN2_HIGH, _LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_LOG2_E = 1.44269504088896338700e00


@inlined_kernel
def _exp_core(r):
    """r - r**2 P(r**2), of which exp follows within ln 2 / 2 of zero (fdlibm, e_exp.c)."""
    t = r * r
    p = 6.61375632143793436117e-05 + t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08)
    return r - t * (1.66666666666666019037e-01 + t * (-2.77777777770155933842e-03 + t * p))


def _powers_of_two(parts: int) -> np.ndarray:
    """2**(i / parts) for i below ``parts``, a power of two, and rounding errors: from integers."""
    bits = 120
    root = 2 << bits
    for _ in range(parts.bit_length() - 1):
        root = isqrt(root << bits)
    found, power = np.zeros((parts, 2)), 1 << bits
    for i in range(parts):
        found[i, 0] = power / (1 << bits)
        numerator, denominator = found[i, 0].as_integer_ratio()
        found[i, 1] = (power * denominator - (numerator << bits)) / (denominator << bits)
        power = power * root >> bits
    return found


_PARTS = 128
_POWERS = _powers_of_two(_PARTS)


@kernel
def exp(x):
    """e to the power of x: 2**(k / 128) from a table, times a short series."""
    if not abs(x) < 708.0:  # near the ends, beyond them, NaN
        if x != x:
            return nan
        if x > 709.782712893384:
            return inf
        if x < -745.1332191019412:
            return 0.0
    k = (x * (_PARTS * _LOG2_E) + _ROUND) - _ROUND
    r = (x - k * (_LN2_HIGH / _PARTS)) - k * (_LN2_LOW / _PARTS)
    more = r + r * r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0))))
    whole = np.int64(k)
    part = whole & (_PARTS - 1)
    power = _POWERS[part, 0]
    value = power + (_POWERS[part, 1] + power * more)
    if abs(x) < 708.0:
        return value * _number(((whole >> 7) + 1023) << 52)
    return _scaled(value, whole >> 7)


@inlined_kernel
def _parted(x):
    """Exponent k and mantissa m within a factor sqrt(2) of 1 of a positive finite number m * 2**k."""
    shift = 0
    if x < 2.2250738585072014e-308:
        x, shift = x * 2.0**54, 54
    moved = _bits(x) + (_ONE - _SQRT_HALF)  # so that the exponent steps at sqrt(1/2)
    return (moved >> 52) - 1023 - shift, _number((moved & _MANTISSA) + _SQRT_HALF)


@inlined_kernel
def _log1p_less_f(f):
    """log(1 + f) - f + f**2 / 2 within a factor sqrt(2) of 1 (FreeBSD, k_log.h)."""
    s = f / (2.0 + f)
    z = s * s
    w = z * z
    even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01))
    odd = 2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)
    odd = z * (6.666666666666735130e-01 + w * odd)
    return s * (0.5 * f * f + (odd + even))


def _logarithms(cells: int) -> np.ndarray:
    """For each of ``cells`` parts of sqrt(1/2) .. sqrt(2): a short inverse of its middle, and minus its
    logarithm as a number of 32 bits and the rest, from integers.
    """
    found, bits = np.zeros((cells, 3)), 120
    for i in range(cells):
        ends = np.array([(i << 52) // cells, ((i + 1) << 52) // cells]) + _SQRT_HALF
        middle = 0.5 * float(ends.view(np.float64).sum())
        n = 512 if abs(middle - 1.0) < 1.0 / 128.0 else round(512.0 / middle)  # exact near 1
        z = ((512 - n) << bits) // (512 + n)  # log(512 / n) = 2 artanh of it
        term, total, k = z, 0, 1
        while term:
            total += term // k
            term, k = (term * z >> bits) * z >> bits, k + 2
        short = round(2 * total / (1 << bits) * 2.0**32)
        found[i] = n / 512.0, short * 2.0**-32, (2 * total - (short << bits - 32)) / (1 << bits)
    return found


_CELLS = 128
_LOGARITHMS = _logarithms(_CELLS)


@kernel
def log(x):
    """Natural logarithm; -inf of zero, NaN below: from a table, and a short series in the remainder."""
    if not 0.0 < x < inf:
        return -inf if x == 0.0 else (x if x > 0.0 else nan)
    k, m = _parted(x)
    cell = ((_bits(m) - _SQRT_HALF) >> 45) & (_CELLS - 1)
    inverse = _LOGARITHMS[cell, 0]
    head = _head(m)
    r = (head * inverse - 1.0) + (m - head) * inverse
    z = r * r
    more = (
        z
        * r
        * (
            1.0 / 3.0
            - r * (1.0 / 4.0 - r * (1.0 / 5.0 - r * (1.0 / 6.0 - r * (1.0 / 7.0 - r * (1.0 / 8.0)))))
        )
    )
    whole = k * _LN2_HIGH + _LOGARITHMS[cell, 1]
    total = whole + r
    return total + (((whole - total) + r) + (k * _LN2_LOW + _LOGARITHMS[cell, 2]) - (0.5 * z - more))


@kernel
def log10(x):
    """Logarithm to base 10; -inf of zero, NaN below (FreeBSD, e_log10.c)."""
    if not 0.0 < x < inf:
        return -inf if x == 0.0 else (x if x > 0.0 else nan)
    k, m = _parted(x)
    f = m - 1.0
    half = 0.5 * f * f
    high = _head(f - half)
    low = ((f - high) - half) + _log1p_less_f(f)
    value = high * 4.34294481878168880939e-01
    value_low = k * 3.69423907715893078616e-13
    value_low += (low + high) * 2.50829467116452752298e-11 + low * 4.34294481878168880939e-01
    whole = k * 3.01029995663611771306e-01
    total = whole + value
    return (value_low + ((whole - total) + value)) + total


@kernel
def _log2_in_parts(x):
    """Logarithm to base 2 of a positive finite number as a head and a tail, to 2**-68 (fdlibm, e_pow.c)."""
    k, m = _parted(x)
    base, known, known_low = 1.0, 0.0, 0.0
    if m < 0.8660254037844386:  # closer to 3/4 than to 1
        k, m = k - 1, 2.0 * m
    if m > 1.224744871391589:
        base, known, known_low = 1.5, 5.84962487220764160156e-01, 1.35003920212974897128e-08
    u, v = m - base, 1.0 / (m + base)
    s = u * v
    s_head = _head(s)
    sum_head = _head(m + base)
    sum_tail = m - (sum_head - base)
    s_tail = v * ((u - s_head * sum_head) - s_head * sum_tail)
    z = s * s
    r = 2.72728123808534006489e-01 + z * (2.30660745775561754067e-01 + z * 2.06975017800338417784e-01)
    r = 3.33333329818377432918e-01 + z * r
    r = z * z * (5.99999999999994648725e-01 + z * (4.28571428578550184252e-01 + z * r))
    r += s_tail * (s_head + s)
    z = s_head * s_head
    t_head = _head(3.0 + z + r)
    t_tail = r - ((t_head - 3.0) - z)
    u, v = s_head * t_head, s_tail * t_head + t_tail * s
    p_head = _head(u + v)
    p_tail = v - (p_head - u)
    z_head = 9.61796700954437255859e-01 * p_head
    z_tail = -7.02846165095275826516e-09 * p_head + p_tail * 9.61796693925975554329e-01 + known_low
    head = _head(((z_head + z_tail) + known) + k)
    return head, z_tail - (((head - k) - known) - z_head)


@kernel
def _positive_power(x, y):
    """x**y of a positive finite x and a finite y (fdlibm, e_pow.c)."""
    head, tail = _log2_in_parts(x)
    y_head = _head(y)
    low = (y - y_head) * head + y * tail
    high = y_head * head
    if not abs(low + high) < 1080.0:
        return inf if low + high > 0.0 else 0.0
    k = ((low + high) + _ROUND) - _ROUND
    high -= k
    t = _head(low + high)
    u = t * 6.93147182464599609375e-01
    v = (low - (t - high)) * 6.93147180559945286227e-01 + t * -1.90465429995776804525e-09
    z = u + v
    w = v - (z - u)
    c = _exp_core(z)
    return _scaled(1.0 - (((z * c) / (c - 2.0) - (w + z * w)) - z), np.int64(k))


@kernel
def _is_whole(y):
    """Test whether a number is an integer."""
    return abs(y) >= 2.0**52 or (y + copysign(2.0**52, y)) - copysign(2.0**52, y) == y


@kernel
def pow(x, y):
    """x to the power of y, as C99 defines it for all pairs of numbers."""
    if y == 0.0 or x == 1.0:
        return 1.0
    if x != x or y != y:
        return nan
    size = abs(x)
    if abs(y) == inf:
        if size == 1.0:
            return 1.0
        return inf if (size > 1.0) == (y > 0.0) else 0.0
    whole = _is_whole(y)
    odd = whole and not _is_whole(0.5 * y)
    sign = -1.0 if odd and copysign(1.0, x) < 0.0 else 1.0
    if size == 0.0 or size == inf:
        return sign * (inf if (size == inf) == (y > 0.0) else 0.0)
    if x < 0.0 and not whole:
        return nan
    if abs(y) > 2.0**64:  # no number but 1 is as near to 1
        return 1.0 if size == 1.0 else (inf if (size > 1.0) == (y > 0.0) else 0.0)
    return sign * _positive_power(size, y)


# ---------------------------------------------------------------- probability


#: Centres of Taylor series for erfc from 1/4 to 2: place, erfc in two parts, and its slope downwards,
#: 2/sqrt(pi) exp(-place**2).  Worked out with 200 bits (mpmath).
_CENTRES = (
    (0.3125, 0.658531366498405, -5.264356566157743e-17, 1.0233954666001974),
    (0.4375, 0.536101864250067, 2.081342854423416e-17, 0.9318121761288343),
    (0.5625, 0.42632554338440803, 1.157866955362719e-17, 0.8223213592243077),
    (0.6875, 0.33091533711391874, -2.1626326156388987e-17, 0.7033687321576001),
    (0.8125, 0.25053597441363795, -1.9451069995767674e-17, 0.5831131597762814),
    (0.9375, 0.1848975989656002, -1.1420613234291201e-17, 0.46854458689539813),
    (1.0625, 0.13294173056504724, 5.439674182372549e-18, 0.36490289117800395),
    (1.1875, 0.0930782802183135, 5.226876374995801e-18, 0.2754431531414426),
    (1.3125, 0.06343142528861129, -9.628608459530773e-19, 0.20151851572462268),
    (1.4375, 0.042059393943539934, 2.129507326470638e-18, 0.14289802537593801),
    (1.5625, 0.02712538617906646, 1.7210788397116674e-18, 0.09821228080128248),
    (1.6875, 0.01701028339802197, -3.4990828260302035e-19, 0.06542348334839115),
    (1.8125, 0.010369374205224815, -1.7544564320848365e-19, 0.042240575617668474),
    (1.9375, 0.0061431936047868, -4.117233133400583e-19, 0.02643347677803051),
)


@kernel
def _erfc_by_series(x):
    """erfc from 1/4 to 2: the integral of exp(-t**2) from the nearest centre on, as a power series."""
    centre, value, value_low, slope = _CENTRES[min(int((x - 0.25) * 8.0), 13)]
    d = x - centre
    # coefficients of exp(-2 centre d - d**2): g[n+1] (n + 1) = -2 (centre g[n] + g[n-1])
    before, now, power, total = 0.0, 1.0, 1.0, 0.0
    for n in range(1, 15):
        before, now = now, -2.0 * (centre * now + before) / n
        power *= d
        total += now * power / (n + 1)
    return value + (value_low - slope * (d + d * total))


@kernel
def _erfc_correction(x):
    """log(x erfc(x) exp(x**2)) + 0.5625 from 2 to 28 (fdlibm, s_erf.c)."""
    z = 1.0 / (x * x)
    if x < 2.857142857142857:
        p = -8.12874355063065934246e01 + z * -9.81432934416914548592e00
        p = -1.62396669462573470355e02 + z * (-1.84605092906711035994e02 + z * p)
        p = -1.05586262253232909814e01 + z * (-6.23753324503260060396e01 + z * p)
        p = -9.86494403484714822705e-03 + z * (-6.93858572707181764372e-01 + z * p)
        q = 6.57024977031928170135e00 + z * -6.04244152148580987438e-02
        q = 4.29008140027567833386e02 + z * (1.08635005541779435134e02 + z * q)
        q = 4.34565877475229228821e02 + z * (6.45387271733267880336e02 + z * q)
        q = 1.96512716674392571292e01 + z * (1.37657754143519042600e02 + z * q)
    else:
        p = -1.02509513161107724954e03 + z * -4.83519191608651397019e02
        p = -1.60636384855821916062e02 + z * (-6.37566443368389627722e02 + z * p)
        p = -7.99283237680523006574e-01 + z * (-1.77579549177547519889e01 + z * p)
        p = -9.86494292470009928597e-03 + z * p
        q = 4.74528541206955367215e02 + z * -2.24409524465858183362e01
        q = 3.19985821950859553908e03 + z * (2.55305040643316442583e03 + z * q)
        q = 3.25792512996573918826e02 + z * (1.53672958608443695994e03 + z * q)
        q = 3.03380607434824582924e01 + z * q
    return p / (1.0 + z * q)


@kernel
def _erfc_far_out(x):
    """erfc from 2 to 28: exp(-x**2 - 0.5625 + correction) / x, rounding errors included."""
    head = _head(x)
    exponent, rest = -head * head - 0.5625, (head - x) * (head + x) + _erfc_correction(x)
    k = ((exponent + rest) * _LOG2_E + _ROUND) - _ROUND
    high, low = exponent - k * _LN2_HIGH, k * _LN2_LOW - rest
    r = high - low
    c = _exp_core(r)
    inner = low - (r * c) / (2.0 - c)
    less = inner - high
    lost = (inner - (less + high)) if abs(high) > abs(inner) else ((inner - less) - high)
    value = 1.0 - less
    value_low = ((1.0 - value) - less) - lost
    ratio = value / x
    product, error = _exact_product(ratio, x)
    return _scaled(ratio + (((value - product) - error) + value_low) / x, np.int64(k))


@kernel
def erfc(x):
    """Complementary error function, 1 - erf(x)."""
    size = abs(x)
    if -0.25 < x < 0.25:  # fdlibm, s_erf.c
        z = x * x
        p = -2.84817495755985104766e-02 + z * (-5.77027029648944159157e-03 + z * -2.37630166566501626084e-05)
        p = 1.28379167095512558561e-01 + z * (-3.25042107247001499370e-01 + z * p)
        q = 5.08130628187576562776e-03 + z * (1.32494738004321644526e-04 + z * -3.96022827877536812320e-06)
        q = 1.0 + z * (3.97917223959155352819e-01 + z * (6.50222499887672944485e-02 + z * q))
        return 1.0 - (x + x * (p / q))
    if x != x:
        return nan
    if size < 2.0:
        value = _erfc_by_series(size)
    else:
        value = _erfc_far_out(size) if size < 28.0 else 0.0
    return value if x > 0.0 else 2.0 - value
