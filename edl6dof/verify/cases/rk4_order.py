"""Verifies: the integrator is of fourth order, in position, velocity, attitude and rate.

gravity harmonics of degree 4 | atmosphere exponential | winds none | vehicle spinning, constant drag and rate
damping: smooth forces | source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, section
II.4: halving the step divides the error by 16 | tolerance 0.3: the next term of the error is a step longer,
and the smallest difference stands 100 above rounding.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.verify.case import BARE, Outcome, Result, flown

_SCENE = (
    *BARE,
    "flight_software.rates.base_hz=5",
    "atmosphere.model=exponential",
    "vehicle.aero.model=constant",
    (
        "vehicle.aero.constant={drag_coefficient: 1.5, pitch_damping: -0.5, reference_area_m2: 9, chord_m: "
        "3.4, moment_reference_x_m: -1.2}"
    ),
    "initial.altitude_m=45000",
    "initial.rate_deg_s=[5, 20, 3]",
    "simulation.time_limit_s=20",
)
PARTS = {"position": slice(0, 3), "velocity": slice(3, 6), "attitude": slice(6, 10), "rate": slice(10, 13)}


def end_state(step: float, planted: Sequence[str] = ()) -> np.ndarray:
    """State after 20 s in steps of ``step`` s."""
    return flown([*_SCENE, f"simulation.step_s={step}"], planted)[1].plant["y"][0, :13].copy()


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fly with three steps and compare the differences."""
    coarse, middle, fine = (end_state(step, planted) for step in (0.1, 0.05, 0.025))
    about = {"verifies": "Runge-Kutta step", "source": "step halving", "why": "next term of the error"}
    results = []
    for name, part in PARTS.items():
        sizes = (np.linalg.norm(a[part] - b[part]) for a, b in ((coarse, middle), (middle, fine)))
        order = float(np.log2(np.divide(*sizes)))
        results.append(Result(f"order, {name}", abs(order - 4.0), 0.3, **about))
    return Outcome(results)
