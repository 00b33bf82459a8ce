"""How a flight ends: always with a named cause."""

from __future__ import annotations

from math import isfinite, sqrt

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import acos
from edl6dof.spatial.vector import clamp, norm, take3
from edl6dof.vehicle.motion.body import tilt
from edl6dof.vehicle.motion.ground_contact import ground_speed
from edl6dof.vehicle.parachutes.parachute import PACKED
from edl6dof.vehicle.plant import ATTITUDE, RATE

OUTCOMES = (
    "flying",
    "landed",
    "crashed",
    "tipped over",
    "lost attitude",
    "skipped out",
    "not finite",
    "time limit",
    "at its last event",
)
FLYING, LANDED, CRASHED, TIPPED_OVER, LOST_ATTITUDE, SKIPPED_OUT, NOT_FINITE, TIME_LIMIT, LAST_EVENT = range(
    9
)

#: Dynamic pressure (Pa) below which the angle of attack says nothing about control.
THIN_AIR = 50.0


@kernel
def at_last_event(case, plant):
    """True if an event is done that ends the flight."""
    for i in range(case.events.n_events):  # noqa: SIM110  numba compiles no generators
        if case.ends_with[i] != 0 and isfinite(plant.done[i]):
            return True
    return False


@kernel
def burning(plant):
    """True if an engine is on."""
    count = 0
    for i in range(plant.running.shape[0]):
        count += plant.running[i]
    return count > 0


@kernel
def outcome_of(case, plant, outputs):
    """Outcome code of the present state, all of it finite; ``outputs`` are those of it."""
    limits, out, y = case.limits, outputs, plant.y
    t = plant.t
    if at_last_event(case, plant):
        return LAST_EVENT
    if plant.touched != 0:
        if plant.legs == 0 or ground_speed(case.planet.rotation_rate, plant.touchdown) > limits.crash_speed:
            return CRASHED
        q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
        if tilt(case, t, q, out) > 0.8:
            return TIPPED_OVER
        if t - plant.moved_time >= case.simulation.rest and out.pads > 0:
            return LANDED
        return TIME_LIMIT if t >= case.simulation.time_limit - 1e-9 else FLYING
    if norm(take3(y, RATE)) > limits.body_rate:
        return LOST_ATTITUDE
    if plant.canopy == PACKED and out.dynamic_pressure > THIN_AIR and case.vehicle.aero.model == 0:
        v = take3(out.v_air_B, 0)
        if acos(clamp(v[0] / sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), -1.0, 1.0)) > limits.total_alpha:
            return LOST_ATTITUDE
    if burning(plant):
        q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
        if tilt(case, t, q, out) > limits.powered_tilt:
            return LOST_ATTITUDE
    if out.altitude > case.initial.altitude + limits.skip_out:
        return SKIPPED_OUT
    if t >= case.simulation.time_limit - 1e-9:
        return TIME_LIMIT
    return FLYING
