"""How well the drag is tracked in one flight, and what eq. 51 allows."""

from __future__ import annotations

from math import sqrt

import numpy as np

from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.prediction.drag_dynamics import drag_dynamics
from edl6dof.fsw.guidance.entry.prediction.reference import NODES
from edl6dof.interface.roles import LIFT
from edl6dof.scenario.records import build_onboard
from edl6dof.sim.flight import Flight

#: Virtual state (m/s3) below which saturation counts as over.
CONVERGED = 0.01
#: and for how long it must stay there.
CALM_S = 3.0


def figures(flight: Flight) -> dict[str, float]:
    """Tracking quality of one flight."""
    rows = flight.telemetry
    control = range_control(flight)
    t, error = rows["t_s"][control], (rows["nav.drag_m_s2"] - rows["guide.reference_drag_m_s2"])[control]
    virtual, surface = (
        np.abs(rows["guide.virtual_m_s3"][control]),
        np.abs(rows["guide.surface_m_s3"][control]),
    )
    settled = _first_calm(t, virtual)
    return {
        "control_start_s": float(t[0]),
        "control_end_s": float(t[-1]),
        "saturation_end_s": float(t[settled]),
        "peak_error_m_s2": float(np.max(np.abs(error))),
        "peak_error_settled_m_s2": float(np.max(np.abs(error[settled:]))),
        "peak_surface_m_s3": float(np.max(surface)),
        "peak_surface_settled_m_s3": float(np.max(surface[settled:])),
    }


def _first_calm(t: np.ndarray, virtual: np.ndarray) -> int:
    """Row from which the virtual state stays converged for a while: the saturation at the beginning is
    over.
    """
    for start in np.flatnonzero(virtual < CONVERGED):
        if np.all(virtual[start : np.searchsorted(t, t[start] + CALM_S)] < CONVERGED):
            return int(start)
    return len(t) - 1


def range_control(flight: Flight) -> np.ndarray:
    """Rows in which the law controls range: its phase, above the speed of heading alignment."""
    rows, entry = flight.telemetry, flight.scenario.flight_software.guidance.entry
    return flight.during(LIFT) & (rows["truth.speed_m_s"] > entry.heading_below_m_s)


def history(flight: Flight) -> dict[str, np.ndarray]:
    """Curves of one flight in range control, the true lumped disturbance among them.

    That is D'' - b_n cos(bank) with D'' by finite differences of the flown drag and b_n from what is known on
    board.
    """
    rows = flight.telemetry
    control = range_control(flight)
    drag, speed = rows["nav.drag_m_s2"], rows["truth.speed_m_s"]
    authority = _authority(flight)
    acceleration = np.gradient(np.gradient(drag, rows["t_s"]), rows["t_s"])
    columns = {
        "t_s": rows["t_s"],
        "drag": drag,
        "reference": _reference_drag(flight),
        "bank_deg": np.abs(rows["guide.bank_deg"]),
        "surface": rows["guide.surface_m_s3"],
        "virtual": rows["guide.virtual_m_s3"],
        "estimate": rows["guide.drag_disturbance_m_s4"],
        "authority": authority,
        "disturbance": acceleration - authority * np.cos(np.radians(rows["truth.bank_deg"])),
    }
    points = flight.scenario.flight_software.guidance.entry.reference_bank.points
    speeds, banks = [point.at for point in points], [point.bank_deg for point in points]
    return {name: values[control] for name, values in columns.items()} | {
        "planned_deg": np.interp(speed[control], speeds, banks)
    }


def _authority(flight: Flight) -> np.ndarray:
    """b_n of each row (m/s4): what full lift up does to D'', as known on board."""
    rows, planet = flight.telemetry, flight.scenario.planet
    drag, gamma = rows["nav.drag_m_s2"], np.radians(rows["truth.flight_path_angle_deg"])
    radius = planet.equatorial_radius_m + rows["truth.altitude_m"]
    gravity = planet.gravity.mu_m3_s2 / radius**2
    lift = drag * flight.scenario.vehicle.aero.lift_drag.lift_to_drag
    scale_height = stated(flight.scenario.atmosphere.exponential).scale_height_m
    state = zip(drag, rows["truth.speed_m_s"], gamma, radius, gravity, lift, strict=True)
    return np.array([drag_dynamics(*values, scale_height)[1] for values in state])


def _reference_drag(flight: Flight) -> np.ndarray:
    """Reference drag of each row, for a flight under any law."""
    rows, planet = flight.telemetry, flight.scenario.planet
    table = build_onboard(flight.scenario)[0]["reference"]
    radius = planet.equatorial_radius_m
    potential = planet.gravity.mu_m3_s2 * (1.0 / radius - 1.0 / (radius + rows["truth.altitude_m"]))
    energy = np.maximum(0.5 * rows["truth.speed_m_s"] ** 2 + potential, 0.0)
    nodes = table["first"] + table["spacing"] * np.arange(NODES)
    return np.interp(np.sqrt(2.0 * energy), nodes, table["drag"])


def input_shortage(
    t: np.ndarray, virtual: np.ndarray, authority: np.ndarray, virtual_gain: float
) -> np.ndarray:
    """delta = sat(v) - v of each interval (eq. 18), shape (rows - 1,): what the virtual state (eq. 19, held
    over an interval) must have been fed.
    """
    decay = virtual_gain + 0.25 * authority[:-1] ** 2
    kept = np.exp(-decay * np.diff(t))
    return (virtual[1:] - kept * virtual[:-1]) * decay / ((1.0 - kept) * authority[:-1])


def error_over_bound(
    t: np.ndarray, error: np.ndarray, shortage: np.ndarray, error_gain: float, boundary: float
) -> float:
    """Energy of the drag error over what eq. 51 allows it: (e(0)^2/2 + (c_s^2 T + int delta^2)/2)/(k_e - 2).

    Args:
        t: times of the rows, s.
        error: drag error of the rows, m/s2.
        shortage: delta of the intervals between them.
        error_gain, boundary: k_e (1/s) and c_s (m/s3).
    """
    energy = float(np.trapezoid(error**2, t))
    missing = float(np.sum(shortage**2 * np.diff(t)))
    allowed = 0.5 * error[0] ** 2 + 0.5 * (boundary**2 * (t[-1] - t[0]) + missing)
    return energy * (error_gain - 2.0) / float(allowed)


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return sqrt(float(np.mean(values**2)))
