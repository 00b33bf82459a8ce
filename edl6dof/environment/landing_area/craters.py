"""Craters: bowls with a raised rim, from fresh to worn.

Source: fresh: depth 0.2 and rim 0.04 of the diameter: Pike, in Impact and Explosion Cratering (1977); ejecta
thin with the cube of the distance: McGetchin et al., Earth Planet. Sci. Lett. 20, 226 (1973).  Worn: a
smooth hollow without a rim, a twentieth of the diameter deep [E].  Between the two, any mixture is as likely
as any other [E].
"""

from __future__ import annotations

from math import sqrt

from edl6dof.kernels import kernel

DEPTH, RIM = 0.2, 0.04
WORN_DEPTH = 0.05
#: Where a crater ends, in its radii.
EDGE = 2.0


@kernel
def crater_height(diameter, freshness, square):
    """Height (m) that a crater adds at the ``square`` (m2) of the distance from its middle; ``freshness`` 0
    .. 1.
    """
    s = 4.0 * square / (diameter * diameter)  # of the distance in radii
    if s >= EDGE * EDGE:
        return 0.0
    worn = 1.0 - s / (EDGE * EDGE)
    if s < 1.0:
        fresh = RIM - DEPTH * (1.0 - s)
    else:
        last = 1.0 / (EDGE * EDGE * EDGE)
        fresh = RIM * (1.0 / (s * sqrt(s)) - last) / (1.0 - last)
    return diameter * (freshness * fresh - (1.0 - freshness) * WORN_DEPTH * worn * worn)
