"""Height at which a gravity turn stops the lander (stop height), for braking in time and for the descent on a
stuck throttle.

Braking in time: each call computes the stop height of a gravity turn at full thrust. As long as it is above
the least height of the target, the acceleration of the law is flown. Otherwise a gravity turn at full thrust,
which gives the least speed at the ground, replaces the law and its limits, until thrust within the throttle
band can stop the lander above the least height, or full thrust above the target. The axial thrusters, which
fire at full thrust, are left out: they compensate the lag of the engine.

Stuck throttle: an engine whose throttle is stuck at a thrust above the weight stops the lander in the air and
lifts it again; only the time of its burn can still be chosen. Each call computes the stop height for a burn
that begins now. As long as the stop height is well above the ground, the engine is off and the lander falls;
when the stop height reaches the ground, the engine is ignited again. The computation includes a share of the
force of the axial thrusters, so that they can correct in both directions: they fire while the stop height is
too low. Just above the ground, where a fall is harmless, the engine is cut off. The mission has two phases
for this: one cuts the engine off and lasts until ``stop_height_m`` is low, the other ignites it and cuts it
off when ``time_to_go_s`` is over.

Source: Cheng, AIAA 66-1863 (gravity turn); braking with full thrust as late as possible needs the least
propellant (Meditch, IEEE Trans. Automatic Control 9 (1964) 477-484); one burn of constant thrust to the
ground: this project.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.config.units import G0
from edl6dof.fsw.guidance.guidance_command import EVERYTHING
from edl6dof.fsw.guidance.powered.terminal_descent import command_thrust, push_sideways
from edl6dof.interface.effectors import AXIAL, ENGINE_FULL, ENGINE_THROTTLE
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan

#: Step (s) of the integration to the stop, depth below the ground (m) at which it ends, and least descent
#: rate (m/s) in the direction of thrust.
STEP, DEEP, LEAST_DESCENT = 0.1, 1000.0, 3.0
#: Descent rate (m/s) at which the lander counts as stopped.
STOPPED = 2.0


@kernel
def stop_height(tilt_limit, stop_speed, thrust, flow, mass, gravity, height, sideways, descent):
    """Height (m) at which a gravity turn from the present state reaches a descent rate of ``stop_speed``
    (m/s); far below zero if it does not.

    Args:
        tilt_limit: largest tilt of the thrust, rad.
        stop_speed: m/s.
        thrust: N, constant.
        flow, mass: propellant flow, kg/s; mass, kg.
        gravity: m/s2.
        height: above ground, m.
        sideways, descent: horizontal speed and descent rate, m/s.
    """
    steepest = tan(tilt_limit)
    while descent > stop_speed and height > -DEEP:
        upward = max(descent, LEAST_DESCENT)
        lean = min(sideways, steepest * upward)
        along = thrust / (mass * sqrt(lean * lean + upward * upward))
        braking = along * upward - gravity
        step = STEP
        if braking * step > descent - stop_speed:
            step = (descent - stop_speed) / braking
        height -= (descent - 0.5 * braking * step) * step
        descent -= braking * step
        sideways = max(sideways - along * lean * step, 0.0)
        mass -= flow * step
        if step < STEP:
            return height
    return height


@kernel
def stop_at(thrust, tilt_limit, engine, nav, mass):
    """Height (m) at which a gravity turn with this ``thrust`` (N) from the present state stops the lander."""
    return stop_height(
        tilt_limit,
        stop_speed=STOPPED,
        thrust=thrust,
        flow=thrust / (engine.specific_impulse * G0),
        mass=mass,
        gravity=nav.gravity,
        height=nav.height,
        sideways=sqrt(nav.v_N[0] * nav.v_N[0] + nav.v_N[1] * nav.v_N[1]),
        descent=nav.v_N[2],
    )


@kernel
def brake_in_time(wanted, engine, nav, mass, target, braking, out):
    """Choose between the acceleration of the law and that of a gravity turn at full thrust; return it (north,
    east, up, m/s2, including the part that balances gravity), and whether it is that of the gravity turn.

    Args:
        wanted: acceleration of the law, then its tilt limit (rad).
        engine: ``ENGINE_ABILITY`` record of the burning engines.
        nav, mass: ``NAV`` record; kg.
        target: ``POWERED_TARGET`` record.
        braking: True if the last call chose the gravity turn.
        out: ``GUIDE`` record, written: full level, time to go, relaxed constraints, landing error.
    """
    north, east, up, tilt_limit = wanted
    descent = nav.v_N[2]
    stop = stop_at(engine.full_thrust, tilt_limit, engine, nav, mass)
    enough = descent <= STOPPED or stop >= (target.height if braking else target.least_height)
    if braking and not enough:
        enough = stop_at(engine.throttle_max, tilt_limit, engine, nav, mass) >= target.least_height
    if enough:
        return (north, east, up), False
    size = engine.full_thrust / mass
    out.full_wanted, out.relaxed, out.landing_error = 1, EVERYTHING, max(target.least_height - stop, 0.0)
    out.time_to_go = max(out.time_to_go, descent / max(size - nav.gravity, 1.0))
    v_n, v_e, upward = nav.v_N[0], nav.v_N[1], max(descent, LEAST_DESCENT)
    scale = size / sqrt(v_n * v_n + v_e * v_e + upward * upward)
    return (-scale * v_n, -scale * v_e, scale * upward), True


class StuckThrottleDescentParams(Params):
    """Descent on a throttle that is stuck."""

    thruster_share: float = param(
        0.4, "share of the axial thrusters' force included in the braking", status="estimate", ge=0.0, le=1.0
    )
    stop_height_m: float = param(
        1.0, "height at which the lander is to reach stop_speed_m_s", status="estimate", ge=0.0
    )
    stop_speed_m_s: float = param(1.0, "descent rate at the stop", status="estimate", gt=0.0)
    start_s: float = param(0.3, "time from ignition to thrust", status="estimate", ge=0.0, le=60.0)
    tilt_limit_deg: float = param(30.0, "largest tilt of the commanded thrust", gt=0.0, le=60.0)
    upright_below_m: float = param(8.0, "height below which the lander stays nearly upright", ge=0.0)
    upright_tilt_deg: float = param(2.0, "largest tilt below upright_below_m", ge=0.0, le=20.0)
    drop_speed_m_s: float = param(
        2.5, "impact speed of a free fall up to which the engine is cut off", gt=0.0
    )


@kernel
def axial_force(thrusters, count):
    """Force of all axial thrusters together, N."""
    total = 0.0
    for i in range(count):
        if thrusters[i].group == AXIAL:
            total += thrusters[i].thrust
    return total


@kernel
def expect_stop(p, vehicle, state, nav):
    """Height (m) at which the engine, once started, and a share of the axial thrusters stop the lander."""
    fall = 0.0
    if state.ignited == 0:
        fall = p.start
    elif nav.t < state.ignition_time + p.start:
        fall = min(state.ignition_time + p.start - nav.t, p.start)
    force = p.thruster_share * axial_force(vehicle.thrusters, vehicle.n_thrusters)
    return stop_height(
        p.tilt_limit,
        p.stop_speed,
        thrust=state.held_thrust + force,
        flow=state.held_thrust / (vehicle.engines[0].specific_impulse * G0),
        mass=state.mass,
        gravity=nav.gravity,
        height=nav.height - (nav.v_N[2] + 0.5 * nav.gravity * fall) * fall,
        sideways=sqrt(nav.v_N[0] * nav.v_N[0] + nav.v_N[1] * nav.v_N[1]),
        descent=nav.v_N[2] + nav.gravity * fall,
    )


@kernel
def descend_on_stuck_throttle(p, terminal, vehicle, state, nav, bias, out):
    """Command thrust against the velocity, and when the burn begins and ends.

    Args:
        p: ``StuckThrottleDescentParams`` record.
        terminal: ``TerminalParams`` record: the horizontal thrusters work below ``upright_below_m`` as in the
            slow descent.
        vehicle, state, nav: believed vehicle, ``VEHICLE_STATE`` and ``NAV`` records.
        bias: lateral bias force (north, east, N).
        out: ``GUIDE`` record, written: ``stop_height`` (m), and a ``time_to_go`` of 0 where the engine is to
            be cut off.
    """
    out.stop_height = expect_stop(p, vehicle, state, nav)
    descent, upright = nav.v_N[2], nav.height < p.upright_below
    tilt_limit = p.upright_tilt if upright else p.tilt_limit
    command_thrust(state.mass, (-nav.v_N[0], -nav.v_N[1], max(descent, LEAST_DESCENT)), tilt_limit, out)
    out.thrust = 0.0
    if state.ignited != 0:
        starting = nav.t < state.ignition_time + p.start
        low = descent > p.stop_speed and out.stop_height < p.stop_height
        out.thrust = state.held_thrust
        out.engine_mode = ENGINE_FULL if starting or low else ENGINE_THROTTLE
    out.translating = 0
    if upright and nav.height > terminal.rest_height:
        gain = -terminal.touchdown_velocity_gain
        push_sideways(terminal, state.mass, (gain * nav.v_N[0], gain * nav.v_N[1]), bias, out)
    drop = sqrt(max(descent, 0.0) ** 2 + 2.0 * nav.gravity * max(nav.height, 0.0))
    over = descent < 0.0 or drop < p.drop_speed
    out.time_to_go = 0.0 if over else max(nav.height, 0.0) / max(descent, 1.0)
