"""Where the parachute opens relative to the point that entry guidance steered to."""

from __future__ import annotations

from math import pi

import numpy as np

from edl6dof.spatial.arrays import interpolate
from edl6dof.spatial.elementary import asin, atan2, cos, sin
from edl6dof.spatial.frames import great_circle
from edl6dof.telemetry.columns import Telemetry


def deployment_figures(
    telemetry: Telemetry, mortar_fire_s: float, aim_point: tuple[float, float], radius_m: float
) -> dict[str, float]:
    """Miss of the aim point (latitude and longitude, rad) at mortar fire, m on a sphere of ``radius_m``.

    Downrange is positive beyond the aim point and crossrange positive right of it, both relative to the great
    circle on which the flight began towards it.
    """
    first, near = telemetry.rows(0, 1), telemetry.beside(mortar_fire_s)
    start, here = _place(first, float(first["t_s"][0])), _place(near, mortar_fire_s)
    arc, azimuth = _arc(start, here)
    goal, along = _arc(start, aim_point)
    turn = azimuth - along
    return {
        "parachute_miss_m": radius_m * _arc(here, aim_point)[0],
        "parachute_downrange_m": radius_m * (atan2(sin(arc) * cos(turn), cos(arc)) - goal),
        "parachute_crossrange_m": radius_m * asin(sin(arc) * sin(turn)),
    }


def _place(rows: Telemetry, t: float) -> tuple[float, float]:
    """Latitude and longitude, rad, at time ``t`` (s) on the straight lines between one or two rows."""
    latitude, longitude = (np.radians(rows[f"truth.{axis}_deg"]) for axis in ("latitude", "longitude"))
    without_jump = np.unwrap(longitude) if np.ptp(longitude) > pi else longitude
    return float(interpolate(t, rows["t_s"], latitude)), float(interpolate(t, rows["t_s"], without_jump))


def _arc(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return great_circle(sin(a[0]), cos(a[0]), a[1], sin(b[0]), cos(b[0]), b[1])
