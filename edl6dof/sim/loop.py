"""The loop: plant, sensors, flight software, actuators, plant again."""

from __future__ import annotations

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.sensors.registry import sense
from edl6dof.sim.outcome import FLYING, NOT_FINITE, outcome_of, works_with_finite
from edl6dof.telemetry.sample import record, record_brief
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.landing_gear import note_motion
from edl6dof.vehicle.mass import compose
from edl6dof.vehicle.motion.balance import open_balance, update_peaks
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate, retrace, survey, undo
from edl6dof.vehicle.motion.staging import step_debris


@kernel
def prepare(cases, plants):
    """Set the mass properties of a plant from its attached parts, and begin its balance."""
    case, plant = cases[0], plants[0]
    compose(case, plant)
    open_balance(case, plant)


@kernel
def take_up(cases, plants, memories):
    """Work out again the quantities of a saved flight that follow from parameters, which may have changed."""
    case, plant = cases[0], plants[0]
    dry = plant.dry.mass
    compose(case, plant)
    plant.balance.mass += plant.dry.mass - dry
    memories[0].effectiveness.of = 0


@kernel
def look(cases, tables_, plants, outputs_, works):
    """Update the outputs to the present state: a step leaves them at its last stage."""
    case, tables, plant, outputs = cases[0], tables_[0], plants[0], outputs_[0]
    evaluate(case, tables, plant, outputs, works[0])
    survey(case, tables, plant, outputs)


@kernel
def write_row(case, plant, outputs, sensed, fsw, log, brief, row):
    """Write the present state to row ``row`` of ``log`` or ``brief``, of which one or both are empty."""
    if len(log) > 0:
        record(case, plant, outputs, sensed, fsw, tick=log[row])
    elif len(brief) > 0:
        record_brief(case, plant, outputs, fsw, brief[row])


@kernel
def fly(
    functions, cases, onboards, tables_, plants, outputs_, peaks_, works, sensors_, memories,
    first, last, current, steps, log, brief, log_first,
):  # fmt: skip
    """Fly base cycles ``first .. last - 1``; returns (outcome code, cycles flown, rows logged).

    All arguments but ``functions`` (:mod:`edl6dof.sim.functions`) and the counters are record arrays of
    length one, except ``log`` and ``brief``, of which one is empty and the other has a row for each
    logged cycle; with both empty nothing is logged.  Cycle ``k`` starts at ``k / base rate``; a row is logged
    every ``simulation.log_every`` cycles, and the last state always.  A step that fails is undone: the last
    state is the one before it.  ``current``: whether the outputs are those of the present state, as a call
    leaves them; else they are evaluated first.
    """
    run, software, measure, kinds = functions
    case, onboard, tables, plant = cases[0], onboards[0], tables_[0], plants[0]
    outputs, peaks, work = outputs_[0], peaks_[0], works[0]
    sensors, fsw = sensors_[0], memories[0]
    measured, memory = sensors_.view(np.uint64), memories.view(np.uint64)
    cycle = 1.0 / onboard.rates.base
    rows = 0
    if current == 0:
        evaluate(case, tables, plant, outputs, work)
    for k in range(first, last):
        t = k * cycle
        survey(case, tables, plant, outputs)
        sense(measure, case, tables, plant, outputs, sensors=sensors)
        run(software, onboard, sensors.sensed, k, fsw)
        outcome = NOT_FINITE
        if works_with_finite(measured, memory):
            actuate(kinds, case, fsw.command, plant)
            update_peaks(plant, outputs, peaks)
            note_motion(case, plant)
            outcome = outcome_of(case, plant, outputs)
        logged = k % case.simulation.log_every == 0 or outcome != FLYING
        if logged:
            write_row(case, plant, outputs, sensors.sensed, fsw, log=log, brief=brief, row=log_first + rows)
            rows += 1
        if outcome != FLYING:
            return outcome, k - first, rows
        for j in range(steps):
            if not advance(case, tables, plant, outputs, work, t_end=t + cycle * (j + 1) / steps):
                undo(plant, work)
                if plant.t > t or not logged:
                    evaluate(case, tables, plant, outputs, work)
                    survey(case, tables, plant, outputs)
                    write_row(
                        case, plant, outputs, sensors.sensed, fsw, log=log, brief=brief, row=log_first + rows
                    )
                    rows += 1
                retrace(case, tables, plant, outputs, work)
                return NOT_FINITE, k - first, rows
        step_debris(case, tables, plant, t, cycle)
    return FLYING, last - first, rows


@kernel
def fly_each(
    functions, cases, onboards, tables_, plants, outputs_, peaks_, works, sensors_, memories,
    cycles, outcomes, current, count, steps, log, brief,
):  # fmt: skip
    """Fly ``count`` base cycles of each of several flights that still fly, as :func:`fly` does one.

    All record arrays have an element for each flight, but ``tables_``, which they share, and ``log`` and
    ``brief``, which are empty.  ``cycles``, the base cycle that each is at, ``outcomes``, its outcome code,
    and ``current`` are updated.
    """
    for i in range(len(plants)):
        if outcomes[i] == FLYING:
            outcomes[i], flown, _ = fly(
                functions=functions,
                cases=cases[i : i + 1], onboards=onboards[i : i + 1], tables_=tables_,
                plants=plants[i : i + 1], outputs_=outputs_[i : i + 1], peaks_=peaks_[i : i + 1],
                works=works[i : i + 1], sensors_=sensors_[i : i + 1], memories=memories[i : i + 1],
                first=cycles[i], last=cycles[i] + count, current=current[i], steps=steps, log=log,
                brief=brief, log_first=0,
            )  # fmt: skip
            cycles[i] += flown
            current[i] = 1
