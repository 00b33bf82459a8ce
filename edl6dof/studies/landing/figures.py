"""Figures of one landing that the comparison needs besides the declared ones."""

from __future__ import annotations

from math import hypot, nan

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, POWERED_DECELERATION
from edl6dof.sim.flight import Flight
from edl6dof.telemetry.columns import Telemetry

#: How near its limit (deg) a commanded tilt, and how near the band's end (N) a thrust, counts as saturated.
_AT_LIMIT_DEG, _AT_LIMIT_N = 0.1, 1.0


def of_flight(flight: Flight) -> dict[str, float]:
    """From ignition to hover, and to the ground.

    - ``came_down``: whether it landed, within limits or not.
    - ``ignition_height_m``, ``ignition_descent_m_s``, ``ignition_drift_m_s``: true state where the engine
      lights.
    - ``hover_fuel_kg``, ``ground_fuel_kg``: propellant from there until hover begins, and until the end of a
      flight that lands.
    - ``target_miss_m``: true level distance from the target where hover begins; the target lies where
      guidance has put it from the lander's place at ignition, however well that is known from the site.
    - ``navigated_miss_m``: the same as navigation sees it.
    - ``hover_off_m``, ``hover_speed_m_s``: height off the target's, and speed, there.
    - ``peak_tilt_deg``: of the thrust axis while decelerating.
    - ``saturated_s``: thrust at the upper end of the band or beyond, or commanded tilt at its limit, the
      start at full level left out.
    """
    rows, braking = flight.telemetry, np.flatnonzero(flight.during(POWERED_DECELERATION))
    burning = braking[rows["guide.thrust_n"][braking] > 0.0]
    if not len(burning):
        return {"came_down": flight.landed}
    start, hover = burning[0], np.flatnonzero(flight.during(HOVER_IMAGING))
    found = {
        "came_down": flight.landed,
        "ignition_height_m": float(rows["truth.height_m"][start]),
        "ignition_descent_m_s": float(rows["truth.v_down_m_s"][start]),
        "ignition_drift_m_s": hypot(rows["truth.v_north_m_s"][start], rows["truth.v_east_m_s"][start]),
        "peak_tilt_deg": float(np.max(rows["truth.tilt_deg"][burning])),
        "saturated_s": _saturated(flight, burning),
    }
    propellant = rows["truth.propellant_kg"]
    if len(hover):
        found["hover_fuel_kg"] = float(propellant[start] - propellant[hover[0]])
        found.update(_arrival(flight, int(start), int(hover[0])))
    if flight.landed:
        found["ground_fuel_kg"] = float(propellant[start] - propellant[-1])
    return found


def _saturated(flight: Flight, burning: np.ndarray) -> float:
    rows, powered = flight.telemetry, flight.scenario.flight_software.guidance.powered
    t = rows["t_s"][burning]
    engine = flight.scenario.vehicle.engines[0]
    limit = getattr(getattr(powered, powered.law), "tilt_limit_deg", nan)
    down = np.clip(-rows["guide.thrust_direction_down"][burning], -1.0, 1.0)
    tilt = np.degrees(np.arccos(down))
    at_limit = (rows["guide.thrust_n"][burning] > engine.throttle_max_n - _AT_LIMIT_N) | (
        tilt > limit - _AT_LIMIT_DEG
    )
    return float(np.sum(np.gradient(t)[at_limit & (t > t[0] + powered.full_time_s)]))


def _arrival(flight: Flight, start: int, hover: int) -> dict[str, float]:
    """Where hover begins, against the target."""
    rows, target = flight.telemetry, flight.fsw[0]["guidance"]["target"]
    off = _level(rows, "truth.site", hover) - target["point_L"]
    chosen, now = (_level(rows, "nav.error", row) for row in (start, hover))
    return {
        # the target lies where navigation believed it when it was chosen, which its error then puts elsewhere
        "target_miss_m": float(np.hypot(*(off + chosen))),
        "navigated_miss_m": float(np.hypot(*(off + now))),
        "hover_off_m": float(rows["truth.height_m"][hover] - target["height"]),
        "hover_speed_m_s": float(rows["truth.speed_m_s"][hover]),
    }


def _level(rows: Telemetry, stem: str, row: int) -> np.ndarray:
    """East and north parts of a channel, m."""
    return np.array([rows[f"{stem}_{axis}_m"][row] for axis in ("east", "north")])
