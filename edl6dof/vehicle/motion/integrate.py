"""Flight of the plant from one time to another, cut at every event.

Scheduled events (pyrotechnics with their delays) split the step at their time.  Events of the state
(:mod:`edl6dof.vehicle.motion.state_events`) are found by repeating the step with a shorter length until the
first of their functions is zero to 1e-9 s.  A step is cut, never rounded; thruster impulse stays exact
because valve levels are integrated in closed form over whatever length the step has.  While a canopy is out,
and from the first contact with the ground on, steps are shorter (``simulation.canopy_step_s`` and
``contact_step_s``).
"""

from __future__ import annotations

from edl6dof.jit import kernel
from edl6dof.spatial.vector import put3, take3
from edl6dof.vehicle.motion.balance import bodies, book, settle
from edl6dof.vehicle.motion.runge_kutta import evaluate, step
from edl6dof.vehicle.motion.staging import carry_out
from edl6dof.vehicle.motion.state_events import carry_out_state_events, until_event
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import STATES

TIME_TOLERANCE = 1e-9


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
    """Keep what a step changes and the integrator does not keep itself."""
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
    """Step to ``t_end`` (s), or to the first event of the state before it; returns whether one has come, and
    whether the step succeeded.

    The root is found by false position, with bisection every third pass against a one-sided stall; the step
    ends at the side of the bracket where the event has come.
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
    """Where the next step is to end that leads towards ``due`` (s): there, or at the end of the first of
    equal parts where a canopy or the ground asks for shorter steps.
    """
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
    """Fly from ``plant.t`` to ``t_end`` (s), carrying out every scheduled or located event on the way; False
    after a step that failed.

    ``outputs`` belong to the present state, before and after.
    """
    while True:
        event, due = next_scheduled(case, plant, t_end)
        if due - plant.t > TIME_TOLERANCE:
            stop = next_stop(case, plant, due)
            come, succeeded = step_to_event(case, tables, plant, outputs, work, t_end=stop)
            if not succeeded:
                return False
            book(plant, work)
            if come:
                carry_out_state_events(case, plant, outputs)
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
