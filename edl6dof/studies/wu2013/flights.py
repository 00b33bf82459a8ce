"""Curves and figures of one flight: how well drag is tracked, and how soon it is estimated."""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.prediction.drag_dynamics import drag_dynamics
from edl6dof.interface.roles import LIFT
from edl6dof.sim.flight import Flight

#: Share of the true value within which an estimate coincides with it in a figure, and the time (s) over which
#: that is watched.
CLOSE, WATCHED_S = 0.05, 5.0
#: Times (s) after the start and before the end that tracking errors are taken over.
SETTLED_S, END_S = 30.0, 1.0


def figures(flight: Flight) -> dict[str, float]:
    """Quality of tracking."""
    h = history(flight)
    t, error = h["t_s"], h["drag"] - h["reference"]
    steady = (t > SETTLED_S) & (t < t[-1] - END_S)
    return {"rms_error_m_s2": float(np.sqrt(np.mean(error[steady] ** 2)))}


def converged_s(h: dict[str, np.ndarray], name: str) -> float:
    """Time from which the estimate of ``drag`` or ``rate`` stays close to the truth, s."""
    t, true = h["t_s"], h[name]
    off = np.flatnonzero((np.abs(h[f"{name}_estimate"] - true) > CLOSE * np.abs(true)) & (t < WATCHED_S))
    return float(t[off[-1] + 1]) if off.size else 0.0


def history(flight: Flight) -> dict[str, np.ndarray]:
    """Curves of one flight at the guidance rate; the true drag rate follows from the true state and the drag
    that the law is told.
    """
    rates = flight.scenario.flight_software.rates
    lift = flight.during(LIFT)[:: rates.entry_guidance_every]
    rows = {name: column[:: rates.entry_guidance_every][lift] for name, column in flight.telemetry.items()}
    planet = flight.scenario.planet
    scale_height = stated(flight.scenario.atmosphere.exponential).scale_height_m
    radius = planet.equatorial_radius_m + rows["truth.altitude_m"]
    gamma = np.radians(rows["truth.flight_path_angle_deg"])
    state = zip(
        rows["nav.drag_m_s2"],
        rows["truth.speed_m_s"],
        gamma,
        radius,
        planet.gravity.mu_m3_s2 / radius**2,
        strict=True,
    )
    return {
        "t_s": rows["t_s"],
        "drag": rows["nav.drag_m_s2"],
        "drag_estimate": rows["guide.drag_estimate_m_s2"],
        "rate": np.array([drag_dynamics(*values, 0.0, scale_height)[0] for values in state]),
        "rate_estimate": rows["guide.drag_rate_m_s3"],
        "reference": rows["guide.reference_drag_m_s2"],
        "bank_deg": rows["guide.bank_deg"],
        "disturbance": rows["guide.drag_disturbance_m_s4"],
    }
