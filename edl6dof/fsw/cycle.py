"""One base cycle of the flight software, step by step: navigation, mission phases, hazard detection,
guidance, estimation, fault isolation, attitude control, allocation, modulation.  After each step a command
from outside may replace its result.

Only the cycle has access to the memories of all modules. It passes each step its own memory and the other
records in the signature of the step.

Arguments have the same names in all kernels of the flight software: ``onboard`` is the ``ONBOARD`` record,
``vehicle``, ``planet``, ``atmosphere`` and ``instruments`` its parts of these names, and ``params`` or ``p``
the kernel's own settings in it. ``sensed``, ``nav``, ``state`` and ``goal`` (``out`` in guidance) are the
records ``SENSED``, ``NAV``, ``VEHICLE_STATE`` and ``GUIDE``. ``effectiveness`` is force and torque of each
thruster at full thrust, rows of 6 (N, N m), ``healthy`` is 0 for a thruster out of use, ``t`` is flight time
and ``dt`` the time since the last call (s). ``memory`` is updated, ``out`` is written. A docstring describes
only the arguments that differ from this.
"""

from __future__ import annotations

from edl6dof.fsw.allocation.effectiveness import update_effectiveness
from edl6dof.fsw.allocation.registry import allocate, compose_demand, no_demand
from edl6dof.fsw.check_out import check_out, put_off, under_check_out
from edl6dof.fsw.control.registry import gather_inputs
from edl6dof.fsw.diagnosis.diagnose import DiagnosisSignals, diagnose, isolate_dead, restart
from edl6dof.fsw.diagnosis.exercise import ExerciseSignals, pair_to_test, thruster_to_close
from edl6dof.fsw.diagnosis.flow_evidence import NONE
from edl6dof.fsw.estimation.engine_thrust import engine_shortfall, stuck_throttle
from edl6dof.fsw.estimation.registry import estimate_disturbance, force_angle, remember_valves
from edl6dof.fsw.external import (
    replace_bank,
    replace_duties,
    replace_estimate,
    replace_health,
    replace_landing_point,
    replace_thrust,
    replace_torque,
)
from edl6dof.fsw.guidance.phase_guidance import guide, switch_engine
from edl6dof.fsw.mission import G_AVOID, G_ENTRY, G_HOLD_BANK, sequence
from edl6dof.fsw.modulation import (
    close_for_test,
    command_valves,
    excess_torque,
    modulate,
    open_alone,
    open_for_test,
)
from edl6dof.fsw.navigation.derived import derive, expected_wind, filter_drag
from edl6dof.fsw.navigation.update import estimate_state
from edl6dof.fsw.navigation.wind_estimate import estimate_wind
from edl6dof.fsw.vehicle_state import count_propellant, follow_events, share_thrust
from edl6dof.interface.effectors import ENGINE_OFF
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import take3

#: Steps of a cycle that write each record of ``FSW``; a step reads the records that it gets as arguments.
WRITERS = {
    "navigation": ("estimate_state", "replace_estimate"),
    "nav": ("derive", "filter_drag"),
    "drag_filter": ("filter_drag",),
    "wind": ("estimate_wind",),
    "mission": ("sequence",),
    "vehicle": ("follow_events", "count_propellant", "believe_thrust", "run"),
    "hazard": ("detect_hazards",),
    "landing_point": ("detect_hazards", "replace_landing_point"),
    "guidance": ("guide",),
    "guide": ("switch_engine", "guide", "replace_bank", "replace_thrust"),
    "own": ("guide", "replace_torque", "replace_duties"),
    "effectiveness": ("update_effectiveness",),
    "estimation": ("estimate_disturbance", "believe_thrust", "remember_valves"),
    "disturbance": ("estimate_disturbance",),
    "diagnosis": ("restart", "diagnose", "isolate_dead", "pair_to_test"),
    "health": ("diagnose", "isolate_dead", "replace_health"),
    "check_out": ("put_off", "check_out"),
    "control": ("gather_inputs", "control"),
    "demand": ("no_demand", "compose_demand"),
    "allocation": ("allocate", "replace_duties"),
    "modulation": ("open_alone", "modulate", "open_for_test", "close_for_test"),
    "command": ("run", "sequence", "detect_hazards", "command_angles_and_engine", "command_valves"),
}


@kernel
def command_angles_and_engine(vehicle, goal, state, command):
    """Command the bank angle, angle of attack, engine mode and thrust of guidance."""
    command.steering, command.bank = 1, goal.bank
    command.alpha = 0.0 if state.wing_commanded != 0 else goal.alpha
    command.engine_mode = goal.engine_mode if state.ignited != 0 else ENGINE_OFF
    share_thrust(vehicle, goal.thrust, state, command.thrust)


@kernel
def commanded_thrust(vehicle, t, state, command):
    """Return the commanded axial thrust (N) of all burning engines at flight time ``t`` (s), without the
    share that the axial thrusters give.
    """
    thrust = 0.0
    if t >= state.ignition_time:
        for i in range(vehicle.n_engines):
            engine = vehicle.engines[i]
            thrust += command.thrust[i] * engine.axial * (1.0 - engine.by_thrusters)
    return thrust


@kernel
def believe_thrust(params, vehicle, nav, disturbance, command, dt, memory, state):
    """Update the believed loss of thrust and the believed stuck throttle from the unexplained axial force."""
    commanded, measured = commanded_thrust(vehicle, nav.t, state, command), -disturbance.unexplained[0]
    full, weight = state.engine.full_thrust, state.mass * nav.gravity
    state.held_thrust = stuck_throttle(
        params.held_thrust, commanded, measured, full, weight, dt=dt, memory=memory.held_thrust
    )
    lost = engine_shortfall(params.engine_shortfall, commanded, measured, dt, memory.engine_shortfall)
    state.thrust_lost = lost if state.held_thrust == 0.0 else 0.0


@kernel
def stands(nav, phase):
    """Return whether the vehicle stands on the ground and no thruster may fire. The ground holds it, so a
    thruster that is tested there seems dead.
    """
    return nav.footpad_contact != 0 and phase.n_thrusters == 0


@kernel
def run(functions, onboard, sensed, k, fsw):
    """Run base cycle number ``k``, from ``sensed`` to ``fsw.command``, with the kernels ``functions``
    (:mod:`.functions`).
    """
    laws, control, share_out, estimate, filters, classify, detect_hazards = functions
    vehicle, rates = onboard.vehicle, onboard.rates
    nav, state, goal, command = fsw.nav, fsw.vehicle, fsw.guide, fsw.command
    external, own = fsw.external, fsw.own
    dt = 1.0 / rates.base
    control_dt = dt * rates.control_every
    for i in range(command.request.shape[0]):
        command.request[i] = 0
    command.camera_trigger = command.scan = 0

    # navigation
    estimate_state(filters, onboard, state, sensed, fsw.navigation)
    replace_estimate(external, fsw.navigation.estimate)
    site, estimate_now, wind = onboard.site.frame, fsw.navigation.estimate, fsw.wind
    derive(onboard.planet, onboard.atmosphere, vehicle, site, estimate_now, wind=wind, nav=nav)
    filter_drag(onboard.navigation.drag_filter, onboard.atmosphere, vehicle, nav, fsw.drag_filter)
    if onboard.mission.n_phases == 0:
        return
    guided_by = onboard.mission.phases[fsw.mission.phase].guidance
    if guided_by == G_ENTRY or guided_by == G_HOLD_BANK:
        expected = expected_wind(onboard.atmosphere, nav.altitude)
        estimate_wind(
            onboard.navigation.wind,
            onboard,
            expected_N=expected,
            solution=fsw.navigation.solution,
            pressure=sensed.pressure,
            nav=nav,
            memory=wind,
        )

    # mission phases
    sequence(onboard.mission, nav, vehicle=state, guide=goal, memory=fsw.mission, request=command.request)
    phase, command.phase = onboard.mission.phases[fsw.mission.phase], fsw.mission.phase
    follow_events(vehicle, onboard.mission, nav.t, command.request, state)
    switch_engine(onboard.mission, command.request, state, goal)
    count_propellant(vehicle, goal.thrust, fsw.modulation, dt, control_dt, state=state)
    for i in range(command.request.shape[0]):
        if command.request[i] != 0:
            restart(1, fsw.diagnosis)

    # hazard detection
    detect_hazards(
        classify,
        onboard,
        kind=phase.guidance,
        elapsed=nav.t - fsw.mission.phase_start,
        sensed=sensed,
        nav=nav,
        state=state,
        memory=fsw.hazard,
        point=fsw.landing_point,
        command=command,
    )
    replace_landing_point(external, fsw.landing_point)

    # guidance
    last_bank = goal.bank
    guide(
        laws,
        onboard,
        kind=phase.guidance,
        k=k,
        begins=phase.guidance != guided_by,
        nav=nav,
        state=state,
        disturbance=fsw.disturbance,
        point=fsw.landing_point,
        memory=fsw.guidance,
        goal=goal,
        own=own,
    )
    replace_bank(external, onboard.guidance.entry.bank_rate, last_bank, dt, goal)
    replace_thrust(external, onboard.guidance.powered, state, nav.t, goal)
    command_angles_and_engine(vehicle, goal, state, command)
    if k % rates.control_every != 0:
        return

    count, healthy, disturbance = vehicle.n_thrusters, fsw.health.thruster, fsw.disturbance
    update_effectiveness(vehicle, state.configuration, fsw.health.loss, fsw.effectiveness)
    effectiveness = fsw.effectiveness.matrix
    inertia = vehicle.configuration[state.configuration].inertia

    # estimation
    estimate_disturbance(
        estimate,
        onboard.estimation,
        vehicle,
        state,
        nav,
        imu_delay=onboard.imu_delay,
        effectiveness=effectiveness,
        dt=control_dt,
        memory=fsw.estimation,
        out=disturbance,
    )
    believe_thrust(
        onboard.estimation,
        vehicle,
        nav,
        disturbance,
        command,
        dt=control_dt,
        memory=fsw.estimation,
        state=state,
    )
    state.force_angle = force_angle(
        onboard.estimation.force_angle_lag, take3(disturbance.force, 0), control_dt, state.force_angle
    )

    # fault isolation
    signals = DiagnosisSignals(
        vehicle=vehicle,
        instruments=onboard.instruments,
        metered=onboard.flow_meters != 0,
        used=sensed.branch_used,
        effectiveness=effectiveness,
        activity=fsw.estimation.activity,
        unexplained=disturbance.unexplained,
        lag=onboard.imu_delay + onboard.estimation.valve_lag,
        t=nav.t,
        dt=control_dt,
        healthy=healthy,
        loss=fsw.health.loss,
    )
    standing = stands(nav, phase)
    if not standing:
        diagnose(onboard.diagnosis, signals, fsw.diagnosis)
    for b in range(vehicle.branches.count):
        command.latch_closed[b] = fsw.diagnosis.leak.latch_closed[b]
    replace_health(external, count, healthy)

    checking = under_check_out(onboard.check_out, fsw.mission.phase, fsw.check_out)
    if checking and fsw.diagnosis.leak.branch != NONE:
        put_off(fsw.check_out)
        checking = False
    if checking:
        # check-out: attitude control rests
        no_demand(fsw.demand)
        rate = take3(nav.imu_rate_B, 0)
        thruster, on, loss = check_out(
            onboard.check_out, effectiveness, inertia, nav.t, rate, dt=control_dt, memory=fsw.check_out
        )
        if loss > 0.0 and healthy[thruster] != 0:
            isolate_dead(onboard.diagnosis, signals, thruster, loss, fsw.diagnosis)
        open_alone(thruster, on, count, nav.t, fsw.modulation)
    else:
        # attitude control
        gather_inputs(
            vehicle,
            state,
            phase,
            phase_time=nav.t - fsw.mission.phase_start,
            disturbance=disturbance,
            saturated=fsw.allocation.saturated,
            excess=excess_torque(effectiveness, count, control_dt, fsw.modulation),
            inputs=fsw.control.inputs,
        )
        torque, error = control(
            phase.control,
            onboard.control,
            nav,
            goal,
            fsw.control.inputs,
            dt=control_dt,
            memory=fsw.control.law,
        )
        torque = replace_torque(external, torque, own)
        compose_demand(
            phase,
            vehicle,
            effectiveness,
            state,
            healthy,
            nav=nav,
            goal=goal,
            torque=torque,
            error=error,
            demand=fsw.demand,
        )

        # allocation
        allocate(
            share_out,
            onboard.allocation,
            vehicle,
            healthy,
            fsw.effectiveness,
            demand=fsw.demand,
            out=fsw.allocation,
        )
        replace_duties(external, count, fsw.allocation.duty, own)

        # modulation
        modulate(onboard.modulation, vehicle, fsw.allocation.duty, nav.t, control_dt, memory=fsw.modulation)
        resting = ExerciseSignals(
            vehicle=vehicle,
            effectiveness=effectiveness,
            healthy=healthy,
            diagnosis=fsw.diagnosis,
            valves=fsw.modulation,
            sideways=phase.guidance == G_AVOID,
            axial=abs(nav.specific_force_B[0]) * state.mass,
            start=fsw.mission.phase_start,
            t=nav.t,
            dt=control_dt,
        )
        i, j = NONE, NONE
        if not standing:
            i, j = pair_to_test(onboard.diagnosis.exercise, resting, fsw.diagnosis.exercise)
        if i != NONE:
            open_for_test(i, vehicle, nav.t, control_dt, fsw.modulation)
        if j != NONE:
            open_for_test(j, vehicle, nav.t, control_dt, fsw.modulation)
        steady = thruster_to_close(onboard.diagnosis.exercise, resting)
        if steady != NONE:
            close_for_test(steady, fsw.modulation)
    command_valves(count, fsw.modulation, command)
    remember_valves(fsw.modulation, count, fsw.estimation.activity)
