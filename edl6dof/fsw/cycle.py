"""One base cycle of the flight software: navigation, mission phase, guidance, attitude control, allocation,
pulse modulation.
"""

from __future__ import annotations

from edl6dof.fsw.allocation.registry import allocate
from edl6dof.fsw.allocation.wrench import keep_effects
from edl6dof.fsw.check_out import check_out
from edl6dof.fsw.control.registry import attitude_control
from edl6dof.fsw.diagnosis.diagnose import diagnose, restart
from edl6dof.fsw.diagnosis.exercise import exercise
from edl6dof.fsw.estimation.activity import remember
from edl6dof.fsw.estimation.observe import observe
from edl6dof.fsw.guidance.entry.geometry import to_target
from edl6dof.fsw.guidance.entry.registry import entry_guidance
from edl6dof.fsw.guidance.powered.registry import powered_guidance
from edl6dof.fsw.guidance.powered.terminal import avoid, command_thrust, descend, hover, start_or_throttle
from edl6dof.fsw.mission.deployments import note_requests, share_thrust
from edl6dof.fsw.mission.phases import G_AVOID, G_DESCEND, G_ENTRY, G_HOLD_BANK, G_HOVER, G_POWERED
from edl6dof.fsw.mission.sequencer import sequence
from edl6dof.fsw.modulation import modulate
from edl6dof.fsw.navigation import navigate
from edl6dof.interface.engine import ENGINE_FULL, ENGINE_OFF
from edl6dof.interface.thrusters import ATTITUDE, AXIAL
from edl6dof.jit import kernel

G0 = 9.80665


@kernel
def keep_mass(onboard, dt, fsw):
    """Estimate of the mass by counting commanded engine and thruster impulse."""
    used = 0.0
    if fsw.ignited != 0:
        used = fsw.guide.thrust / onboard.vehicle.engine.specific_impulse
    for i in range(onboard.vehicle.n_thrusters):
        on = fsw.command.closes[i] - fsw.command.opens[i]
        if on > 0.0:
            jet = onboard.vehicle.thrusters[i]
            used += jet.thrust * on / (dt * onboard.rates.control_every) / jet.specific_impulse
    fsw.mass -= used * dt / G0


@kernel
def guide_vehicle(onboard, kind, k, entered, fsw):
    """Run the guidance of the present phase when its division of the base cycle comes up, and at once in a
    new phase.
    """
    nav, guide = fsw.nav, fsw.guide
    rates = onboard.rates
    entry = onboard.guidance.entry
    if kind == G_HOLD_BANK or kind == G_ENTRY:
        if entered or k % rates.entry_guidance_every == 0:
            guide.alpha = entry.trim_alpha
            if kind == G_HOLD_BANK:
                guide.range_to_go, guide.crossrange = to_target(onboard, nav)
                if nav.t <= 0.0:
                    guide.bank = entry.preset_bank if guide.crossrange <= 0.0 else -entry.preset_bank
            else:
                entry_guidance(entry.law, onboard, nav, fsw.entry, guide)
        return
    if not entered and k % rates.powered_guidance_every != 0:
        return
    if kind == G_POWERED:
        north, east, up, tilt_limit = powered_guidance(
            onboard.guidance.powered.law, onboard, nav, fsw.powered, guide
        )
        command_thrust(onboard, fsw.mass, (north, east, up), tilt_limit, guide)
        if fsw.ignited != 0:
            start_or_throttle(onboard, guide, nav.t - fsw.ignition_time)
    elif kind == G_HOVER:
        hover(onboard, nav, fsw.mass, guide)
    elif kind == G_AVOID:
        avoid(onboard, nav, fsw.mass, fsw.terminal, guide)
    elif kind == G_DESCEND:
        descend(onboard, nav, fsw.mass, guide)


@kernel
def look_for_faults(onboard, dt, fsw):
    """Diagnose the thrusters from what the commands did not explain in the last control cycle."""
    seen = fsw.disturbance.seen
    load = abs(seen[0] + fsw.guide.thrust) if fsw.ignited != 0 else abs(seen[0])
    effect, healthy, isolate = fsw.allocator.effect, fsw.healthy, fsw.command.isolate
    count, t = onboard.vehicle.n_thrusters, fsw.nav.t
    diagnose(
        onboard.diagnosis, count, effect, fsw.activity, load, seen, t, dt, fsw.diagnosis, healthy, isolate
    )


@kernel
def test_thrusters(onboard, dt, fsw):
    """Add an opposed pulse of two resting thrusters to the valve intervals of this control cycle."""
    found, command = fsw.diagnosis, fsw.command
    thrusters, count, effect = onboard.vehicle.thrusters, onboard.vehicle.n_thrusters, fsw.allocator.effect
    exercise(
        onboard.diagnosis.exercise,
        thrusters,
        count,
        effect,
        fsw.healthy,
        found.hypotheses,
        fsw.modulator,
        command.opens,
        command.closes,
        fsw.nav.t,
        dt,
        found.exercise,
    )


@kernel
def usable_groups(phase, boosting, thrusters, count, healthy):
    """Bit mask of the thruster groups that may fire: those of the phase; the axial ones to help the engine or
    for a lost attitude one.
    """
    allowed = 1 << AXIAL if boosting else 0
    for i in range(phase.n_thrusters):
        allowed |= 1 << phase.thrusters[i]
    for i in range(count):
        if thrusters[i].group == ATTITUDE and healthy[i] == 0:
            allowed |= 1 << AXIAL
    return allowed


@kernel
def steer(onboard, phase, dt, fsw):
    """Attitude control, allocation over the allowed thrusters, and pulse modulation for one control cycle."""
    nav, guide = fsw.nav, fsw.guide
    vehicle = onboard.vehicle
    count = vehicle.n_thrusters
    for i in range(6):
        fsw.demand[i] = 0.0
    keep_effects(vehicle, fsw.configuration, fsw.allocator)
    observe(onboard, dt, fsw)
    look_for_faults(onboard, dt, fsw)
    if check_out(onboard, dt, fsw):
        remember(fsw.command.opens, fsw.command.closes, count, fsw.activity)
        return
    attitude_control(phase.control, onboard, nav, guide, dt, fsw)
    duty = fsw.allocator.duty
    boosting = guide.engine_mode == ENGINE_FULL and fsw.ignited != 0
    wanted = 0.0
    for i in range(6):
        wanted += abs(fsw.demand[i])
    if boosting:
        # the axial thrusters help the engine as far as the torque allows
        for i in range(count):
            if vehicle.thrusters[i].group == AXIAL:
                fsw.demand[0] += fsw.allocator.effect[i, 0]
    if wanted > 0.0 or boosting:
        allowed = usable_groups(phase, boosting, vehicle.thrusters, count, fsw.healthy)
        translating = guide.translating != 0
        p, work = onboard.allocation, fsw.allocator
        allocate(
            p.method,
            p,
            vehicle.thrusters,
            count,
            fsw.healthy,
            allowed,
            translating,
            boosting,
            fsw.demand,
            work,
        )
    else:
        for i in range(count):
            duty[i] = 0.0
        for i in range(6):
            fsw.allocator.undelivered[i] = 0.0
    fsw.saturated = 0
    for i in range(3, 6):
        if abs(fsw.allocator.undelivered[i]) > 0.2 * onboard.allocation.torque_scale:
            fsw.saturated = 1
    modulate(
        onboard.modulation,
        vehicle.thrusters,
        count,
        duty,
        nav.t,
        dt,
        fsw.modulator,
        fsw.command.opens,
        fsw.command.closes,
    )
    if guide.translating != 0:
        test_thrusters(onboard, dt, fsw)
    remember(fsw.command.opens, fsw.command.closes, count, fsw.activity)


@kernel
def run(onboard, sensed, k, fsw):
    """Base cycle number ``k``: from ``sensed`` to ``fsw.command``."""
    command = fsw.command
    for i in range(command.request.shape[0]):
        command.request[i] = 0
    navigate(onboard, sensed, fsw.nav)
    mission = onboard.mission
    if mission.n_phases == 0:
        return
    before = fsw.phase
    sequence(mission, fsw.nav, fsw.guide, fsw, command.request)
    note_requests(onboard, fsw.nav, fsw)
    for i in range(command.request.shape[0]):
        if command.request[i] != 0:
            restart(fsw.diagnosis)
    phase = mission.phases[fsw.phase]
    command.phase = fsw.phase
    if fsw.phase != before:
        fsw.guide.translating = 0
    dt = 1.0 / onboard.rates.base
    keep_mass(onboard, dt, fsw)
    guide_vehicle(onboard, phase.guidance, k, fsw.phase != before, fsw)
    if k % onboard.rates.control_every == 0:
        steer(onboard, phase, dt * onboard.rates.control_every, fsw)
    command.steering, command.bank = 1, fsw.guide.bank
    command.alpha = 0.0 if fsw.wing_out != 0 else fsw.guide.alpha
    share_thrust(onboard.vehicle.engine, fsw)
    command.engine_mode = fsw.guide.engine_mode if fsw.ignited != 0 else ENGINE_OFF
