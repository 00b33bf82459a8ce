"""Check cases of a rigid body that turns freely."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

from edl6dof.config.base import stated
from edl6dof.verify.case import FREE, History, Outcome, Result, flown, largest, rates, vectors

_TUMBLING = (
    *FREE,
    "vehicle.mass.entry_inertia_kg_m2=[1150, 900, 1000]",
    "initial.speed_m_s=0",
    "initial.rate_deg_s=[0.0, 0.5, 30.0]",
    "simulation.time_limit_s=1000",
    "simulation.log_every=10",
)


def body_rates(inertia: np.ndarray, start: np.ndarray, t: np.ndarray) -> np.ndarray:
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


def tumbling(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: rotation about three unequal axes over 1,000 s, with the flips of the intermediate axis
    (Dzhanibekov).

    gravity none | atmosphere none | winds none | vehicle one rigid body, Ixx > Izz > Iyy, spun about z |
    source: conservation of energy and angular momentum; body rates in Jacobi elliptic functions (Landau &
    Lifshitz, Mechanics, section 37) by scipy | tolerance: energy and momentum 1e-9 relative (RK4 at 10 ms
    loses 1e-11 over 100,000 steps at 0.5 rad/s), rates 1e-6 of the spin: a relative error of 1e-11 in the
    momentum shifts the time of the last of six flips, near the separatrix, by 1e-7 of a period.

    Tumble for 1,000 s and compare energy, angular momentum in I and every body rate.
    """
    nominal, flight = flown(_TUMBLING, planted)
    inertia = np.array(nominal.vehicle.mass.entry_inertia_kg_m2)
    w, q, t = rates(flight), vectors(flight, "q_I2B", "", "wxyz"), flight.telemetry["t_s"]
    energy = 0.5 * np.sum(inertia * w**2, axis=1)
    momentum = Rotation.from_quat(q, scalar_first=True).apply(inertia * w)
    drift = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
    expected = body_rates(inertia, w[0], t)
    off = largest(w - expected) / np.linalg.norm(w[0])
    flips = int(np.sum(np.diff(np.sign(w[:, 2])) != 0))
    result = partial(Result, verifies=f"torque-free tumbling with {flips} flips")
    why = "truncation of RK4 at 10 ms and 0.5 rad/s: 1e-11 over 100,000 steps"
    kept = {"source": "conservation", "why": why}
    near = {"source": "Jacobi elliptic functions", "why": "time of the flips near the separatrix"}
    results = (
        result("rotational energy", float(np.ptp(energy) / energy[0]), 1e-9, **kept),
        result("angular momentum in I", largest(drift), 1e-9, **kept),
        result("body rates", off, 1e-6, **near),
    )
    labels = ("Intermediate-axis flips", "time (s)", "rate about z (rad/s)")
    return Outcome(results, History(*labels, t, w[:, 2], expected[:, 2]))


_TOP = (
    *FREE,
    "vehicle.mass.entry_inertia_kg_m2=[1150, 900, 900]",
    "initial.speed_m_s=0",
    "initial.rate_deg_s=[60, 20, 0]",
    "simulation.time_limit_s=200",
)


def _slope(t: np.ndarray, angle: np.ndarray) -> float:
    return float(np.polyfit(t, np.unwrap(angle), 1)[0])


def symmetric_top(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: precession of a spinning symmetric body, seen from the body and from outside.

    gravity none | atmosphere none | winds none | vehicle one rigid body, Iyy = Izz | source: Goldstein,
    Classical Mechanics, section 5.6: the lateral rate turns in the body with p (Ixx - Iyy) / Iyy, the axis
    turns about the angular momentum with |H| / Iyy | tolerance 1e-8 relative: the phase error of RK4 at 10 ms
    and 1.2 rad/s is (w h)^4 / 120 = 2e-10.

    Spin for 200 s and measure both turning rates by the slope of their phase.
    """
    nominal, flight = flown(_TOP, planted)
    axial, lateral, _ = stated(nominal.vehicle.mass.entry_inertia_kg_m2)
    w, q, t = rates(flight), vectors(flight, "q_I2B", "", "wxyz"), flight.telemetry["t_s"]
    in_body = _slope(t, np.arctan2(w[:, 2], w[:, 1]))
    expected_body = w[0, 0] * (axial - lateral) / lateral
    momentum = np.array([axial, lateral, lateral]) * w[0]
    turn = Rotation.from_quat(q, scalar_first=True)
    h_hat = turn[0].apply(momentum) / np.linalg.norm(momentum)
    axis = turn.apply([1.0, 0.0, 0.0])
    across = axis[0] - (axis[0] @ h_hat) * h_hat
    across /= np.linalg.norm(across)
    outside = _slope(t, np.arctan2(axis @ np.cross(h_hat, across), axis @ across))
    expected_outside = float(np.linalg.norm(momentum)) / lateral
    result = partial(Result, source="symmetric top", why="phase error of RK4, (w h)^4 / 120, is 2e-10")
    off_body, off_outside = abs(in_body / expected_body - 1.0), abs(outside / expected_outside - 1.0)
    results = (
        result("rate in the body", off_body, 1e-8, verifies="gyroscopic coupling"),
        result("rate in space", off_outside, 1e-8, verifies="rate to attitude"),
    )
    curve = w[0, 1] * np.cos(expected_body * t)
    return Outcome(results, History("Symmetric top", "time (s)", "pitch rate (rad/s)", t, w[:, 1], curve))
