"""The chi-square distribution: how probable a larger value is, and the value that is exceeded so rarely.

Source: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 26.4.4 and 26.4.5.
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import erfc, exp

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
