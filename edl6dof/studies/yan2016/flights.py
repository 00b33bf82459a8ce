"""Figures of one flight beside the undisturbed nominal at equal time, as in the paper's figures."""

from __future__ import annotations

from math import nan

import numpy as np

from edl6dof.interface.roles import LIFT
from edl6dof.sim.flight import Flight

#: Seconds after which the observer has settled.
OBSERVED_S = 1.0
#: Share of the nominal's peak drag within which drag counts as that of the nominal.
SETTLED = 0.02
#: Bank angles (deg) nearer than this to 0 or 180 are saturated.
SATURATED_DEG = 0.01


def figures(flight: Flight, nominal: Flight) -> dict[str, float]:
    """How far one flight is from the nominal, when its drag settles, how long its bank is saturated, and how
    good its disturbance estimate is.
    """
    rows, planned = flight.telemetry, nominal.telemetry
    shared = min(len(rows["t_s"]), len(planned["t_s"]))
    altitude = (rows["truth.altitude_m"][:shared] - planned["truth.altitude_m"][:shared]) / 1e3
    along = (downrange_m(flight)[:shared] - downrange_m(nominal)[:shared]) / 1e3
    drag = rows["nav.drag_m_s2"][:shared] - planned["nav.drag_m_s2"][:shared]
    bank = np.abs(rows["guide.bank_deg"][flight.during(LIFT)])
    return {
        "rms_altitude_error_km": _rms(altitude),
        "rms_range_error_km": _rms(along),
        "final_altitude_error_km": abs(
            flight.metrics["parachute_altitude_m"] - nominal.metrics["parachute_altitude_m"]
        )
        / 1e3,
        "final_range_error_km": abs(float(downrange_m(flight)[-1] - downrange_m(nominal)[-1])) / 1e3,
        "drag_settled_s": last_outside(
            rows["t_s"][:shared], drag, SETTLED * float(np.max(planned["nav.drag_m_s2"]))
        ),
        "saturated_pct": 100.0 * float(np.mean((bank < SATURATED_DEG) | (bank > 180.0 - SATURATED_DEG))),
        "start_error_m_s2": abs(float(drag[0])),
        "estimate_error_pct": _estimate_error(flight),
    }


def last_outside(t: np.ndarray, error: np.ndarray, limit: float) -> float:
    """Last time (s) at which the error is outside its limit; the first time if it never is."""
    outside = np.flatnonzero(np.abs(error) > limit)
    return float(t[outside[-1]] if outside.size else t[0])


def downrange_m(flight: Flight) -> np.ndarray:
    """Range flown along the equator, m on the reference sphere."""
    return np.radians(flight.telemetry["truth.longitude_deg"]) * flight.scenario.planet.equatorial_radius_m


def authority_rad_s(nominal: Flight) -> np.ndarray:
    """L/V of the nominal while the law flies: the largest flight-path rate that lift can make or cancel."""
    rows, guided = nominal.telemetry, nominal.during(LIFT)
    lift_to_drag = nominal.scenario.vehicle.aero.lift_drag.lift_to_drag
    return lift_to_drag * rows["nav.drag_m_s2"][guided] / rows["truth.speed_m_s"][guided]


def observed(flight: Flight) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, estimated and true disturbance (rad/s) while the law flies."""
    rows, guided = flight.telemetry, flight.during(LIFT)
    t = rows["t_s"][guided]
    d = flight.loaded.truth.point_mass.disturbance
    true = d.amplitude_rad_s * np.sin(d.frequency_rad_s * t)
    return t, np.radians(rows["guide.path_disturbance_deg_s"][guided]), true


def _estimate_error(flight: Flight) -> float:
    """Largest error of the estimate once the observer has settled, % of the amplitude; NaN where there is
    none.
    """
    t, estimate, true = observed(flight)
    amplitude = float(np.max(np.abs(true)))
    return 100.0 * float(np.max(np.abs(estimate - true)[t > OBSERVED_S])) / amplitude if amplitude else nan


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))
