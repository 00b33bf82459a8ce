"""Events of the state: what happens when a function of the state falls to zero, found inside the step.

An event function is positive until its event; the event is its first value that is not.  It is a pure
function of the state and its outputs.  A new event is a function, an action, and a line in ``STATE_EVENTS``.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import Any, NamedTuple

from edl6dof.kernels import kernel
from edl6dof.kernels.functions import choice
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, norm, sub, take3
from edl6dof.vehicle.motion.ground_contact import minimum_clearance, normal_of
from edl6dof.vehicle.motion.runge_kutta import NEAR_GROUND, take_attitude
from edl6dof.vehicle.parachutes.bridle import confluence
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import CANOPY_POSITION, POSITION, PROPELLANT, STATES
from edl6dof.vehicle.surroundings import planet_rotation

#: Value of an event function while its event cannot happen.
NOT_ARMED = 1e99


class StateEvent(NamedTuple):
    """One event of the state.

    Attributes:
        name: what happens.
        value: kernel ``(case, plant, outputs) -> float``: positive before the event, at or below zero from it
            on, ``NOT_ARMED`` while it cannot happen.
        action: kernel ``(case, plant)`` that carries the event out at ``plant.t``, and so disarms it.
    """

    name: str
    value: Callable[..., Any]
    action: Callable[..., Any]


@kernel
def slack(case, plant, outputs):
    """Length of line still to be paid out before line stretch, m."""
    if plant.canopy != EXTRACTING:
        return NOT_ARMED
    chute = case.vehicle.parachutes[plant.parachute]
    centre, q = take3(outputs.centre, 0), take_attitude(plant.y)
    r_I, canopy = take3(plant.y, POSITION), take3(plant.y, CANOPY_POSITION)
    arm = sub(confluence(chute, add(centre, to_frame(q, sub(canopy, r_I)))), centre)
    return chute.line_length - norm(sub(canopy, add(r_I, from_frame(q, arm))))


@kernel
def stretch(case, plant):
    """Line stretch: the canopy begins to fill."""
    plant.canopy = INFLATING
    plant.line_stretch_time[plant.parachute] = plant.t


@kernel
def clearance(case, plant, outputs):
    """Distance along the ground's normal from the nearest point of the landing gear (without legs: the nose)
    to the ground, m; far above it, of the centre of mass and straight down.
    """
    if plant.touched != 0:
        return NOT_ARMED
    out, inputs = outputs, plant.inputs
    height = out.altitude - inputs.ground_altitude
    if height >= NEAR_GROUND:
        return height
    place = (out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon)
    q, rotation, centre = take_attitude(plant.y), planet_rotation(case.planet, plant.t), take3(out.centre, 0)
    if plant.legs != 0:
        return minimum_clearance(case, inputs, centre, q, rotation, place=place, altitude=out.altitude)
    up, inverse = normal_of(place, q, rotation, inputs.ground_slope[0], inputs.ground_slope[1])
    return height * inverse - (centre[0] * up[0] + centre[1] * up[1] + centre[2] * up[2])


@kernel
def touch_down(case, plant):
    """First contact with the ground: from now on it carries the vehicle."""
    plant.touched = 1
    plant.touchdown_time = plant.t
    for i in range(STATES):
        plant.touchdown[i] = plant.y[i]


@kernel
def still_to_empty(case, plant, tank):
    """True if a tank was loaded and has not run empty."""
    return case.vehicle.tanks[tank].mass > 0.0 and isnan(plant.exhausted_time[tank])


@kernel
def least_propellant(case, plant, outputs):
    """Least propellant left in a tank that has not run empty, kg."""
    least = NOT_ARMED
    for k in range(case.vehicle.n_tanks):
        if still_to_empty(case, plant, k):
            least = min(least, plant.y[PROPELLANT + k])
    return least


@kernel
def run_dry(case, plant):
    """Tanks are empty: what none but they feed goes out."""
    for k in range(case.vehicle.n_tanks):
        if still_to_empty(case, plant, k) and plant.y[PROPELLANT + k] <= 0.0:
            plant.exhausted_time[k] = plant.t
            plant.y[PROPELLANT + k] = 0.0


#: In the order in which those of one moment are carried out.
STATE_EVENTS = (
    StateEvent("tank empty", least_propellant, run_dry),
    StateEvent("line stretch", slack, stretch),
    StateEvent("touchdown", clearance, touch_down),
)

_COUNT = len(STATE_EVENTS)
_OF_VALUE, _OF_ACTION = ("case", "plant", "outputs"), ("case", "plant")
_VALUES = {i: event.value for i, event in enumerate(STATE_EVENTS)}
_ACTIONS = {i: event.action for i, event in enumerate(STATE_EVENTS)}
_value = choice("value_of_event", _VALUES, _OF_VALUE, dict.fromkeys(_VALUES, _OF_VALUE))
_carry_out = choice("carry_out", _ACTIONS, _OF_ACTION, dict.fromkeys(_ACTIONS, _OF_ACTION))


@kernel
def until_event(case, plant, outputs):
    """Smallest of the event functions: positive until the first event, whichever it is."""
    least = NOT_ARMED
    for event in range(_COUNT):
        least = min(least, _value(event, case, plant, outputs))
    return least


@kernel
def carry_out_state_events(case, plant, outputs):
    """Carry out every event of the state that has come."""
    for event in range(_COUNT):
        if _value(event, case, plant, outputs) <= 0.0:
            _carry_out(event, case, plant)
