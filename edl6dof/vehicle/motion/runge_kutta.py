"""One step of the classical Runge-Kutta method of fourth order, its inputs and its outputs.

Some inputs of the derivative are set once a step.  Linear in time: force and moment of the thrusters in
vacuum, their propellant flow, and the thrust goals of the engines.  Constant: the planes of the ground, the
tanks that are not empty, and the noncentral part of gravitation at the predicted middle of the step.  In a
step of 10 ms at 6 km/s this part changes by 4e-7 m/s2, linearly: a constant one displaces the vehicle by less
than 1e-6 m in a minute of coasting, and costs one sum of harmonics a step instead of four.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.environment.areoid import areoid_at, lay_areoid
from edl6dof.environment.terrain import ground
from edl6dof.interface.capacities import MAX_TANKS
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import add, put3, scale, sub, take3
from edl6dof.vehicle.landing_gear import lay_ground_planes
from edl6dof.vehicle.motion.balance import rates, weigh
from edl6dof.vehicle.motion.body import derivatives, motion
from edl6dof.vehicle.motion.point_mass import POINT_MASS
from edl6dof.vehicle.parachutes.parachute import EXTRACTING, INFLATING
from edl6dof.vehicle.plant import (
    ATTITUDE,
    POSITION,
    PROPELLANT,
    STATES,
    STATES_VEHICLE,
    THRUST,
    VELOCITY,
    take_attitude,
)
from edl6dof.vehicle.propulsion.engine import thrust_goal
from edl6dof.vehicle.propulsion.engine_models import UNCOMMANDED
from edl6dof.vehicle.propulsion.feed_system import load_within_reach
from edl6dof.vehicle.propulsion.rcs import fire
from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation

#: Height (m) above the last known ground below which every step evaluates the ground; no terrain rises so far
#: within a cycle.
NEAR_GROUND = 2000.0


@kernel
def survey(case, tables, plant, outputs):
    """Survey areoid and ground under the place in ``outputs``, for the next cycle of the flight software."""
    out = outputs
    out.latitude, out.longitude = atan2(out.sin_lat, out.cos_lat), atan2(out.sin_lon, out.cos_lon)
    c, s = planet_rotation(case.planet, plant.t)
    place = (out.sin_lat, out.cos_lat, out.sin_lon, out.cos_lon)
    r_F = rotate_z(c, s, take3(plant.y, POSITION))
    areoid = lay_areoid(
        tables.areoid, place, lat=out.latitude, lon=out.longitude, r_F=r_F, plane=plant.inputs.areoid
    )
    look_at_ground(case, tables, plant, outputs, areoid)


@kernel
def look_at_ground(case, tables, plant, outputs, areoid):
    """Set the plane of the ground and the height above it; ``areoid``: height (m) and rise per metre of the
    areoid.
    """
    inputs, out = plant.inputs, outputs
    elevation, slope_north, slope_east = ground(case.terrain, tables.terrain, out.latitude, out.longitude)
    inputs.ground_altitude = areoid[0] + elevation
    inputs.ground_slope[0] = areoid[1] + slope_north
    inputs.ground_slope[1] = areoid[2] + slope_east
    out.elevation, out.height = elevation, out.altitude - inputs.ground_altitude


@kernel
def evaluate(case, tables, plant, outputs, work):
    """Update ``outputs``; required after every change of the state between steps."""
    evaluate_at(case, tables, plant, outputs, work, rotation=planet_rotation(case.planet, plant.t))


@kernel
def evaluate_at(case, tables, plant, outputs, work, rotation):
    """As :func:`evaluate`, where the rotation of the planet is known already."""
    derivatives(case, tables, plant, plant.t, rotation, y=plant.y, outputs=outputs, dy=work.k[0])
    if case.dynamics == POINT_MASS:
        for i in range(4):
            plant.y[ATTITUDE + i] = outputs.q_I2B[i]
    out = outputs
    if out.altitude - plant.inputs.ground_altitude < NEAR_GROUND:
        # not the plane of the areoid, from which these outputs follow: evaluated again, they are the same
        out.latitude, out.longitude = atan2(out.sin_lat, out.cos_lat), atan2(out.sin_lon, out.cos_lon)
        areoid = areoid_at(tables.areoid, out.latitude, out.longitude)
        look_at_ground(case, tables, plant, outputs, areoid)
        q, rise = take_attitude(plant.y), (areoid[1], areoid[2])
        lay_ground_planes(case, tables, plant, outputs, q, rotation=rotation, areoid=rise)
        if plant.touched != 0:
            derivatives(case, tables, plant, plant.t, rotation, y=plant.y, outputs=outputs, dy=work.k[0])


@kernel
def lay_down_inputs(case, plant, rotation, h):
    """Set the inputs of a step of ``h`` s from now; ``rotation``: of the planet at its middle."""
    inputs = plant.inputs
    for k in range(MAX_TANKS):
        inputs.filled[k] = 1 if plant.y[PROPELLANT + k] > 0.0 and plant.blocked[k] == 0 else 0
    inputs.middle = plant.t + 0.5 * h
    set_goals(case, plant, h)
    feeds, branch = case.feeds.thrusters, case.branches.of
    fire(
        case.vehicle.rcs,
        loads=feeds,
        branch=branch,
        valves=plant.valves,
        t=plant.t,
        step=h,
        inputs=inputs,
        used=plant.branch_used,
    )
    # the position predicted for the middle of the step
    ahead = add(take3(plant.y, POSITION), scale(0.5 * h, take3(plant.y, VELOCITY)))
    put3(inputs.noncentral_I, 0, noncentral_I(case.planet, rotation, ahead))


@kernel
def set_goals(case, plant, h):
    """Set the thrust goals of a step of ``h`` s: zero for an engine that is off or has no propellant."""
    inputs, engines = plant.inputs, case.vehicle.engines
    for i in range(case.vehicle.n_engines):
        fed = load_within_reach(case.feeds.engines, i, inputs.filled) > 0.0
        command = 0.0
        if fed and plant.running[i] != 0:
            uncommanded = engines[i].model == UNCOMMANDED
            command = engines[i].full_thrust if uncommanded else plant.thrust_command[i]
        mean, slope = thrust_goal(engines[i], plant.t, h, command)
        inputs.thrust_goal[i], inputs.thrust_goal_slope[i] = mean, slope


@kernel
def rk4(case, tables, plant, outputs, work, middle, end, t_end):
    """Advance ``plant.y`` from ``plant.t`` to ``t_end`` (s), from its derivative ``work.k[0]``; ``middle``,
    ``end``: rotation of the planet in the middle and at the end of the step.
    """
    y, k, stage = plant.y, work.k, work.stage
    n = THRUST + case.vehicle.n_engines
    if plant.canopy == EXTRACTING or plant.canopy == INFLATING:
        n = STATES
    k1, k2, k3, k4 = k[0], k[1], k[2], k[3]
    t = plant.t
    h = t_end - t
    for i in range(n):
        stage[i] = y[i] + 0.5 * h * k1[i]
    derivatives(case, tables, plant, t=t + 0.5 * h, rotation=middle, y=stage, outputs=outputs, dy=k2)
    for i in range(n):
        stage[i] = y[i] + 0.5 * h * k2[i]
    derivatives(case, tables, plant, t=t + 0.5 * h, rotation=middle, y=stage, outputs=outputs, dy=k3)
    for i in range(n):
        stage[i] = y[i] + h * k3[i]
    derivatives(case, tables, plant, t=t_end, rotation=end, y=stage, outputs=outputs, dy=k4)
    for i in range(n):
        y[i] += h * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0
    normalise(y)


@kernel
def normalise(y):
    """Give the attitude quaternion in the state ``y`` unit length."""
    q = take_attitude(y)
    inverse = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for i in range(ATTITUDE, ATTITUDE + 4):
        y[i] *= inverse


@kernel
def step(case, tables, plant, outputs, work, t_end):
    """Fly one step to ``t_end`` (s), thrusters included; ``outputs`` belong to the state before and after.
    Returns False if the step failed.
    """
    h = t_end - plant.t
    work.t0 = plant.t
    for i in range(STATES):
        work.y0[i] = plant.y[i]
    middle = planet_rotation(case.planet, plant.t + 0.5 * h)
    end = planet_rotation(case.planet, t_end)
    lay_down_inputs(case, plant, middle, h)
    v, q, g = take3(plant.y, VELOCITY), take_attitude(plant.y), take3(outputs.gravity_I, 0)
    if case.dynamics == POINT_MASS:  # a new bank command turns it, and its loads, at once
        rotation = planet_rotation(case.planet, plant.t)
        derivatives(case, tables, plant, plant.t, rotation, y=plant.y, outputs=outputs, dy=work.k[0])
    else:  # the loads in ``outputs`` are those of the present state
        motion(case, plant, plant.t, plant.y, outputs, dy=work.k[0])
    begun = rates(case, plant, outputs)
    rk4(case, tables, plant, outputs, work, middle=middle, end=end, t_end=t_end)
    plant.t = t_end
    if not finite(plant.y):
        return False
    put3(plant.inputs.rcs_force_slope, 0, (0.0, 0.0, 0.0))
    put3(plant.inputs.rcs_moment_slope, 0, (0.0, 0.0, 0.0))
    for k in range(MAX_TANKS):
        plant.inputs.rcs_flow_slope[k] = 0.0
    evaluate_at(case, tables, plant, outputs, work, rotation=end)
    # half in the axes at the start, half in those at the end: second order in the turn during the step
    fell = scale(0.5 * h, add(g, take3(outputs.gravity_I, 0)))
    felt = scale(0.5, sub(sub(take3(plant.y, VELOCITY), v), fell))
    gained = add(to_frame(q, felt), to_frame(take_attitude(plant.y), felt))
    put3(plant.velocity_gain, 0, add(take3(plant.velocity_gain, 0), gained))
    weigh(case, plant, work, h, begun, ended=rates(case, plant, outputs))
    return True


@kernel
def finite(y):
    """Return True if all states of the vehicle, or their derivatives, are finite. The states of a canopy are
    not checked: a canopy acts on the vehicle, so states of a canopy that are not finite make those of the
    vehicle not finite too.
    """
    total = 0.0
    for i in range(STATES_VEHICLE):
        total += 0.0 * y[i]
    return total == 0.0


@kernel
def undo(plant, work):
    """Return to the start of a step that failed; the result of the step goes to ``work.stage``."""
    for i in range(STATES):
        work.stage[i], plant.y[i] = plant.y[i], work.y0[i]
    work.t_failed, plant.t = plant.t, work.t0


@kernel
def retrace(case, tables, plant, outputs, work):
    """Evaluate again the stages of the step that :func:`undo` has undone, up to the first that is not finite.
    The state of this stage is then in ``work.stage``, its quantities in ``outputs``, its derivative in
    ``work.k[0]``.  When all stages are finite, the result of the step stays in ``work.stage``.
    """
    dy, y, result = work.k[0], work.stage, work.k[1]
    h = work.t_failed - plant.t
    for i in range(STATES):
        dy[i], result[i] = 0.0, y[i]
    for share in (0.0, 0.5, 0.5, 1.0):
        for i in range(STATES):
            y[i] = plant.y[i] + share * h * dy[i]
        t = plant.t + share * h
        derivatives(
            case, tables, plant, t, rotation=planet_rotation(case.planet, t), y=y, outputs=outputs, dy=dy
        )
        if not (finite(y) and finite(dy)):
            return
    for i in range(STATES):
        y[i] = result[i]
