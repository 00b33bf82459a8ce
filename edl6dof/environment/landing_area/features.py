"""Craters and rocks: their forms, and how they join the ground that is there already.

A fresh crater is a bowl with a raised rim, a worn one a smooth hollow without rim; any mixture of the two is
as likely as any other [E].  Rocks are half-ellipsoids in the numbers of Golombek's law: those of diameter D
and more cover the share F(D) = k exp(-q D) of the ground, q = 1.79 + 0.152 / k per m; so 4 q k exp(-q D) /
(pi D^2) of them lie on a square metre per metre of diameter.
Source: fresh craters, depth 0.2 and rim 0.04 of the diameter: Pike, in Impact and Explosion Cratering (1977);
ejecta thin with the cube of the distance: McGetchin et al., Earth Planet. Sci. Lett. 20, 226 (1973); worn
ones, a twentieth of the diameter deep: [E].  Rocks: Golombek and Rapp, J. Geophys. Res. 102(E2), 4117 (1997);
height half the diameter: Golombek et al., J. Geophys. Res. 108(E12), 8086 (2003).
"""

from __future__ import annotations

from math import pi, sqrt

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


#: Height of a rock over its diameter.
HEIGHT = 0.5


def rock_law(abundance: float) -> tuple[float, float]:
    """Amount and decay (per m) of the number amount * exp(-decay D) / D^2 per m2 and m of diameter, where
    rocks cover this share of the ground.
    """
    if abundance == 0.0:
        return 0.0, 0.0
    decay = 1.79 + 0.152 / abundance
    return 4.0 * decay * abundance / pi, decay


@kernel
def rock_height(diameter, square):
    """Height (m) of a rock above the ground at the ``square`` (m2) of the distance from its middle."""
    s = 4.0 * square / (diameter * diameter)
    return HEIGHT * diameter * sqrt(1.0 - s) if s < 1.0 else 0.0


@kernel
def with_member(population, height, diameter, character, square):
    """Height (m) at the ``square`` (m2) of the distance from a member's middle, where what came before gives
    ``height``: a crater adds to it, of rocks the highest stands.
    """
    if population.stands:
        return max(height, rock_height(diameter, square))
    return height + crater_height(diameter, character, square)
