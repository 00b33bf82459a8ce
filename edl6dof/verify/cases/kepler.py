"""Verifies: translation under gravity over one whole orbit, against Kepler's equation.

gravity central | atmosphere none | winds none | vehicle one rigid body | source: closed form of the two-body
problem (Vallado, Fundamentals of Astrodynamics, section 2.2) | tolerance 0.1 mm and 0.1 um/s over 40,000 km
of path: the error of RK4 at 0.1 s, (n h)^4, is below 1e-15 a step; 160,000 additions, each rounded to 5e-10
m, wander by 1e-7 m and drift along the track by about 1e-5 m, and Kepler's equation is solved to 1e-13 rad,
1e-6 m.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.optimize import newton

from edl6dof.verify.case import FREE, NO_RATE, History, Outcome, Result, flown, vectors

_SCENE = (
    *(*FREE, NO_RATE),
    "planet.gravity.model=central",
    "initial.altitude_m=5e6",
    "initial.latitude_deg=20",
    "initial.azimuth_deg=60",
    "initial.speed_m_s=1900",
    "initial.flight_path_angle_deg=0",
    "simulation.step_s=0.1",
    "flight_software.rates.base_hz=5",
    "simulation.log_every=100",
    "simulation.time_limit_s=16000",
)


def orbit(mu: float, r: np.ndarray, v: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity (times, 3) at times ``t`` of the orbit at an apsis ``r``, ``v`` at 0."""
    radius, speed = np.linalg.norm(r), np.linalg.norm(v)
    axis = 1.0 / (2.0 / radius - speed**2 / mu)
    momentum = np.cross(r, v)
    eccentricity = np.cross(v, momentum) / mu - r / radius
    e = np.linalg.norm(eccentricity)
    p_hat, q_hat = eccentricity / e, np.cross(momentum, eccentricity) / np.linalg.norm(momentum) / e
    n = np.sqrt(mu / axis**3)
    anomaly = np.pi + n * t  # mean anomaly from periapsis: the start is the apoapsis
    E = newton(
        lambda x: x - e * np.sin(x) - anomaly, anomaly, lambda x: 1.0 - e * np.cos(x), tol=1e-13, maxiter=50
    )
    minor = axis * np.sqrt(1.0 - e * e)
    position = np.outer(axis * (np.cos(E) - e), p_hat) + np.outer(minor * np.sin(E), q_hat)
    rate = n / (1.0 - e * np.cos(E))
    return position, np.outer(-axis * np.sin(E) * rate, p_hat) + np.outer(minor * np.cos(E) * rate, q_hat)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fly once around and compare every row."""
    nominal, flight = flown(_SCENE, planted)
    r, v = vectors(flight, "r_I", "m"), vectors(flight, "v_I", "m_s")
    t = flight.telemetry["t_s"]
    r_expected, v_expected = orbit(nominal.planet.gravity.mu_m3_s2, r[0], v[0], t)
    far, fast = np.linalg.norm(r - r_expected, axis=1), np.linalg.norm(v - v_expected, axis=1)
    about, why = (
        "gravity and translation over an orbit",
        "rounding of 160,000 steps; truncation is 1000 times smaller",
    )
    result = partial(Result, verifies=about, source="Kepler's equation", why=why)
    results = (result("position", far.max(), 1e-4, "m"), result("velocity", fast.max(), 1e-7, "m/s"))
    distance = (np.linalg.norm(each, axis=1) / 1e3 for each in (r, r_expected))
    return Outcome(results, History("Kepler arc", "time (s)", "distance from the centre (km)", t, *distance))
