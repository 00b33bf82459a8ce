"""Verifies: growth and decay of the pitch oscillation by the damping derivative.

gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source:
linearised pitch equation, the envelope grows with sigma = qbar A D^2 Cmq / (4 V Iyy) | tolerance 1e-3 of
sigma: curvature of the static moment within the swing of 0.05 deg leaks into the envelope.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.verify.case import History, Outcome, Result, fit, flown
from edl6dof.verify.cases.capsule_trim import TRIM_DEG, scene, stiffness

MACH = 15.0
ABOUT = {
    "verifies": "pitch damping",
    "source": "linearised pitch equation",
    "why": "curvature of the moment",
}


def run(planted: Sequence[str] = ()) -> Outcome:
    """Swing with Cmq = -1 and +1 and measure the growth of the envelope."""
    results = []
    for cmq in (-1.0, 1.0):
        table = (
            "vehicle.aero.capsule.damping_factor=1",
            "vehicle.aero.capsule.damping_mach=[6]",
            "vehicle.aero.capsule.damping_angle_deg=[0]",
            f"vehicle.aero.capsule.damping_table=[[{cmq}]]",
        )
        nominal, flight = flown(scene(MACH, 1e-3, table), planted)
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        frequency, unit = stiffness(nominal, MACH)
        sigma = 0.5 * unit * cmq
        found, _ = fit(t, alpha, complex(sigma, frequency))
        error = abs(found.real / sigma - 1.0)
        results.append(Result(f"growth rate, Cmq {cmq:+g}", error, 1e-3, **ABOUT))
    envelope, swing = abs(alpha[0] + TRIM_DEG) * np.exp(sigma * t), alpha + TRIM_DEG
    curves = History("Growth by Cmq = +1: envelope", "time (s)", "alpha from trim (deg)", t, swing, envelope)
    return Outcome(results, curves)
