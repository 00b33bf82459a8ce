"""The range predicted along the profile beside that of an integrated flight."""

from __future__ import annotations

from math import asin, cos, log, sin

import numpy as np
from scipy.integrate import solve_ivp

from edl6dof.fsw.guidance.entry.prediction.drag_dynamics import drag_dynamics
from edl6dof.fsw.guidance.entry.profiles.drag_velocity import path_sine, profile_drag, profile_range
from edl6dof.studies.lu_bayard.settings import scale_height_of
from edl6dof.studies.study import Finding


def range_findings(onboard: np.ndarray, radius: float) -> tuple[Finding, ...]:
    """Predicted range along the profile beside that of an integrated flight that is held on it by whatever
    lift it takes.
    """
    record, profile = onboard[0], onboard[0]["plan"]["adaptive_hinf"]
    mu, scale_height = float(record["planet"]["mu"]), scale_height_of(onboard)
    first, final = 0.9 * float(profile["start"]), float(profile["final"])

    def rates(t: float, s: np.ndarray) -> list[float]:
        h, v, gamma, _ = s
        r = radius + h
        g = mu / r**2
        drag = _drag_at(onboard, h, v)
        goal, slope, curvature = profile_drag(profile, v)
        rate, a, b = drag_dynamics(drag, v, gamma, r, g, drag, scale_height)
        speed_rate = -drag - g * sin(gamma)
        wanted = (
            curvature * speed_rate**2
            - slope * rate
            + 0.8 * (slope * speed_rate - rate)
            + 0.16 * (goal - drag)
        )
        lift = drag * (wanted - b) / a
        return [
            v * sin(gamma),
            speed_rate,
            lift / v + (v / r - g / v) * cos(gamma),
            v * cos(gamma) * radius / r,
        ]

    def slow(t: float, s: np.ndarray) -> float:
        return s[1] - final

    slow.terminal = True  # type: ignore[attr-defined]  # scipy's mark on an event that ends the integration
    goal, slope, _ = profile_drag(profile, first)
    height = scale_height * log(_drag_at(onboard, 0.0, first) / goal)
    gamma = asin(path_sine(first, goal, slope, mu / (radius + height) ** 2, scale_height))
    flown = solve_ivp(
        rates, (0.0, 900.0), [height, first, gamma, 0.0], events=slow, rtol=1e-8, atol=1e-6, max_step=0.5
    ).y[3, -1]
    predicted = float(profile_range(profile, first))
    return (
        Finding(
            "range predicted along the profile",
            "km",
            predicted / 1e3,
            note=f"from {first:.0f} to {final:.0f} m/s",
        ),
        Finding("range of an integrated flight held on it", "km", float(flown) / 1e3),
    )


def _drag_at(onboard: np.ndarray, altitude: float, speed: float) -> float:
    air, vehicle = onboard[0]["atmosphere"], onboard[0]["vehicle"]
    density = np.exp(
        np.interp(
            altitude, air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"])), air["ln_density"]
        )
    )
    return float(0.5 * density * speed**2 * vehicle["drag_area"] / vehicle["entry_mass"])
