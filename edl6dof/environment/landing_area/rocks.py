"""Rocks: half-ellipsoids on the ground, in the numbers of Golombek's law.

Rocks of diameter D and more cover the share F(D) = k exp(-q D) of the ground, q = 1.79 + 0.152 / k per m; so
4 q k exp(-q D) / (pi D^2) of them lie on a square metre per metre of diameter.
Source: Golombek and Rapp, J. Geophys. Res. 102(E2), 4117 (1997); height half the diameter: Golombek et al.,
J. Geophys. Res. 108(E12), 8086 (2003).
"""

from __future__ import annotations

from math import pi, sqrt

from edl6dof.kernels import kernel

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
