"""The error dynamics of eq. 21 alone: what both laws do to the drag error while lift suffices.

x_1' = x_2, x_2' = -k_1 |x_1|^alpha_1 sign(x_1) - k_2 |x_2|^alpha_2 sign(x_2), alpha_2 = 2 alpha_1/(1 +
alpha_1), is zero after a finite time (lemma 2 and theorem 2); with both powers one it is the
proportional-derivative law, which only decays.
"""

from __future__ import annotations

from functools import lru_cache
from math import copysign

import numpy as np

from edl6dof.studies.yan2016.flights import last_outside

#: Step and length of the integration, s.
STEP_S, LENGTH_S = 1e-3, 120.0


def settled_s(start: float, gains: tuple[float, float], exponent: float, share: float) -> float:
    """When the error (m/s2), from ``start`` at rest, stays below ``share`` of it; ``exponent`` is alpha_1, 1
    for the proportional-derivative law.
    """
    t = np.arange(0.0, LENGTH_S, STEP_S)
    return last_outside(t, _errors(start, gains, exponent, len(t)), share * start)


@lru_cache(maxsize=4)  # asked for several shares in turn
def _errors(start: float, gains: tuple[float, float], exponent: float, steps: int) -> np.ndarray:
    """Errors at all steps, by the midpoint rule."""
    powers = exponent, 2.0 * exponent / (1.0 + exponent)
    errors, x, rate = np.empty(steps), start, 0.0
    for k in range(steps):
        errors[k] = x
        x_half = x + 0.5 * STEP_S * rate
        rate_half = rate + 0.5 * STEP_S * _acceleration(x, rate, gains, powers)
        x, rate = x + STEP_S * rate_half, rate + STEP_S * _acceleration(x_half, rate_half, gains, powers)
    return errors


def _acceleration(x: float, rate: float, gains: tuple[float, float], powers: tuple[float, float]) -> float:
    """x_2' of eq. 21."""
    return -gains[0] * copysign(abs(x) ** powers[0], x) - gains[1] * copysign(abs(rate) ** powers[1], rate)
