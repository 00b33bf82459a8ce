"""Elementary functions against numpy's extended precision and mpmath: errors below 1 ulp, hard cases, the
special values of C99, annex F, and one hash that holds on every machine.
"""

import hashlib
import math

import mpmath
import numpy as np
import pytest

from edl6dof.kernels import kernel
from edl6dof.spatial import arrays, elementary
from edl6dof.spatial.elementary import (
    acos,
    asin,
    atan,
    atan2,
    cos,
    erfc,
    exp,
    hypot,
    log,
    log10,
    pow,
    sin,
    sincos,
    tan,
)

LONG = np.longdouble
#: Extended precision has 64 bits on x86-64 and 113 on other Linux machines; macOS and Windows have none.
HAS_LONG = np.finfo(LONG).nmant >= 63
COUNT = 1_000_000
inf, nan = math.inf, math.nan


def loop(function, numbers):
    """A compiled loop over one or two columns of arguments."""
    if numbers == 1:

        @kernel
        def run(x, found):
            for k in range(x.size):
                found[k] = function(x[k])

    else:

        @kernel
        def run(x, y, found):
            for k in range(x.size):
                found[k] = function(x[k], y[k])

    return run


def over(function, *given):
    found = np.empty(given[0].size)
    loop(function, len(given))(*given, found)
    return found


def ulps(found, exact):
    """Largest error in units of the last place of the exact value, and where."""
    size = np.abs(exact.astype(float))
    error = np.abs(found.astype(LONG) - exact) / np.spacing(np.maximum(size, 5e-324)).astype(LONG)
    error[found == exact.astype(float)] = 0.0
    return float(np.max(error))


def spread(rng, low, high, count=COUNT):
    """Numbers of both signs, evenly in the logarithm."""
    return rng.choice([-1.0, 1.0], count) * np.exp(rng.uniform(np.log(low), np.log(high), count))


ONE = {
    "sin": (sin, np.sin, [(-7.0, 7.0), (-1.6e6, 1.6e6), "1e-20 1e6", "1e6 1e300"]),
    "cos": (cos, np.cos, [(-7.0, 7.0), (-1.6e6, 1.6e6), "1e-20 1e6", "1e6 1e300"]),
    "tan": (tan, np.tan, [(-7.0, 7.0), "1e-20 1e6", "1e6 1e300"]),
    "asin": (asin, np.arcsin, [(-1.0, 1.0), "1e-20 1"]),
    "acos": (acos, np.arccos, [(-1.0, 1.0), (0.99, 1.0)]),
    "atan": (atan, np.arctan, [(-3.0, 3.0), "1e-20 1e20"]),
    "exp": (exp, np.exp, [(-1.0, 1.0), (-745.0, 709.7), "1e-20 1"]),
    "log": (log, np.log, [(0.5, 2.0), (0.999, 1.001), (1e-310, 1e-307), (1e-3, 1e300)]),
    "log10": (log10, np.log10, [(0.5, 2.0), (0.999, 1.001), (1e-310, 1e-307), (1e-3, 1e300)]),
}
TWO = {
    "atan2": (atan2, np.arctan2, ["1e-5 1e5", "1e-5 1e5"]),
    "atan2 far apart": (atan2, np.arctan2, ["1e-300 1e300", "1e-300 1e300"]),
    "hypot": (hypot, np.hypot, ["1e-5 1e5", "1e-5 1e5"]),
    "hypot of small": (hypot, np.hypot, ["1e-308 1e-300", "1e-310 1e-300"]),
    "hypot of large": (hypot, np.hypot, ["1e300 1e307", "1e300 1e307"]),
    "pow": (pow, np.power, [(1e-3, 1e3), (-10.0, 10.0)]),
    "pow near one": (pow, np.power, [(0.999, 1.001), (-6e5, 6e5)]),
    "pow of any size": (pow, np.power, [(0.05, 20.0), (-230.0, 230.0)]),
}


def drawn(rng, domain):
    if isinstance(domain, str):
        return spread(rng, *map(float, domain.split()))
    return rng.uniform(*domain, COUNT)


@pytest.mark.skipif(not HAS_LONG, reason="needs a long double of 64 bits")
@pytest.mark.parametrize("name", ONE)
def test_below_one_ulp(name):
    function, exact, domains = ONE[name]
    rng = np.random.default_rng(1)
    for domain in domains:
        x = drawn(rng, domain)
        assert ulps(over(function, x), exact(x.astype(LONG))) < 1.0, domain


@pytest.mark.skipif(not HAS_LONG, reason="needs a long double of 64 bits")
@pytest.mark.parametrize("name", TWO)
def test_below_one_ulp_of_two_arguments(name):
    function, exact, domains = TWO[name]
    rng = np.random.default_rng(2)
    x, y = (drawn(rng, domain) for domain in domains)
    with np.errstate(under="ignore"):
        assert ulps(over(function, x, y), exact(x.astype(LONG), y.astype(LONG))) < 1.0


@pytest.mark.parametrize("low", [-6.0, -0.5, 0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 6.0, 20.0])
def test_erfc_below_one_ulp(low):
    x = np.random.default_rng(3).uniform(low, low + 0.5, 4000)
    with mpmath.workprec(100):
        exact = np.array([LONG(mpmath.nstr(mpmath.erfc(float(value)), 25)) for value in x])
    assert ulps(over(erfc, x), exact) < 1.0 if HAS_LONG else np.allclose(over(erfc, x), exact, rtol=2.3e-16)


#: Arguments that come nearest to a multiple of pi/2 (Muller, Elementary Functions, 3rd ed., table 11.1; Ng,
#: ARGUMENT REDUCTION FOR HUGE ARGUMENTS, 1992), ends of the ranges of the reductions, and arguments whose
#: results lie nearest to a midpoint of two numbers (Lefevre and Muller, 2001, tables 4 to 9).
HARD = {
    sin: [
        6381956970095103.0 * 2.0**797,
        1e22,
        710.0,
        355.0,
        0.5 * math.pi,
        math.pi,
        2.0**20 * math.pi / 2,
        1.7e308,
    ],
    cos: [
        6381956970095103.0 * 2.0**797,
        1e22,
        710.0,
        355.0,
        0.5 * math.pi,
        math.pi,
        2.0**20 * math.pi / 2,
        1.7e308,
    ],
    tan: [6381956970095103.0 * 2.0**797, 1e22, 355.0, 0.25 * math.pi, 0.5 * math.pi, 0.6744, 11.0],
    exp: [
        float.fromhex("0x1.d2f1f1fe7f4a9p-2"),
        -745.13,
        -708.5,
        709.78,
        7.541e-15,
        float.fromhex("-0x1.2d2e4e2ab5d0bp-6"),
    ],
    log: [
        float.fromhex("0x1.ac50b409c8aeep+830"),
        1.0 + 2.0**-52,
        1.0 - 2.0**-53,
        5e-324,
        1.7976931348623157e308,
    ],
    log10: [1000.0, 1e22, 5e-324, 1.0 + 2.0**-52, 1.0 - 2.0**-53],
    asin: [0.5, 0.975, 1.0, 1.0 - 2.0**-53, 5e-324, 2.0**-27],
    acos: [0.5, -0.5, 1.0 - 2.0**-53, -1.0 + 2.0**-53, 2.0**-60],
    atan: [0.4375, 0.6875, 1.1875, 2.4375, 1e300, 5e-324],
}


@pytest.mark.parametrize("function", HARD, ids=lambda function: function.__name__)
def test_hard_arguments(function):
    with mpmath.workprec(1500):
        for x in HARD[function]:
            exact = getattr(mpmath, function.__name__)(mpmath.mpf(x))
            error = abs(mpmath.mpf(float(function(x))) - exact) / mpmath.mpf(
                float(np.spacing(abs(float(exact))))
            )
            assert error < 1.0, (x, float(error))


def test_multiples_of_half_a_turn_below_the_limit_of_the_short_reduction():
    """The nearest double to each of many multiples of pi/2: nearly everything cancels."""
    with mpmath.workprec(300):
        for n in [*range(1, 200), *range(2**20 - 100, 2**20 + 100)]:
            x = float(n * mpmath.pi / 2)
            for found, exact in zip(sincos(x), (mpmath.sin(x), mpmath.cos(x)), strict=True):
                assert abs(mpmath.mpf(float(found)) - exact) < mpmath.mpf(
                    float(np.spacing(abs(float(exact))))
                )


SPECIAL = [
    *(
        (sin, (-0.0,), -0.0),
        (sin, (inf,), nan),
        (cos, (0.0,), 1.0),
        (cos, (-inf,), nan),
        (tan, (-0.0,), -0.0),
    ),
    *((tan, (inf,), nan), (asin, (-0.0,), -0.0), (asin, (1.0,), math.pi / 2), (asin, (1.1,), nan)),
    *((acos, (1.0,), 0.0), (acos, (-1.0,), math.pi), (acos, (-1.1,), nan), (acos, (nan,), nan)),
    *((atan, (-0.0,), -0.0), (atan, (inf,), math.pi / 2), (atan, (-inf,), -math.pi / 2), (atan, (nan,), nan)),
    *((exp, (0.0,), 1.0), (exp, (inf,), inf), (exp, (-inf,), 0.0), (exp, (710.0,), inf), (exp, (nan,), nan)),
    *((exp, (-746.0,), 0.0), (exp, (-745.13,), 5e-324), (log, (1.0,), 0.0), (log, (0.0,), -inf)),
    *((log, (-1.0,), nan), (log, (inf,), inf), (log, (nan,), nan), (log, (-0.0,), -inf)),
    *((log10, (1.0,), 0.0), (log10, (0.0,), -inf), (log10, (-1.0,), nan), (log10, (inf,), inf)),
    *((erfc, (0.0,), 1.0), (erfc, (inf,), 0.0), (erfc, (-inf,), 2.0), (erfc, (nan,), nan)),
    *(
        (hypot, (inf, nan), inf),
        (hypot, (nan, -inf), inf),
        (hypot, (nan, 1.0), nan),
        (hypot, (0.0, -0.0), 0.0),
    ),
    *((hypot, (3.0, -4.0), 5.0), (hypot, (1.7e308, 1.7e308), inf), (hypot, (-3.0, 0.0), 3.0)),
    *((hypot, (5e-324, 5e-324), 5e-324), (hypot, (3e-320, 4e-320), 5e-320)),
    *(
        (atan2, (y, x), math.atan2(y, x))
        for y in (0.0, -0.0, 1.0, -1.0, inf, -inf)
        for x in (0.0, -0.0, 2.0, -2.0, inf, -inf)
    ),
    *((atan2, (nan, 1.0), nan), (atan2, (1.0, nan), nan), (atan2, (5e-324, 5e-324), math.pi / 4)),
    *(
        (atan2, (1e308, 1e308), math.pi / 4),
        (atan2, (5e-324, 1.0), 5e-324),
        (atan2, (1e308, -1e-308), math.pi / 2),
    ),
    *((pow, (x, 0.0), 1.0) for x in (0.0, 2.0, inf, nan)),
    *((pow, (1.0, y), 1.0) for y in (inf, nan, -3.0)),
    *((pow, (-1.0, inf), 1.0), (pow, (-1.0, -inf), 1.0), (pow, (nan, 1.0), nan), (pow, (2.0, nan), nan)),
    *((pow, (-0.0, -3.0), -inf), (pow, (-0.0, -2.0), inf), (pow, (0.0, -0.5), inf), (pow, (-0.0, 3.0), -0.0)),
    *((pow, (-0.0, 2.0), 0.0), (pow, (-2.0, 0.5), nan), (pow, (-2.0, 3.0), -8.0), (pow, (-2.0, 2.0), 4.0)),
    *((pow, (0.5, inf), 0.0), (pow, (2.0, inf), inf), (pow, (0.5, -inf), inf), (pow, (2.0, -inf), 0.0)),
    *((pow, (inf, 2.0), inf), (pow, (inf, -2.0), 0.0), (pow, (-inf, 3.0), -inf), (pow, (-inf, -3.0), -0.0)),
    *(
        (pow, (2.0, 1024.0), inf),
        (pow, (2.0, -1074.0), 5e-324),
        (pow, (2.0, -1080.0), 0.0),
        (pow, (10.0, 22.0), 1e22),
    ),
    *((pow, (1.0 - 2.0**-53, 1e300), 0.0), (pow, (-3.0, 2.0**53 + 2.0), inf), (pow, (4.0, 0.5), 2.0)),
]


@pytest.mark.parametrize(
    "function, given, expected", SPECIAL, ids=lambda value: getattr(value, "__name__", str(value))
)
def test_special_values(function, given, expected):
    found = float(function(*given))
    assert found == expected or math.isnan(expected) and math.isnan(found)
    if not math.isnan(expected):
        assert math.copysign(1.0, found) == math.copysign(1.0, expected)


def test_sine_and_cosine_together_are_those_alone():
    x = np.concatenate([np.linspace(-10.0, 10.0, 5001), spread(np.random.default_rng(4), 1e-3, 1e12, 5000)])
    together = np.array([sincos(value) for value in x])
    assert np.array_equal(together, np.column_stack([over(sin, x), over(cos, x)]))


#: Of a thousand results of each function.  It holds on every processor and operating system.
HASH = "f7a2fb82c216cbea"


def test_one_hash_on_every_machine():
    bits = (np.arange(1000, dtype=np.uint64) + np.uint64(1)) * np.uint64(0x9E37_79B9_7F4A_7C15)
    unit = (bits >> np.uint64(11)).astype(float) * 2.0**-53
    x, positive = 40.0 * unit - 20.0, 1e3 * unit + 1e-9
    found = [over(function, x) for function in (sin, cos, tan, atan, exp, erfc)]
    found += [over(function, 2.0 * unit - 1.0) for function in (asin, acos)]
    found += [over(function, positive) for function in (log, log10)]
    found += [over(function, x, x[::-1].copy()) for function in (atan2, hypot)]
    found += [over(pow, positive, x), over(sin, 1e200 * x), arrays.normal_quantile(unit)]
    assert hashlib.sha256(np.array(found).tobytes()).hexdigest()[:16] == HASH


def test_constants_are_those_of_pi_and_ln2():
    e = elementary
    with mpmath.workprec(300):
        assert abs(mpmath.mpf(e._PI) + mpmath.mpf(e._PI_LOW) - mpmath.pi) < 2.0**-104
        assert (
            abs(
                mpmath.mpf(e._P1)
                + mpmath.mpf(e._P2)
                + mpmath.mpf(e._P3)
                + mpmath.mpf(e._P3_LOW)
                - mpmath.pi / 2
            )
            < 2.0**-150
        )
        assert abs(mpmath.mpf(e._LN2_HIGH) + mpmath.mpf(e._LN2_LOW) - mpmath.log(2)) < 2.0**-86
    with mpmath.workprec(1500):
        words = sum(int(word) << 64 * (20 - k) for k, word in enumerate(e._WORDS_OF_TWO_OVER_PI))
        assert words == int(mpmath.floor(2 / mpmath.pi * mpmath.mpf(2) ** (64 * 20)))
