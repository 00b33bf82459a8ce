"""Figures of one flight that the comparison needs besides the declared ones."""

from __future__ import annotations

import numpy as np

from edl6dof.interface.roles import LIFT
from edl6dof.sim.flight import Flight


def of_flight(flight: Flight) -> dict[str, float]:
    """Control effort, saturation and tracking of one flight, in the phase of lift control above the alignment
    speed.
    """
    rows, entry = flight.telemetry, flight.scenario.flight_software.guidance.entry
    lift = flight.during(LIFT)
    steered = lift & (rows["truth.speed_m_s"] > max(entry.align_speed_m_s, entry.heading_below_m_s))
    bank, dt = np.abs(rows["guide.bank_deg"][steered]), np.gradient(rows["t_s"])[steered]
    at_limit = (bank >= entry.bank_max_deg - 0.01) | (bank <= entry.bank_min_deg + 0.01)
    reference = rows["guide.reference_drag_m_s2"][steered]
    followed = reference > 0.0
    error = (rows["nav.drag_m_s2"][steered] - reference)[followed]
    return {
        "bank_travel_deg": float(np.sum(np.abs(np.diff(rows["guide.bank_deg"][lift])))),
        "saturation_s": float(np.sum(dt[at_limit])),
        "tracking_error_m_s2": float(np.sqrt(np.mean(error**2))) if followed.any() else float("nan"),
    }
