"""Drag dynamics in drag, drag rate and speed alone, with what these cannot tell as five parameters.

D'' + g0(D, D', V) + g1(D, D', V, u) theta = w + g2(D, V) u with u = (L/D) cos(bank) and theta = (C, C', 1 -
(R/r) cos^2(gamma), 1 - cos(gamma), sin^2(gamma)), C = (dC_D/dt)/C_D, R a reference radius with g = mu/R^2.
Derived here from D = k rho V^2 C_D and eqs. 2-4; checked in the tests against finite differences of
integrated entries.
Source: Lu & Bayard, sections 2.1 and 2.3, eqs. 8-13.

Differences from the print: g = mu/R^2 where section 2.3 has mu/R; 2 D/V where eq. 10 has 2 V'/V; R/r where
eqs. 9 and 13 have r/R; w is D delta' + (D^2/V) ((V^2 - 4 g H)/(V^2 + 2 g H)) delta, where the print leaves
out the V^2.
"""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def uncertain_drag(drag, rate, speed, gravity, radius, scale_height):
    """(g0, g1 without u for the five parameters, g2); the fourth of g1 is ``g2 u`` and is returned as zero.

    ``gravity`` and ``radius`` are those of the reference sphere.
    """
    potential = gravity * scale_height / (speed * speed)
    k = 1.0 + 2.0 * potential
    path = drag * drag / speed * (1.0 - 4.0 * potential) / k
    climb = drag / scale_height * k
    centrifugal = speed * speed / radius
    free = (
        -rate * rate / drag
        + 2.0 * drag * rate / speed
        + 2.0 * drag * drag * drag / (speed * speed)
        + climb * (centrifugal - gravity)
        + path * (rate / drag + 2.0 * drag / speed)
    )
    unknown = (-path, -drag, -climb * centrifugal, 0.0, 4.0 * gravity * gravity * drag / (speed * speed))
    return free, unknown, -climb * drag
