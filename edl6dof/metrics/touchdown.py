"""The state at first ground contact, from the located event and not from a row of telemetry."""

from __future__ import annotations

from math import isfinite

import numpy as np

from edl6dof.fsw.control.attitude_error import decoupled_error, goal_attitude
from edl6dof.kernels import kernel
from edl6dof.metrics.figures import from_si
from edl6dof.spatial.elementary import acos, atan2, cos, hypot, sin
from edl6dof.spatial.frames import fixed_to_ned, geodetic, ned_to_fixed, rotate_z, to_local
from edl6dof.spatial.quaternion import axes
from edl6dof.spatial.vector import clamp, dot, norm, take3
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY


def touchdown_state(cases: np.ndarray, plants: np.ndarray) -> dict[str, float]:
    """Velocity, attitude errors, rates and place at first contact; empty when there was none.

    Attitude errors are those of S1: roll to the local geographic frame (y of B south), pitch and yaw of the
    thrust axis from the vertical, as a rotation vector in B.

    Args:
        cases: the truth of the flight, shape (1,).
        plants: its plant, shape (1,).
    """
    if not isfinite(plants["touchdown_time"][0]):
        return {}
    return from_si("contact", _contact(cases, plants))


@kernel
def _contact(cases, plants):
    """The figures of contact in their order, SI."""
    case, plant = cases[0], plants[0]
    t, y, planet = plant.touchdown_time, plant.touchdown, case.planet
    spin = planet.rotation_rate
    c, s = cos(spin * t), sin(spin * t)
    r, v, w = take3(y, POSITION), take3(y, VELOCITY), take3(y, RATE)
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    r_F = rotate_z(c, s, r)
    sl, cl, so, co, _ = geodetic(planet.equatorial_radius, planet.flattening, r_F)
    north, east, down = fixed_to_ned(
        sl, cl, so, co, rotate_z(c, s, (v[0] + spin * r[1], v[1] - spin * r[0], v[2]))
    )
    north_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (1.0, 0.0, 0.0)))
    east_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 1.0, 0.0)))
    up_I = rotate_z(c, -s, ned_to_fixed(sl, cl, so, co, (0.0, 0.0, -1.0)))
    error = decoupled_error(q, goal_attitude(north_I, east_I, up_I, up_I))
    forward, _, _ = axes(q)
    site = to_local(case.site, r_F)
    return (
        t, down, hypot(north, east),
        error[0], error[1], error[2], acos(clamp(-dot(forward, up_I), -1.0, 1.0)),
        w[0], w[1], w[2], norm(w),
        atan2(hypot(plant.inputs.ground_slope[0], plant.inputs.ground_slope[1]), 1.0),
        atan2(sl, cl), atan2(so, co),
        site[0], site[1], hypot(site[0], site[1]),
    )  # fmt: skip
