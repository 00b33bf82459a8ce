"""Borders of the zones of an attitude controller in the plane of error and rate, from its gains.

Error is goal minus actual and rate is actual minus goal, so that a controller at work runs through the first
and third quadrants towards the origin.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

AIMED_FOR, FIRING = "rate aimed for", "firing begins"


class Zones(NamedTuple):
    """Borders of one axis; all of them have an image through the origin.

    Attributes:
        name: of the curve; empty where there is none.
        error, rate: of the curve, deg and deg/s, shape (n,).
        errors, rates: of straight borders, deg and deg/s, positive.
    """

    name: str = ""
    error: np.ndarray = np.empty(0)
    rate: np.ndarray = np.empty(0)
    errors: tuple[float, ...] = ()
    rates: tuple[float, ...] = ()


def zones_of(gains: Mapping[str, Any], axis: int) -> Zones:
    """Borders of a controller for axis 0 roll, 1 pitch, 2 yaw; none where its gains are not known here."""
    zone = gains.get("roll" if axis == 0 else "pitch_yaw") or (gains.get("bank") if axis == 0 else None)
    try:
        if "deadband_deg" in gains:
            limit = gains["rate_limit_deg_s"]
            rate = np.linspace(-1.1 * limit, limit, 169)
            return Zones(FIRING, firing_error(gains, rate), rate, (gains["deadband_deg"],), (limit,))
        if zone:
            near, far = zone["near_deg"], zone["far_deg"]
            error = np.concatenate([np.linspace(near, far, 60), [far * 1.0001, 180.0]])
            return Zones(AIMED_FOR, error, aimed_rate(zone, error), (near, far), (1.15 * zone["rate_deg_s"],))
    except KeyError:  # other gains under known names: no borders rather than wrong ones
        return Zones()
    found = ([gains[name]] if name in gains else [] for name in ("angle_limit_deg", "rate_deadband_deg_s"))
    return Zones("", np.empty(0), np.empty(0), *map(tuple, found))


def aimed_rate(zone: Mapping[str, Any], error: np.ndarray) -> np.ndarray:
    """Rate (deg/s) that the zones steer for at errors (deg, positive) outside the PID zone.  Source: Hu et
    al. 2022, section 4.1.

    It starts with the rate at which the PID law meets the border, and grows along a parabola of constant
    deceleration.
    """
    inner = zone["proportional"] / max(zone["derivative"], 1e-9) * zone["near_deg"]
    parabola = np.sqrt(inner**2 + 2.0 * zone["deceleration_deg_s2"] * (error - zone["near_deg"]))
    return np.minimum(np.where(error > zone["far_deg"], zone["rate_deg_s"], parabola), zone["rate_deg_s"])


def firing_error(gains: Mapping[str, Any], rate: np.ndarray) -> np.ndarray:
    """Least error (deg) at which the phase-plane law fires towards growing angle, by rate (deg/s).  Source:
    Hu et al. 2022, section 3.
    """
    bend = rate * np.abs(rate) / (2.0 * gains["acceleration_deg_s2"])
    return gains["deadband_deg"] + bend + gains["lead_s"] * rate
