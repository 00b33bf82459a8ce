"""Flight of the plant from one time to another, cut at every event.

Scheduled events (pyrotechnics with their delays) split the step at their time.  Events of the state happen
when a function of the state and its outputs, positive until then, falls to zero; they are found by repeating
the step with a shorter length until the first of their functions is zero to 1e-9 s.  A new event is a
function, an action that disarms it, and a line in :func:`until_event` and :func:`carry_out_state_events`.  A
step is cut, never rounded; thruster impulse stays exact because valve levels are integrated in closed form
over whatever length the step has.  While a canopy is out, and from the first contact with the ground on,
steps are shorter (``simulation.canopy_step_s`` and ``contact_step_s``).
"""

from __future__ import annotations

from math import isnan

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import put3, take3
from edl6dof.vehicle.landing_gear import minimum_clearance, normal_of
from edl6dof.vehicle.motion.balance import bodies, book, settle
from edl6dof.vehicle.motion.runge_kutta import NEAR_GROUND, evaluate, step
from edl6dof.vehicle.motion.staging import carry_out
from edl6dof.vehicle.parachutes.parachute import BY_STRETCH, EXTRACTING, INFLATING, SLACK, TAUT
from edl6dof.vehicle.plant import PROPELLANT, STATES, take_attitude
from edl6dof.vehicle.surroundings import planet_rotation

TIME_TOLERANCE = 1e-9
#: After so many events of the state in one cycle, changes of the riser are not located: a riser at the edge
#: between taut and slack does not hang the flight.
MOST_EVENTS = 20
#: Value of an event function while its event cannot happen.
NOT_ARMED = 1e99


@kernel
def until_riser_changes(plant, outputs):
    """Length (m) by which lines and riser can move before a slack riser becomes taut or a taut one slack."""
    if plant.canopy == EXTRACTING or (plant.canopy == INFLATING and plant.inputs.riser == SLACK):
        return -outputs.riser_margin
    if plant.canopy == INFLATING and plant.inputs.riser == TAUT:
        return outputs.riser_margin
    return NOT_ARMED


@kernel
def change_riser(plant):
    """When the riser is taut for the first time, line stretch, the canopy begins to fill."""
    if plant.canopy == EXTRACTING:
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
    """Note the time at which tanks have run empty; engines and thrusters that they alone feed go out."""
    for k in range(case.vehicle.n_tanks):
        if still_to_empty(case, plant, k) and plant.y[PROPELLANT + k] <= 0.0:
            plant.exhausted_time[k] = plant.t
            plant.y[PROPELLANT + k] = 0.0


@kernel
def until_event(case, plant, outputs):
    """Smallest of the event functions: positive until the first event."""
    least = min(NOT_ARMED, least_propellant(case, plant, outputs))
    least = min(least, until_riser_changes(plant, outputs))
    return min(least, clearance(case, plant, outputs))


@kernel
def carry_out_state_events(case, plant, outputs):
    """Carry out every event of the state that has occurred, simultaneous ones in this order."""
    if least_propellant(case, plant, outputs) <= 0.0:
        run_dry(case, plant)
    if until_riser_changes(plant, outputs) <= 0.0:
        change_riser(plant)
    if clearance(case, plant, outputs) <= 0.0:
        touch_down(case, plant)


@kernel
def next_scheduled(case, plant, t_end):
    """Index and time of the next scheduled event up to ``t_end``; -1 and ``t_end`` when there is none."""
    event, due = -1, t_end
    for i in range(case.events.n_events):
        if plant.due[i] <= due:
            event, due = i, plant.due[i]
    return event, due


@kernel
def remember_start(case, plant, work):
    """Save the quantities that a step changes outside the integrated state."""
    for i in range(work.level0.shape[0]):
        work.level0[i] = plant.valves.level[i]
    for k in range(case.branches.count):
        work.branch_used0[k] = plant.branch_used[k]
    put3(work.velocity_gain0, 0, take3(plant.velocity_gain, 0))


@kernel
def restart(case, tables, plant, outputs, work):
    """Return to the start of the step."""
    for i in range(STATES):
        plant.y[i] = work.y0[i]
    for i in range(work.level0.shape[0]):
        plant.valves.level[i] = work.level0[i]
    for k in range(case.branches.count):
        plant.branch_used[k] = work.branch_used0[k]
    put3(plant.velocity_gain, 0, take3(work.velocity_gain0, 0))
    plant.t = work.t0
    evaluate(case, tables, plant, outputs, work)


@kernel
def step_to_event(case, tables, plant, outputs, work, t_end):
    """Step to ``t_end`` (s), or to the first earlier event that depends on the state; return whether such an
    event has occurred, and whether the step succeeded.

    The time of the event is found by false position, with a bisection in every third iteration so that both
    ends of the bracket move. The step ends at the end of the bracket at which the event has occurred.
    """
    remember_start(case, plant, work)
    if not step(case, tables, plant, outputs, work, t_end=t_end):
        return False, False
    f_high = until_event(case, plant, outputs)
    if not f_high <= 0.0:
        return False, True
    restart(case, tables, plant, outputs, work)
    f_low = until_event(case, plant, outputs)
    low, high = plant.t, t_end
    passes = 0
    while high - low > TIME_TOLERANCE:
        share = 0.5 if passes % 3 == 2 else min(max(f_low / (f_low - f_high), 0.02), 0.98)
        passes += 1
        trial = low + share * (high - low)
        restart(case, tables, plant, outputs, work)
        if not step(case, tables, plant, outputs, work, t_end=trial):
            return False, False
        value = until_event(case, plant, outputs)
        if value > 0.0:
            low, f_low = trial, value
        else:
            high, f_high = trial, value
    if plant.t != high:
        restart(case, tables, plant, outputs, work)
        step(case, tables, plant, outputs, work, t_end=high)
    return True, True


@kernel
def next_stop(case, plant, due):
    """End (s) of the next step towards ``due`` (s); shorter with a canopy out or on the ground."""
    longest = due - plant.t
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        longest = min(longest, case.simulation.canopy_step)
    if plant.touched != 0:
        longest = min(longest, case.simulation.contact_step)
    left, parts = due - plant.t, 1.0
    while left > parts * longest * (1.0 + 1e-6):
        parts += 1.0
    return plant.t + left / parts if parts > 1.0 else due


@kernel
def advance(case, tables, plant, outputs, work, t_end):
    """Fly from ``plant.t`` to ``t_end`` (s), events included; False after a step that failed.  ``outputs``
    belong to the present state, before and after.
    """
    events = 0
    while True:
        event, due = next_scheduled(case, plant, t_end)
        if due - plant.t > TIME_TOLERANCE:
            stop = next_stop(case, plant, due)
            if events < MOST_EVENTS:
                plant.inputs.riser = TAUT if outputs.riser_margin > 0.0 else SLACK
            come, succeeded = step_to_event(case, tables, plant, outputs, work, t_end=stop)
            if not succeeded:
                return False
            book(plant, work)
            if come:
                events += 1
                carry_out_state_events(case, plant, outputs)
            plant.inputs.riser = BY_STRETCH
            if come:
                evaluate(case, tables, plant, outputs, work)
            if come or stop < due:
                continue
        if plant.t != due or event >= 0:
            plant.t = due
            if event >= 0:
                plant.due[event] = 1e99
                plant.done[event] = due
                before = bodies(case, plant)
                carry_out(case, plant, event)
                settle(case, plant, outputs, before)
            evaluate(case, tables, plant, outputs, work)
        if event < 0:
            return True
