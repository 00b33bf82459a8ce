"""The theorem in its own setting: constant theta, a disturbance given as a function of time, unlimited
control.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import sin

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from edl6dof.fsw.guidance.entry.profiles.drag_velocity import path_sine, profile_drag
from edl6dof.studies.lu_bayard.drag_model import Adapted, Design, respond
from edl6dof.studies.lu_bayard.settings import START_ERROR

#: True theta of the design model, inside the law's set.
THETA = np.array([1e-3, -5e-5, 0.06, 0.03, 0.05])
DURATION_S = 110.0


def nothing(t: float) -> float:
    """No disturbance."""
    return 0.0


def pulse(t: float) -> float:
    """Energy-bounded disturbance, m/s4: near the resonance of the drag loop, dying out."""
    return float(0.05 * sin(0.11 * t) * np.exp(-t / 30.0))


def gust(t: float) -> float:
    """Energy-bounded disturbance, m/s4: one half wave."""
    return 0.08 * sin(np.pi * (t - 30.0) / 10.0) if 30.0 < t < 40.0 else 0.0


DISTURBANCES = {"w = 0": nothing, "w dying out": pulse, "w one gust": gust}


def respond_along(
    design: Design, onboard: np.ndarray, disturbance: Callable[[float], float], *, adaptive: bool = True
) -> Adapted:
    """Response of the design model along the profile in time, from a wrong drag and a wrong theta."""
    profile = onboard[0]["plan"]["adaptive_hinf"]

    def rates(t: float, v: np.ndarray) -> np.ndarray:
        drag, slope, _ = profile_drag(profile, v[0])
        return np.array(
            [-drag - design.gravity * path_sine(v[0], drag, slope, design.gravity, design.scale_height)]
        )

    t = np.arange(0.0, DURATION_S + 1.0, 0.5)
    speed = solve_ivp(rates, (0.0, t[-1]), [profile["start"]], t_eval=t, rtol=1e-9).y[0]
    along = CubicSpline(t, [profile_drag(profile, v)[0] for v in speed])
    parts = (along, along.derivative(), along.derivative(2))

    @lru_cache(maxsize=2)  # each stage of a step asks, two of them for its middle
    def reference(now: float) -> tuple[float, float, float]:
        return float(parts[0](now)), float(parts[1](now)), float(parts[2](now))

    start = (START_ERROR, 0.0, float(profile["start"]))
    return respond(design, reference, THETA, disturbance, start, DURATION_S, adaptive=adaptive)
