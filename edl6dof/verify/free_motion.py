"""Check cases of free motion: order of the integrator, Kepler orbits, and a rigid body that turns freely."""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.optimize import newton
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

from edl6dof.config.base import stated
from edl6dof.sim.flight import Flight
from edl6dof.verify.case import BARE, FREE, NO_RATE, Bench, given, largest, vectors

_ORDER = (
    *(*BARE, "flight_software.rates.base_hz=5"),
    *("atmosphere.model=exponential", "vehicle.aero.model=constant"),
    "vehicle.aero.constant={drag_coefficient: 1.5, pitch_damping: -0.5, reference_area_m2: 9, chord_m: 3.4, "
    "moment_reference_x_m: -1.2}",
    *given("initial", altitude_m=45000, rate_deg_s=[5, 20, 3]),
    "simulation.time_limit_s=20",
)
_PARTS = {"position": slice(0, 3), "velocity": slice(3, 6), "attitude": slice(6, 10), "rate": slice(10, 13)}


def end_state(step: float, bench: Bench) -> np.ndarray:
    """State after 20 s in steps of ``step`` s."""
    return bench.flown([*_ORDER, f"simulation.step_s={step}"])[1].plant["y"][0, :13].copy()


def rk4_order(bench: Bench) -> None:
    """Verifies: the integrator is of fourth order, in position, velocity, attitude and rate.

    gravity harmonics of degree 4 | atmosphere exponential | winds none | vehicle spinning, constant drag and
    rate damping: smooth forces | source: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
    section II.4: halving the step divides the error by 16 | tolerance 0.3: the next term of the error is a
    step longer, and the smallest difference stands 100 above rounding.

    Fly with three steps and compare the differences.
    """
    coarse, middle, fine = (end_state(step, bench) for step in (0.1, 0.05, 0.025))
    about = ("Runge-Kutta step", "step halving", "next term of the error")
    for name, part in _PARTS.items():
        sizes = (np.linalg.norm(a[part] - b[part]) for a, b in ((coarse, middle), (middle, fine)))
        order = float(np.log2(np.divide(*sizes)))
        bench.compare(f"order, {name}", abs(order - 4.0), 0.3, "-", *about)


_ORBIT = (
    *(*FREE, NO_RATE, "planet.gravity.model=central", "flight_software.rates.base_hz=5"),
    *given("initial", altitude_m=5e6, latitude_deg=20, azimuth_deg=60),
    *given("initial", speed_m_s=1900, flight_path_angle_deg=0),
    *given("simulation", step_s=0.1, log_every=100, time_limit_s=16000),
)


def _orbit(mu: float, r: np.ndarray, v: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
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


def kepler(bench: Bench) -> None:
    """Verifies: translation under gravity over one whole orbit, against Kepler's equation.

    gravity central | atmosphere none | winds none | vehicle one rigid body | source: closed form of the
    two-body problem (Vallado, Fundamentals of Astrodynamics, section 2.2) | tolerance 0.1 mm and 0.1 um/s
    over 40,000 km of path, ten times the largest error, that of rounding: each of 160,000 steps rounds the
    position to 5e-10 m, which causes a random error of 1e-7 m and a drift along the track of 1e-5 m. Kepler's
    equation is solved to 1e-13 rad, 1e-6 m. The truncation of RK4, (n h)^4 per radian with the mean motion n
    = 4e-4 rad/s and the step h = 0.1 s, is smaller by far.

    Fly once around and compare every row.
    """
    nominal, flight = bench.flown(_ORBIT)
    r, v, t = vectors(flight, "r_I", "m"), vectors(flight, "v_I", "m_s"), flight.telemetry["t_s"]
    r_expected, v_expected = _orbit(nominal.planet.gravity.mu_m3_s2, r[0], v[0], t)
    far, fast = np.linalg.norm(r - r_expected, axis=1), np.linalg.norm(v - v_expected, axis=1)
    verifies, source = "gravity and translation over an orbit", "Kepler's equation"
    why = "rounding of 160,000 steps; truncation is 1000 times smaller"
    compare = partial(bench.compare, verifies=verifies, source=source, why=why)
    compare("position", far.max(), 1e-4, "m")
    compare("velocity", fast.max(), 1e-7, "m/s")
    distances = (np.linalg.norm(each, axis=1) / 1e3 for each in (r, r_expected))
    bench.plot("Kepler arc", "time (s)", "distance from the centre (km)", t, *distances)


def _rotation(flight: Flight) -> tuple[np.ndarray, np.ndarray, Rotation]:
    """Times (s), body rates p, q, r (rad/s), shape (rows, 3), and attitudes in I."""
    attitude = Rotation.from_quat(vectors(flight, "q_I2B", "", "wxyz"), scalar_first=True)
    return flight.telemetry["t_s"], np.radians(vectors(flight, "rate", "deg_s", "pqr")), attitude


_TUMBLING = (
    *(*FREE, "vehicle.mass.entry_inertia_kg_m2=[1150, 900, 1000]"),
    *given("initial", speed_m_s=0, rate_deg_s=[0.0, 0.5, 30.0]),
    *given("simulation", time_limit_s=1000, log_every=10),
)


def _body_rates(inertia: np.ndarray, start: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Rates (x, y, z) of a body with Ixx > Izz > Iyy that starts without rate about x; shape (times, 3).

    With I1 < I2 < I3 for y, z, x and M^2 < 2 E I2 the rates about 1, 2, 3 are (dn, sn, cn) of one argument.
    """
    i1, i2, i3 = inertia[1], inertia[2], inertia[0]
    energy2, momentum2 = float(np.sum(inertia * start**2)), float(np.sum((inertia * start) ** 2))
    above, below = momentum2 - energy2 * i1, energy2 * i3 - momentum2
    if momentum2 >= energy2 * i2:
        raise ValueError("the start must lie on the side of the smallest axis")
    a1 = np.sqrt(below / (i1 * (i3 - i1)))
    a2, a3 = (np.sqrt(above / (i * (i - i1))) for i in (i2, i3))
    speed = np.sqrt((i2 - i1) * below / (i1 * i2 * i3))
    m = (i3 - i2) * above / ((i2 - i1) * below)
    # the start is at an extreme of the intermediate rate: a quarter period after sn = 0
    sn, cn, dn, _ = ellipj(speed * t + ellipk(m), m)
    return np.stack([a3 * cn, a1 * dn, a2 * sn], axis=1)


def tumbling(bench: Bench) -> None:
    """Verifies: rotation about three unequal axes over 1,000 s, with the flips of the intermediate axis
    (Dzhanibekov).

    gravity none | atmosphere none | winds none | vehicle one rigid body, Ixx > Izz > Iyy, spun about z |
    source: conservation of energy and angular momentum; body rates in Jacobi elliptic functions (Landau &
    Lifshitz, Mechanics, section 37) by scipy | tolerance: energy and momentum 1e-9 relative (RK4 at 10 ms
    loses 1e-11 over 100,000 steps at 0.5 rad/s), rates 1e-6 of the spin: a relative error of 1e-11 in the
    momentum shifts the time of the last of six flips, near the separatrix, by 1e-7 of a period.

    Tumble for 1,000 s and compare energy, angular momentum in I and every body rate.
    """
    nominal, flight = bench.flown(_TUMBLING)
    inertia = np.array(nominal.vehicle.mass.entry_inertia_kg_m2)
    t, w, attitude = _rotation(flight)
    energy, momentum = 0.5 * np.sum(inertia * w**2, axis=1), attitude.apply(inertia * w)
    drift = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
    expected = _body_rates(inertia, w[0], t)
    flips = int(np.sum(np.diff(np.sign(w[:, 2])) != 0))
    compare = partial(bench.compare, verifies=f"torque-free tumbling with {flips} flips")
    why = "truncation of RK4 at 10 ms and 0.5 rad/s: 1e-11 over 100,000 steps"
    kept = {"source": "conservation", "why": why}
    near = {"source": "Jacobi elliptic functions", "why": "time of the flips near the separatrix"}
    compare("rotational energy", float(np.ptp(energy) / energy[0]), 1e-9, **kept)
    compare("angular momentum in I", largest(drift), 1e-9, **kept)
    compare("body rates", largest(w - expected) / np.linalg.norm(w[0]), 1e-6, **near)
    bench.plot("Intermediate-axis flips", "time (s)", "rate about z (rad/s)", t, w[:, 2], expected[:, 2])


_TOP = (
    *(*FREE, "vehicle.mass.entry_inertia_kg_m2=[1150, 900, 900]"),
    *given("initial", speed_m_s=0, rate_deg_s=[60, 20, 0]),
    "simulation.time_limit_s=200",
)


def _slope(t: np.ndarray, angle: np.ndarray) -> float:
    return float(np.polyfit(t, np.unwrap(angle), 1)[0])


def symmetric_top(bench: Bench) -> None:
    """Verifies: precession of a spinning symmetric body, seen from the body and from outside.

    gravity none | atmosphere none | winds none | vehicle one rigid body, Iyy = Izz | source: Goldstein,
    Classical Mechanics, section 5.6: the lateral rate turns in the body with p (Ixx - Iyy) / Iyy, the axis
    turns about the angular momentum with |H| / Iyy | tolerance 1e-8 relative: the phase error of RK4 at 10 ms
    and 1.2 rad/s is (w h)^4 / 120 = 2e-10.

    Spin for 200 s and measure both turning rates by the slope of their phase.
    """
    nominal, flight = bench.flown(_TOP)
    axial, lateral, _ = stated(nominal.vehicle.mass.entry_inertia_kg_m2)
    t, w, attitude = _rotation(flight)
    in_body = _slope(t, np.arctan2(w[:, 2], w[:, 1]))
    expected_body = w[0, 0] * (axial - lateral) / lateral
    momentum = np.array([axial, lateral, lateral]) * w[0]
    h_hat = attitude[0].apply(momentum) / np.linalg.norm(momentum)
    axis = attitude.apply([1.0, 0.0, 0.0])
    across = axis[0] - (axis[0] @ h_hat) * h_hat
    across /= np.linalg.norm(across)
    outside = _slope(t, np.arctan2(axis @ np.cross(h_hat, across), axis @ across))
    expected_outside = float(np.linalg.norm(momentum)) / lateral
    why = "phase error of RK4, (w h)^4 / 120, is 2e-10"
    compare = partial(bench.compare, source="symmetric top", why=why)
    compare("rate in the body", abs(in_body / expected_body - 1.0), 1e-8, verifies="gyroscopic coupling")
    compare("rate in space", abs(outside / expected_outside - 1.0), 1e-8, verifies="rate to attitude")
    curve = w[0, 1] * np.cos(expected_body * t)
    bench.plot("Symmetric top", "time (s)", "pitch rate (rad/s)", t, w[:, 1], curve)
