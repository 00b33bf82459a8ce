"""Fixed-step fourth-order Runge-Kutta with events located inside the step.

Scheduled events (pyrotechnics with their delays) split the step at their time.  Events of the state (line
stretch, first contact of a footpad) are found by repeating the step with a shorter length until the event
function is zero to 1e-9 s.  A step is cut, never rounded; thruster impulse stays exact because valve levels
are integrated in closed form over whatever length the step has.
"""

from __future__ import annotations

from math import atan2, cos, isnan, sin, sqrt

from edl6dof.environment.terrain import ground
from edl6dof.interface.events import EVENTS
from edl6dof.jit import kernel
from edl6dof.spatial.frames import ned_to_fixed, rotate_z
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, norm, put3, scale, sub, take3
from edl6dof.vehicle.body import derivatives, motion
from edl6dof.vehicle.landing_gear import lowest_point
from edl6dof.vehicle.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import (
    ATTITUDE,
    CANOPY_POSITION,
    POSITION,
    PROPELLANT,
    STATES,
    STATES_VEHICLE,
    VELOCITY,
)
from edl6dof.vehicle.point_mass import POINT_MASS
from edl6dof.vehicle.rcs import fire
from edl6dof.vehicle.staging import carry_out

TIME_TOLERANCE = 1e-9
N_EVENTS = len(EVENTS)
#: Height (m) above the ground last seen below which every step looks at the ground; no terrain rises so far
#: within a cycle.
NEAR_GROUND = 2000.0


@kernel
def rk4(case, tables, plant, outputs, work, t, h):
    """Advance ``plant.y`` by one classical Runge-Kutta step of length ``h`` (s) from time ``t``."""
    y, k, trial = plant.y, work.k, work.trial
    n = STATES if plant.canopy == EXTRACTING or plant.canopy == INFLATING else STATES_VEHICLE
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    if plant.fresh == 0:
        derivatives(case, tables, plant, t, y, outputs, k1)
    else:
        motion(case, plant, y, outputs, k1)
    plant.fresh = 0
    for i in range(n):
        trial[i] = y[i] + 0.5 * h * k1[i]
    derivatives(case, tables, plant, t + 0.5 * h, trial, outputs, k2)
    for i in range(n):
        trial[i] = y[i] + 0.5 * h * k2[i]
    derivatives(case, tables, plant, t + 0.5 * h, trial, outputs, k3)
    for i in range(n):
        trial[i] = y[i] + h * k3[i]
    derivatives(case, tables, plant, t + h, trial, outputs, k4)
    for i in range(n):
        y[i] += h * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0
    q2 = y[6] * y[6] + y[7] * y[7] + y[8] * y[8] + y[9] * y[9]
    inverse = 1.0 / sqrt(q2)
    for i in range(ATTITUDE, ATTITUDE + 4):
        y[i] *= inverse


@kernel
def look_down(case, tables, plant, outputs):
    """Refresh the ground under the vehicle (elevation and slope) at the start of a step."""
    out = outputs
    out.latitude, out.longitude = atan2(out.sin_lat, out.cos_lat), atan2(out.sin_lon, out.cos_lon)
    elevation, slope_north, slope_east = ground(case.terrain, tables.terrain, out.latitude, out.longitude)
    plant.ground_elevation = elevation
    plant.ground_slope[0] = slope_north
    plant.ground_slope[1] = slope_east
    out.agl = out.altitude - elevation


@kernel
def refresh(case, tables, plant, outputs, work):
    """Bring ``outputs`` and the ground below up to date with the present state.

    The step that follows starts from these loads (saves one evaluation of nine in a cycle of two steps),
    except on the ground: its push was found with the slope and height of the step before.  A point mass may
    be told another bank angle after this.
    """
    derivatives(case, tables, plant, plant.t, plant.y, outputs, work.k[0])
    look_down(case, tables, plant, outputs)
    plant.fresh = 0 if plant.touched != 0 or case.dynamics == POINT_MASS else 1


@kernel
def ground_clearance(case, plant, outputs, t):
    """Distance along the ground's normal from the lowest footpad (without legs: the nose) to the ground,
    m.
    """
    y, out = plant.y, outputs
    q = take_attitude(y)
    slope_n, slope_e = plant.ground_slope[0], plant.ground_slope[1]
    inverse = 1.0 / sqrt(1.0 + slope_n * slope_n + slope_e * slope_e)
    up_F = ned_to_fixed(
        out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon, (-slope_n * inverse, -slope_e * inverse, -inverse)
    )
    spin = case.planet.rotation_rate
    up_B = to_frame(q, rotate_z(cos(spin * t), -sin(spin * t), up_F))
    centre = take3(out.centre, 0)
    if plant.legs != 0:
        low = lowest_point(case.vehicle.landing_gear, centre, up_B)
    else:
        low = -(centre[0] * up_B[0] + centre[1] * up_B[1] + centre[2] * up_B[2])
    return (out.altitude - plant.ground_elevation) * inverse + low


@kernel
def line_slack(case, plant, outputs):
    """Length of line still to be paid out before line stretch, m."""
    y = plant.y
    hook = sub(take3(case.vehicle.parachute.confluence, 0), take3(outputs.centre, 0))
    q = take_attitude(y)
    anchor = add(take3(y, POSITION), from_frame(q, hook))
    return case.vehicle.parachute.line_length - norm(sub(take3(y, CANOPY_POSITION), anchor))


@kernel
def event_function(case, plant, outputs, t):
    """Positive until the next event of the state; NaN-free: 1 when no such event is possible."""
    if plant.canopy == EXTRACTING:
        return line_slack(case, plant, outputs)
    if plant.touched == 0 and outputs.agl < 50.0:
        return ground_clearance(case, plant, outputs, t)
    return 1.0


@kernel
def take_attitude(y):
    """``q_I2B`` in the integrated state, as a tuple."""
    return y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3]


@kernel
def step(case, tables, plant, outputs, work, h):
    """One integration step of length ``h`` from ``plant.t``, thrusters included; leaves ``outputs`` at its
    end.
    """
    t = plant.t
    work.step = h
    for i in range(STATES):
        work.y0[i] = plant.y[i]
    fx, fy, fz, mx, my, mz, flow = fire(case.vehicle.rcs, plant.valves, t, h, outputs.dynamic_pressure)
    if plant.y[PROPELLANT] <= 0.0:
        fx = fy = fz = mx = my = mz = flow = 0.0
    put3(plant.rcs_force, 0, (fx, fy, fz))
    put3(plant.rcs_moment, 0, (mx, my, mz))
    plant.rcs_flow = flow
    v, q = take3(plant.y, VELOCITY), take_attitude(plant.y)
    rk4(case, tables, plant, outputs, work, t, h)
    plant.t = t + h
    # half in the axes at the start, half in those at the end: second order in the turn during the step
    felt = scale(0.5, sub(sub(take3(plant.y, VELOCITY), v), scale(h, take3(outputs.gravity_I, 0))))
    put3(
        plant.velocity_gain,
        0,
        add(take3(plant.velocity_gain, 0), add(to_frame(q, felt), to_frame(take_attitude(plant.y), felt))),
    )


@kernel
def restore(plant, work, t):
    """Return to the saved beginning of a step."""
    for i in range(STATES):
        plant.y[i] = work.y0[i]
    for i in range(work.level0.shape[0]):
        plant.valves.level[i] = work.level0[i]
    put3(plant.velocity_gain, 0, take3(work.velocity_gain0, 0))
    plant.t = t
    plant.fresh = 0


@kernel
def located_step(case, tables, plant, outputs, work, h):
    """Step of at most ``h`` that ends exactly at the first event of the state; returns whether it ended at
    one.
    """
    t = plant.t
    before = event_function(case, plant, outputs, t)
    for i in range(work.level0.shape[0]):
        work.level0[i] = plant.valves.level[i]
    put3(work.velocity_gain0, 0, take3(plant.velocity_gain, 0))
    step(case, tables, plant, outputs, work, h)
    after = event_function(case, plant, outputs, plant.t)
    if not (before > 0.0 and after <= 0.0):
        return False
    low, high = 0.0, h
    f_low, f_high = before, after
    for iteration in range(60):
        if high - low < TIME_TOLERANCE:
            break
        # false position, with bisection every third pass against a one-sided stall
        share = 0.5 if iteration % 3 == 2 else f_low / (f_low - f_high)
        trial = low + min(max(share, 0.02), 0.98) * (high - low)
        restore(plant, work, t)
        step(case, tables, plant, outputs, work, trial)
        value = event_function(case, plant, outputs, plant.t)
        if value > 0.0:
            low, f_low = trial, value
        else:
            high, f_high = trial, value
    restore(plant, work, t)
    step(case, tables, plant, outputs, work, high)
    return True


@kernel
def finite(y):
    """Whether the states of the vehicle, or their derivatives, are finite; those of the canopy show in them
    at once.
    """
    total = 0.0
    for i in range(STATES_VEHICLE):
        total += 0.0 * y[i]
    return total == 0.0


@kernel
def note_exhaustion(case, plant, work):
    """Note when, during the last step, the propellant was used up."""
    left, before = plant.y[PROPELLANT], work.y0[PROPELLANT]
    if left <= 0.0 and isnan(plant.exhausted_time) and case.vehicle.mass.propellant.mass > 0.0:
        after = left / (left - before) if before > left else 1.0
        plant.exhausted_time = plant.t - after * work.step


@kernel
def go_back(plant, work):
    """Undo a step that failed; its result goes to ``work.trial``."""
    for i in range(STATES):
        work.trial[i], plant.y[i] = plant.y[i], work.y0[i]
    plant.t -= work.step
    plant.fresh = 0


@kernel
def retrace(case, tables, plant, outputs, work):
    """Look for what made the step fail that :func:`go_back` has undone: evaluate its stages again up to the
    first that is not finite.

    The state of that stage is left in ``work.trial``, the quantities met there in ``outputs``, its derivative
    in ``work.k[0]``.  When every stage is finite, the result of the step stays in ``work.trial``.
    """
    dy, y = work.k[0], work.k[1]
    for i in range(STATES):
        dy[i] = 0.0
    for share in (0.0, 0.5, 0.5, 1.0):
        for i in range(STATES):
            y[i] = plant.y[i] + share * work.step * dy[i]
        derivatives(case, tables, plant, plant.t + share * work.step, y, outputs, dy)
        if not (finite(y) and finite(dy)):
            for i in range(STATES):
                work.trial[i] = y[i]
            return


@kernel
def advance(case, tables, plant, outputs, work, t_end):
    """Fly from ``plant.t`` to ``t_end`` (s), carrying out every scheduled or located event on the way; False
    after a step that failed.
    """
    while True:
        due = t_end
        event = -1
        for i in range(N_EVENTS):
            if plant.due[i] <= due:
                due = plant.due[i]
                event = i
        h = due - plant.t
        if h > TIME_TOLERANCE:
            if plant.fresh == 0 and outputs.altitude - plant.ground_elevation < NEAR_GROUND:
                look_down(case, tables, plant, outputs)
            located = False
            if event_function(case, plant, outputs, plant.t) != 1.0:
                located = located_step(case, tables, plant, outputs, work, h)
            else:
                step(case, tables, plant, outputs, work, h)
            if not finite(plant.y):
                return False
            note_exhaustion(case, plant, work)
            if located:
                derivatives(case, tables, plant, plant.t, plant.y, outputs, work.k[0])
                if plant.canopy == EXTRACTING:
                    plant.canopy = INFLATING
                    plant.line_stretch_time = plant.t
                else:
                    plant.touched = 1
                    plant.touchdown_time = plant.t
                    for i in range(STATES):
                        plant.touchdown[i] = plant.y[i]
                continue
        plant.t = due
        if event < 0:
            break
        plant.due[event] = 1e99
        plant.done[event] = plant.t
        carry_out(case, plant, event)
        # the forces changed: sensors read the new ones
        derivatives(case, tables, plant, plant.t, plant.y, outputs, work.k[0])
        plant.fresh = 0
    return True
