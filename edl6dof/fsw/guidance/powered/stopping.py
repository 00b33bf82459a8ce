"""Braking while there is time: full thrust against the velocity where nothing less stops the lander.

In each call the height is worked out at which a gravity turn at full thrust would bring the lander to rest.
While that is above the least height of the target, the law has its way, whichever it is.  Where it is not,
every limit of the law gives way to a gravity turn at full thrust, which leaves the least speed at the ground,
until the throttle band alone stops the lander above that height, or full thrust above the target.  The axial
thrusters, which burn at full thrust, are left out: they make up for the lag of the engine.

Source: Cheng, AIAA 66-1863 (gravity turn); to brake with full thrust as late as possible takes the least
propellant (Meditch, IEEE Trans. Automatic Control 9 (1964) 477-484), so that no later moment would do.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.units import G0
from edl6dof.fsw.guidance.guidance_command import EVERYTHING
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import tan

#: Step (s) in which the stop is looked for, how far below the ground (m), and least descent rate (m/s) that
#: thrust is turned by.
STEP, DEEP, LEAST_DESCENT = 0.1, 1000.0, 3.0
#: Descent rate (m/s) at which the lander has stopped: what follows takes it from there.
STOPPED = 2.0


@kernel
def stop_height(tilt_limit, stop_speed, thrust, flow, mass, gravity, height, sideways, descent):
    """Height (m) at which a gravity turn from here is down to a descent rate of ``stop_speed``; far below
    zero where it is not stopped.

    Args:
        tilt_limit: of the thrust, rad.
        stop_speed: m/s.
        thrust: N, constant.
        flow: propellant, kg/s.
        mass: kg.
        gravity: m/s2.
        height: above ground, m.
        sideways: horizontal speed, m/s.
        descent: descent rate, m/s.
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
    """Height (m) at which a gravity turn with this ``thrust`` (N) stops the lander from where it is."""
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
    """The acceleration (north, east, up, m/s2, gravity included) of the law or of a gravity turn at full
    thrust, and whether it is the latter.

    Args:
        wanted: of the law, with its tilt limit (rad) as the last.
        engine: ``ENGINE_ABILITY`` record of those that burn.
        nav: ``NAV`` record.
        mass: kg.
        target: ``POWERED_TARGET`` record.
        braking: whether it was the latter before.
        out: ``GUIDE`` record, written: full level, time to go, and what is relaxed.
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
