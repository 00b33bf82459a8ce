"""The state at first ground contact, from the located event itself and not from the nearest row of telemetry."""

from __future__ import annotations

from math import atan2, cos, degrees, hypot, sin

import numpy as np

from edl6dof.fsw.control.frames import decoupled_error, goal_attitude
from edl6dof.spatial.frames import (
    fixed_to_enu,
    fixed_to_ned,
    from_geodetic,
    geodetic,
    ned_to_fixed,
    rotate_z,
)
from edl6dof.spatial.quaternion import axes
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY


def touchdown_state(case: np.void, plant: np.void) -> dict[str, float]:
    """Velocity, attitude errors, rates and place at first contact; empty when there was none.

    Attitude errors are those of S1: roll to the local geographic frame (y of B south), pitch and yaw of the thrust axis from the
    vertical, as a rotation vector in B.
    """
    t = float(plant["touchdown_time"])
    if not np.isfinite(t):
        return {}
    y = plant["touchdown"]
    planet, terrain = case["planet"], case["terrain"]
    spin = float(planet["rotation_rate"])
    c, s = cos(spin * t), sin(spin * t)
    r, v = tuple(y[POSITION : POSITION + 3]), tuple(y[VELOCITY : VELOCITY + 3])
    q, w = tuple(y[ATTITUDE : ATTITUDE + 4]), tuple(y[RATE : RATE + 3])
    radius, flattening = float(planet["equatorial_radius"]), float(planet["flattening"])
    r_F = rotate_z(c, s, r)
    sl, cl, so, co, _ = geodetic(radius, flattening, r_F)
    north, east, down = fixed_to_ned(sl, cl, so, co, rotate_z(c, s, (v[0] + spin * r[1], v[1] - spin * r[0], v[2])))
    to_inertial = [rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, axis)) for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, -1.0))]
    north_I, east_I, up_I = (np.array(axis) for axis in to_inertial)
    x_axis, _, _ = (np.array(axis) for axis in axes(q))
    roll, pitch, yaw = decoupled_error(q, goal_attitude(tuple(north_I), tuple(east_I), tuple(up_I), tuple(up_I)))
    lat, lon = float(terrain["site_latitude"]), float(terrain["site_longitude"])
    site = from_geodetic(radius, flattening, lat, lon, float(terrain["site_elevation"]))
    site_east, site_north, _ = fixed_to_enu(site, sin(lat), cos(lat), sin(lon), cos(lon), r_F)
    return {
        "touchdown_s": t,
        "touchdown_vertical_m_s": down,
        "touchdown_horizontal_m_s": hypot(north, east),
        "touchdown_roll_error_deg": degrees(roll),
        "touchdown_pitch_error_deg": degrees(pitch),
        "touchdown_yaw_error_deg": degrees(yaw),
        "touchdown_tilt_deg": degrees(float(np.arccos(np.clip(-x_axis @ up_I, -1.0, 1.0)))),
        "touchdown_roll_rate_deg_s": degrees(w[0]),
        "touchdown_pitch_rate_deg_s": degrees(w[1]),
        "touchdown_yaw_rate_deg_s": degrees(w[2]),
        "touchdown_slope_deg": degrees(atan2(hypot(*plant["ground_slope"]), 1.0)),
        "landing_latitude_deg": degrees(atan2(sl, cl)),
        "landing_longitude_deg": degrees(atan2(so, co)),
        "landing_east_m": site_east,
        "landing_north_m": site_north,
        "landing_distance_m": hypot(site_east, site_north),
    }
