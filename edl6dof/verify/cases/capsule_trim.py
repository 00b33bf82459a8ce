"""Verifies: trim angle and pitch frequency of the capsule with an offset centre of mass, at Mach 2 and Mach
15.

gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source: moment
balance and slope of the published coefficients (Phoenix, AIAA 2008-7219) read and interpolated by scipy's
PCHIP, linearised pitch equation | tolerance: 1e-3 deg of trim (a swing of 0.05 deg shifts its middle by its
square) and 1e-3 of the frequency (the slope of the moment changes by that within the swing).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from edl6dof.verify.capsule import TRIM_DEG, scene, stiffness
from edl6dof.verify.case import History, Outcome, Result, fit, flown

RESULT = partial(Result, source="published table by PCHIP, linearised")


def run(planted: Sequence[str] = ()) -> Outcome:
    """Swing 0.05 deg about trim and measure the middle and the frequency."""
    results = []
    for mach, density in ((2.0, 1e-2), (15.0, 1e-3)):
        nominal, flight = flown(scene(mach, density), planted)
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        expected, _ = stiffness(nominal, mach)
        found, middle = fit(t, alpha, complex(0.0, expected))
        trim, off = abs(middle + TRIM_DEG), abs(found.imag / expected - 1.0)
        about = {"verifies": "static moment, CG offset", "why": "square of the swing"}
        results.append(RESULT(f"trim angle, Mach {mach:g}", trim, 1e-3, "deg", **about))
        about = {"verifies": "static stability", "why": "slope changes within the swing"}
        results.append(RESULT(f"pitch frequency, Mach {mach:g}", off, 1e-3, **about))
    curve = -TRIM_DEG + (alpha[0] + TRIM_DEG) * np.cos(expected * t)
    return Outcome(results, History("Pitch at Mach 15", "time (s)", "alpha (deg)", t, alpha, curve))
