"""Guidance of the present phase: which law runs, and when."""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.fsw.guidance.entry.registry import ENTRY_MEMORY, entry_guidance
from edl6dof.fsw.guidance.guidance_command import RELAXED, note_relaxed
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.stopping import brake_in_time, descend_on_stuck_throttle
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET, choose_target
from edl6dof.fsw.guidance.powered.terminal_descent import (
    TERMINAL,
    avoid,
    command_thrust,
    descend,
    hover,
    lateral_bias,
    start_or_throttle,
)
from edl6dof.fsw.mission import G_AVOID, G_DESCEND, G_ENTRY, G_HELD_THRUST, G_HOLD_BANK, G_HOVER, G_POWERED
from edl6dof.interface.effectors import CUT_OFF, ENGINE_FULL, ENGINE_OFF, IGNITE
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, put3, scale, take3, take4

GUIDANCE = record(
    ("entry", ENTRY_MEMORY),
    ("target", POWERED_TARGET),
    ("powered", POWERED_LAWS.memory),
    ("at_full_thrust", FLAG),  # braking at full thrust replaces the law
    ("relaxed", RELAXED),
    ("terminal", TERMINAL),
)


@kernel
def switch_engine(mission, request, state, goal):
    """Command full level when an engine is ignited, and no thrust after the last burning one is cut off."""
    for i in range(mission.n_events):
        if request[i] == 0:
            continue
        action = mission.events[i].action
        if action == IGNITE:
            goal.engine_mode = ENGINE_FULL
            goal.thrust = state.engine.full_thrust
        elif action == CUT_OFF and state.ignited == 0:
            goal.engine_mode = ENGINE_OFF
            goal.thrust = 0.0


@kernel
def hold_bank(onboard, nav, goal):
    """Command the preset bank towards the aim point; its side is chosen at the start of the flight, before
    lift acts.
    """
    goal.range_to_go, goal.crossrange, goal.downrange_to_go = to_target(onboard, nav)
    if nav.t <= 0.0:
        bank = onboard.guidance.entry.preset_bank
        goal.bank = bank if goal.crossrange <= 0.0 else -bank


@kernel
def keep_thrust_axis(nav, goal):
    """Keep the present thrust axis until ignition, so that the lander does not turn inside the departing
    backshell.
    """
    q = take4(nav.q_I2B)
    axis = from_frame(q, (-1.0, 0.0, 0.0))
    north, east, up = take3(nav.north_I, 0), take3(nav.east_I, 0), take3(nav.up_I, 0)
    put3(goal.thrust_direction_N, 0, (dot(axis, north), dot(axis, east), -dot(axis, up)))


@kernel
def descend_by_engine(powered_law, onboard, kind, nav, state, disturbance, point, dt, memory, goal):
    """Command thrust, and lateral force where the phase uses it, in a phase on the main engine."""
    p, engine, mass = onboard.guidance.powered, state.engine, state.mass
    if kind == G_POWERED and state.ignited == 0:
        keep_thrust_axis(nav, goal)
    elif kind == G_POWERED:
        choose_target(p.target, nav, point, memory.target)
        goal.full_wanted = goal.relaxed = 0
        wanted = powered_law(
            p.law, p, onboard.vehicle, state, nav, target=memory.target, memory=memory.powered, out=goal
        )
        acceleration, braking = brake_in_time(
            wanted, engine, nav, mass, memory.target, braking=memory.at_full_thrust != 0, out=goal
        )
        memory.at_full_thrust = 1 if braking else 0
        note_relaxed(nav.t, goal, memory.relaxed)
        command_thrust(mass, acceleration, wanted[3], goal)
        elapsed, weak = nav.t - state.ignition_time, state.thrust_lost > 0.0
        start_or_throttle(engine, weak, p.full_time, p.full_again, elapsed, out=goal)
    if kind not in (G_HOVER, G_AVOID, G_DESCEND, G_HELD_THRUST):
        return
    bias = lateral_bias(p.terminal.standing_force, nav, disturbance, dt, memory.terminal.bias)
    if kind == G_HOVER:
        hover(p.terminal, engine, nav, mass, bias, out=goal)
    elif kind == G_AVOID:
        avoid(p.terminal, engine, nav, mass, bias, point=point, memory=memory.terminal, out=goal)
    elif kind == G_HELD_THRUST:
        descend_on_stuck_throttle(p.held_thrust, p.terminal, onboard.vehicle, state, nav, bias=bias, out=goal)
    else:
        descend(p.terminal, engine, nav, mass, bias, point=point, out=goal)


@kernel
def guide(laws, onboard, kind, k, begins, nav, state, disturbance, point, memory, goal, own):
    """Run the guidance of the present phase in its division of the base cycle, and at once where it follows a
    phase with another guidance.

    Args:
        laws: chosen entry law, reversal logic and powered law.
        onboard: ``ONBOARD`` record.
        kind: guidance of the phase, an index of ``GUIDANCE`` in :mod:`edl6dof.fsw.mission`.
        k: number of the base cycle.
        begins: whether this guidance begins in this cycle.
        nav, state: ``NAV`` and ``VEHICLE_STATE`` records.
        disturbance: ``DISTURBANCE`` record, whose force is fed forward.
        point: ``LANDING_POINT`` record: landing point, if chosen.
        memory: ``GUIDANCE`` record, updated.
        goal: ``GUIDE`` record, written.
        own: ``OWN`` record, written: result of guidance before commands from outside replace it.
    """
    entry_law, bank_side, powered_law = laws
    rates = onboard.rates
    goal.spot_chosen = point.fine_known
    if begins:
        goal.translating = 0
    if kind == G_HOLD_BANK or kind == G_ENTRY:
        if begins or k % rates.entry_guidance_every == 0:
            entry = onboard.guidance.entry
            goal.alpha, goal.bank = entry.trim_alpha, own.bank
            if kind == G_HOLD_BANK:
                hold_bank(onboard, nav, goal)
            else:
                entry_guidance(entry_law, bank_side, onboard, nav, memory.entry, out=goal)
            own.bank = goal.bank
    elif begins or k % rates.powered_guidance_every == 0:
        dt = rates.powered_guidance_every / rates.base
        descend_by_engine(
            powered_law,
            onboard,
            kind,
            nav,
            state,
            disturbance=disturbance,
            point=point,
            dt=dt,
            memory=memory,
            goal=goal,
        )
        put3(own.thrust_N, 0, scale(goal.thrust, take3(goal.thrust_direction_N, 0)))
