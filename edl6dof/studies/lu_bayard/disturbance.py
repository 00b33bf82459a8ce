"""The disturbance w of eq. 12 from errors of density, wind and lift that are given before the flight.

With D = k rho V_air^2 the relative rate of the drag exceeds that of the model by delta = d/dt (ln(rho /
rho_model) + 2 ln(V_air / V)); that enters D'' as D delta' + (D^2/V) ((V^2 - 4 g H)/(V^2 + 2 g H)) delta, and
an error of L/D as what it adds to the input, times g2.  Nothing here knows the drag that is to be followed.
Source: Lu & Bayard, section 2.3; as printed, w lacks V^2 (see
:mod:`~edl6dof.fsw.guidance.entry.prediction.uncertain_drag`) and lift has no error.
"""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.guidance.entry.prediction.uncertain_drag import uncertain_drag
from edl6dof.studies.lu_bayard.drag_model import Design


def disturbance_of(
    design: Design,
    t: np.ndarray,
    drag: np.ndarray,
    speed: np.ndarray,
    excess: np.ndarray,
    lift_error: np.ndarray,
) -> np.ndarray:
    """w (m/s4) along a flight, every array of shape (rows,).

    Args:
        design: for gravity, radius and scale height.
        t, drag, speed: s, m/s2, m/s over the ground.
        excess: ln(rho / rho_model) + 2 ln(V_air / V).
        lift_error: true less believed (L/D) cos(bank).
    """
    rate = np.gradient(excess, t)
    potential = design.gravity * design.scale_height
    path = drag**2 / speed * (speed**2 - 4.0 * potential) / (speed**2 + 2.0 * potential)
    per_u = [
        uncertain_drag(d, 0.0, v, design.gravity, design.radius, design.scale_height)[2]
        for d, v in zip(drag, speed, strict=True)
    ]
    return drag * np.gradient(rate, t) + path * rate + np.array(per_u) * lift_error
