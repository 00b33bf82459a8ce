"""Parity-space test of redundant instruments: detects that one has failed, and isolates it.

Two tests run in every cycle. The fast test compares p'p / sigma^2, with the parity vector p of the cycle, to
the chi-square limit. The slow test uses low-passed p over the cycle time, in which noise is reduced and a
small bias or drift is not. Sigma is the expected error of one instrument: noise, and errors that are constant
from cycle to cycle (bias; scale factor and misalignment, proportional to the motion, so that a fast turn
causes no alarm). Vibration of the whole unit is measured by all axes, and does not contribute to p. The
suspect is the instrument with the largest (p.v)^2 / |v|^2, v its column of V. It is left out of the cycle at
once, and excluded for good when it has been the suspect for several cycles in a row. With four instruments a
fault is detected but not isolated: isolation needs five.

Sources: Potter and Deckert 1973 (see :mod:`.redundancy`); isolation as Daly, Gai and Harrison, Generalized
likelihood test for FDI in redundant sensor configurations, J. Guidance and Control 2(1), 1979; chi-square:
Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 26.4.4 and 26.4.5.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.redundancy import MAX_AXES, MAX_PARITY
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record, whole
from edl6dof.spatial.elementary import erfc, exp

#: No instrument.
NONE = -1


class ParityParams(Params):
    """Fault detection of redundant gyros and accelerometers."""

    enabled: bool = param(True, "whether instruments are tested and excluded")
    false_alarm: float = param(
        1e-10, "probability that one test of healthy instruments exceeds its limit", gt=1e-100, lt=0.5
    )
    persistence_cycles: int = param(
        5, "consecutive fast tests with the same suspect that exclude it", ge=1, le=1000
    )
    window_s: float = param(10.0, "time constant of the low-passed parity vector", gt=0.0, le=1000.0)
    slow_persistence_cycles: int = param(
        25, "consecutive slow tests with the same suspect that exclude it", ge=1, le=10000
    )
    flag_patience_s: float = param(
        2.0, "time for which a saturation flag may contradict the motion", ge=0.0, le=1000.0
    )


#: State of the fast or slow test.
PARITY_STATE = record(
    ("statistic", "f8"),  # p'p / sigma^2
    ("suspect", whole(NONE, MAX_AXES - 1)),  # index of the instrument
    ("seen", COUNT),  # cycles in a row with this suspect
)
PARITY = record(
    ("limit", "f8"),  # chi-square limit of both statistics
    ("vector", "f8", (MAX_PARITY,)),  # p of this cycle, in the unit of a count
    ("mean", "f8", (MAX_PARITY,)),  # p over the cycle time, low-passed, 1/s
    ("mean_variance", "f8"),  # variance of the mean by the noise of one instrument
    ("mean_lasting", "f8"),  # standard deviation of the mean by constant errors
    ("fast", PARITY_STATE),
    ("slow", PARITY_STATE),
)


@kernel
def restart_parity_test(params, n_parity, memory):
    """Restart both tests, for another set of instruments."""
    memory.limit = chi_square_limit(max(n_parity, 1), params.false_alarm)
    memory.mean_variance = memory.mean_lasting = 0.0
    for k in range(MAX_PARITY):
        memory.vector[k] = memory.mean[k] = 0.0
    for test in (memory.fast, memory.slow):
        test.statistic, test.suspect, test.seen = 0.0, NONE, 0


@kernel
def parity_test(params, new, lasting, dt, redundant, number, memory):
    """Test the increments of a cycle of ``dt`` seconds for a sudden error (the parity vector of the cycle)
    and for a slow one (its mean over ``window``); ``new`` and ``lasting``: variances of an increment by
    noise, and by constant errors. Returns the instrument to leave out of the cycle and the one
    to exclude for good (``NONE``: none).
    """
    if redundant.n_parity == 0:
        return NONE, NONE
    share = min(dt / params.window, 1.0)
    square = mean_square = 0.0
    for k in range(redundant.n_parity):
        p = 0.0
        for i in range(number):
            p += redundant.parity[k, i] * redundant.increment[i]
        memory.vector[k] = p
        memory.mean[k] += share * (p / dt - memory.mean[k])
        square += p * p
        mean_square += memory.mean[k] * memory.mean[k]
    memory.mean_variance = (1.0 - share) ** 2 * memory.mean_variance + (share / dt) ** 2 * new
    memory.mean_lasting += share * (sqrt(lasting) / dt - memory.mean_lasting)
    memory.fast.statistic = square / (new + lasting)
    memory.slow.statistic = mean_square / (memory.mean_variance + memory.mean_lasting**2)
    _point_at(memory.limit, memory.vector, redundant, number, memory.fast)
    _point_at(memory.limit, memory.mean, redundant, number, memory.slow)
    failed = NONE
    if memory.slow.seen >= params.slow_persistence_cycles:
        failed = memory.slow.suspect
    if memory.fast.seen >= params.persistence_cycles:
        failed = memory.fast.suspect
    return memory.fast.suspect, failed


@kernel
def _point_at(limit, vector, redundant, number, test):
    """Update the suspect of the fast or slow test from its ``vector``."""
    before = test.suspect
    test.suspect = NONE
    if test.statistic > limit and redundant.n_parity > 1:
        test.suspect = isolate(vector, redundant, number)
    test.seen = 0 if test.suspect == NONE else (test.seen + 1 if test.suspect == before else 1)


@kernel
def isolate(vector, redundant, number):
    """Return the instrument whose failure alone explains most of a parity vector."""
    found, most = NONE, 0.0
    for i in range(number):
        along = square = 0.0
        for k in range(redundant.n_parity):
            v = redundant.parity[k, i]
            along += vector[k] * v
            square += v * v
        if square > 1e-6 and along * along > most * square:
            found, most = i, along * along / square
    return found


_BISECTIONS = 60
_LARGEST = 700.0


@kernel
def chi_square_tail(degrees, value):
    """Probability that chi-square of ``degrees`` degrees of freedom (1 or more) exceeds ``value``."""
    half = 0.5 * value
    if degrees % 2 == 1:
        tail, term, first = erfc(sqrt(half)), 2.0 * sqrt(half / pi) * exp(-half), 1
    else:
        tail, term, first = exp(-half), half * exp(-half), 2
    for k in range(first, degrees, 2):
        tail += term
        term *= value / (k + 2)
    return tail


@kernel
def chi_square_limit(degrees, tail):
    """Value that chi-square of ``degrees`` degrees of freedom exceeds with probability ``tail``."""
    low, high = 0.0, _LARGEST
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if chi_square_tail(degrees, middle) > tail:
            low = middle
        else:
            high = middle
    return high
