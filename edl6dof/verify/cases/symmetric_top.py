"""Verifies: precession of a spinning symmetric body, seen from the body and from outside.

gravity none | atmosphere none | winds none | vehicle one rigid body, Iyy = Izz | source: Goldstein, Classical
Mechanics, section 5.6: the lateral rate turns in the body with p (Ixx - Iyy) / Iyy, the axis turns about the
angular momentum with |H| / Iyy | tolerance 1e-8
relative: the phase error of RK4 at 10 ms and 1.2 rad/s is (w h)^4 / 120 = 2e-10.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from edl6dof.config.base import stated
from edl6dof.verify.case import FREE, History, Outcome, Result, flown, rates, vectors

_SCENE = (
    *FREE,
    "vehicle.mass.entry_inertia_kg_m2=[1150, 900, 900]",
    "initial.speed_m_s=0",
    "initial.rate_deg_s=[60, 20, 0]",
    "simulation.time_limit_s=200",
)


def _slope(t: np.ndarray, angle: np.ndarray) -> float:
    return float(np.polyfit(t, np.unwrap(angle), 1)[0])


def run(planted: Sequence[str] = ()) -> Outcome:
    """Spin for 200 s and measure both turning rates by the slope of their phase."""
    nominal, flight = flown(_SCENE, planted)
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
