"""How a flight ends: always with a named cause; and the check in every cycle that all quantities of the
flight computer are finite, with the search for the first one that is not.

Comparisons with NaN are false: no trigger fires and no limit is exceeded, so only this check ends such a
flight.
"""

from __future__ import annotations

from math import isfinite, sqrt

import numpy as np

from edl6dof.fsw.onboard import FSW
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.records import finite_words, first_not_finite, offset
from edl6dof.sensors.registry import SENSORS
from edl6dof.spatial.elementary import acos
from edl6dof.spatial.vector import clamp, norm, take3
from edl6dof.vehicle.landing_gear import ground_speed
from edl6dof.vehicle.motion.body import tilt
from edl6dof.vehicle.parachutes.parachute import PACKED
from edl6dof.vehicle.plant import RATE, STATE_NAMES, take_attitude

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
    """True if an event that ends the flight has happened."""
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
    """Outcome code of the present state, which must be finite; ``outputs`` belong to this state."""
    limits, out, y = case.limits, outputs, plant.y
    t = plant.t
    if at_last_event(case, plant):
        return LAST_EVENT
    if plant.touched != 0:
        if plant.legs == 0 or ground_speed(case.planet.rotation_rate, plant.touchdown) > limits.crash_speed:
            return CRASHED
        q = take_attitude(y)
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
        q = take_attitude(y)
        if tilt(case, t, q, out) > limits.powered_tilt:
            return LOST_ATTITUDE
    if out.altitude > case.initial.altitude + limits.skip_out:
        return SKIPPED_OUT
    if t >= case.simulation.time_limit - 1e-9:
        return TIME_LIMIT
    return FLYING


#: Exponent bits of a number that is infinite or NaN, the lowest of them, and the sign bit.
_EXPONENT, _LOWEST, _SIGN = (
    np.uint64(0x7FF0_0000_0000_0000),
    np.uint64(0x0010_0000_0000_0000),
    np.uint64(0x8000_0000_0000_0000),
)


#: Fields of the state that follow from the outputs.
_FROM_OUTPUTS = ("inputs", "balance")
#: Quantities checked in every cycle: whatever is not finite in the vehicle shows in its sensors or in its
#: state, and whatever is not finite in the memory of the flight computer shows in the results of guidance,
#: control and modulation.  Images are always finite: an imager without ground in view reads 0.
_SENSED = tuple(finite_words(SENSED, offset(SENSORS, "sensed")))
_WORKED_OUT = tuple(
    run
    for name in ("mission", "vehicle", "nav", "guide", "disturbance", "demand", "command")
    for run in finite_words(FSW[name], offset(FSW, name))
)


@kernel
def _gather(words, runs, wrong):
    """Set the top bit of ``wrong`` if a word has all bits of the exponent set: the lowest one carries."""
    for first, end in runs:
        for i in range(first, end):
            wrong |= (words[i] & _EXPONENT) + _LOWEST
    return wrong


@kernel
def works_with_finite(sensors, memory):
    """True if the outputs of sensors and flight software are finite; both given as ``uint64`` words."""
    return _gather(memory, _WORKED_OUT, _gather(sensors, _SENSED, _LOWEST)) < _SIGN


def first_cause(
    plant: np.ndarray, outputs: np.ndarray, work: np.ndarray, sensors: np.ndarray, fsw: np.ndarray
) -> str | None:
    """Return the name of the first quantity that is not finite, in the order of computation; ``None`` if all
    are finite. All records have shape (1,); ``work`` contains the stage in which a step failed.
    """
    own = [name for name in plant.dtype.names or () if name not in _FROM_OUTPUTS]
    steps = (("plant", plant[own]), ("stage", work["stage"]), ("outputs", outputs), ("k", work["k"]))
    under_way = [name for name in sensors.dtype.names or () if name != "sensed"]
    readings = (("sensors", sensors[under_way]), ("sensors", sensors))
    for name, record in (*steps, ("plant", plant), *readings, ("fsw", fsw)):
        if path := first_not_finite(record):
            return _plain_name(name, path)
    return None


def _plain_name(record: str, path: str) -> str:
    """``velocity x (I)`` for a state, ``rate of velocity x (I)`` for a derivative, ``sensed.t``,
    ``fsw.guide.bank`` for anything else.
    """
    field, _, index = path.partition("[")
    if (record, field) == ("plant", "y") or record in ("stage", "k"):
        state = STATE_NAMES[int(index.rstrip("]").split(",")[-1])]
        return f"rate of {state}" if record == "k" else state
    return f"{record}.{path}".removeprefix("sensors.")
