"""Check cases of the motion of the centre of mass: order of the integrator, and Kepler orbits."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.optimize import newton

from edl6dof.verify.case import BARE, FREE, NO_RATE, History, Outcome, Result, flown, vectors

_ORDER_SCENE = (
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
    return flown([*_ORDER_SCENE, f"simulation.step_s={step}"], planted)[1].plant["y"][0, :13].copy()


def rk4_order(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: the integrator is of fourth order, in position, velocity, attitude and rate.

    gravity harmonics of degree 4 | atmosphere exponential | winds none | vehicle spinning, constant drag and
    rate damping: smooth forces | source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
    section II.4: halving the step divides the error by 16 | tolerance 0.3: the next term of the error is a
    step longer, and the smallest difference stands 100 above rounding.

    Fly with three steps and compare the differences.
    """
    coarse, middle, fine = (end_state(step, planted) for step in (0.1, 0.05, 0.025))
    about = {"verifies": "Runge-Kutta step", "source": "step halving", "why": "next term of the error"}
    results = []
    for name, part in PARTS.items():
        sizes = (np.linalg.norm(a[part] - b[part]) for a, b in ((coarse, middle), (middle, fine)))
        order = float(np.log2(np.divide(*sizes)))
        results.append(Result(f"order, {name}", abs(order - 4.0), 0.3, **about))
    return Outcome(results)


_ORBIT_SCENE = (
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


def kepler(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: translation under gravity over one whole orbit, against Kepler's equation.

    gravity central | atmosphere none | winds none | vehicle one rigid body | source: closed form of the
    two-body problem (Vallado, Fundamentals of Astrodynamics, section 2.2) | tolerance 0.1 mm and 0.1 um/s
    over 40,000 km of path: the error of RK4 at 0.1 s, (n h)^4, is below 1e-15 a step; 160,000 additions, each
    rounded to 5e-10 m, wander by 1e-7 m and drift along the track by about 1e-5 m, and Kepler's equation is
    solved to 1e-13 rad, 1e-6 m.

    Fly once around and compare every row.
    """
    nominal, flight = flown(_ORBIT_SCENE, planted)
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
