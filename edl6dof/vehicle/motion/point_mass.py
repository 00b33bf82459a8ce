"""A point mass in place of the rigid body: attitude follows the commanded bank angle instead of torques.

Position and velocity are integrated in I under the same gravity, air and aerodynamics as the rigid body.
The angle of attack is the commanded one and sideslip is zero, both relative to the air.  The bank angle is
about the planet-relative velocity, as in telemetry and commands, and follows the command at once or at a
limited rate, the shorter way round.  Left out: body rates, thrusters, engine, and the flight after parachute
deployment.
Source: the three-degree-of-freedom equations of Zheng & Cui 2015 (eqs. 1-8) and Yan, Sun & Guo 2016 (eqs.
1-6), here in Cartesian form over a rotating planet.
"""

from __future__ import annotations

from typing import Literal

from edl6dof.config.base import Params, group, param
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import sin
from edl6dof.spatial.frames import attitude_in_wind, ned_to_fixed, rotate_z, wrap
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, clamp, dot, norm, put3, scale, sub, take3, unit
from edl6dof.vehicle.plant import HEAT, POSITION, STATES_VEHICLE, VELOCITY
from edl6dof.vehicle.surroundings import gravity

#: Values of ``case.dynamics``.
DYNAMICS = ("six_dof", "point_mass")
SIX_DOF, POINT_MASS = range(2)
RATE_LIMITED = 1


class PathDisturbanceParams(Params):
    """Disturbance of the flight-path rate, amplitude sin(frequency t) (Yan, Sun & Guo 2016, eq. 5)."""

    amplitude_rad_s: float = param(0.0, "amplitude of the added flight-path rate", ge=0.0, le=0.1)
    frequency_rad_s: float = param(1.0, "frequency of the disturbance", ge=0.0, le=20.0)


class PointMassParams(Params):
    """Response of a point mass to commands, and its disturbance."""

    bank_response: Literal["ideal", "rate_limited"] = param("rate_limited", "ideal: bank follows at once")
    bank_rate_deg_s: float = param(
        20.0, "largest bank rate of response rate_limited", status="published", source="S1", gt=0.0
    )
    disturbance: PathDisturbanceParams = group(PathDisturbanceParams, "disturbance of the flight-path rate")


@kernel
def bank_at(case, plant, t):
    """Bank angle (rad) at time ``t`` since the last command."""
    way = wrap(plant.bank_command - plant.bank)
    if case.point_mass.bank_response == RATE_LIMITED:
        reach = case.point_mass.bank_rate * (t - plant.bank_time)
        way = clamp(way, -reach, reach)
    return wrap(plant.bank + way)


@kernel
def command_bank(case, plant, bank, alpha):
    """Command a bank angle and an angle of attack (rad), from the present bank angle at ``plant.t``."""
    plant.bank = bank_at(case, plant, plant.t)
    plant.bank_time = plant.t
    plant.bank_command = bank
    plant.alpha = alpha


@kernel
def point_attitude(case, plant, t, rotation, place, v_rel_I, v_air_I):
    """Attitude ``q_I2B`` at time ``t`` (s) with the commanded angles; ``v_rel_I`` and ``v_air_I`` are the
    velocities relative to the planet and to the air.
    """
    up_F = ned_to_fixed(place[0], place[1], place[2], place[3], (0.0, 0.0, -1.0))
    up = rotate_z(rotation[0], -rotation[1], up_F)
    return attitude_in_wind(v_rel_I, v_air_I, up, bank_at(case, plant, t), plant.alpha)


@kernel
def point_motion(case, plant, t, y, outputs, dy):
    """Write the derivative ``dy`` of the state ``y`` (SI, I) under the loads in ``outputs``; that of attitude
    and rates is zero.
    """
    out = outputs
    q = (out.q_I2B[0], out.q_I2B[1], out.q_I2B[2], out.q_I2B[3])
    disturbance = case.point_mass.disturbance
    rate = disturbance.amplitude * sin(disturbance.frequency * t)
    spin = case.planet.rotation_rate
    r, v = take3(y, POSITION), take3(y, VELOCITY)
    along = (v[0] + spin * r[1], v[1] - spin * r[0], v[2])
    forward = unit(along)
    upward = unit(sub(r, scale(dot(r, forward), forward)))
    push = to_frame(q, scale(rate * norm(along), upward))
    specific = add(scale(1.0 / out.mass, take3(out.load_force_B, 0)), push)
    put3(out.specific_force_B, 0, specific)
    for i in range(STATES_VEHICLE):
        dy[i] = 0.0
    g = gravity(case.planet.gravity, plant.inputs, r)
    put3(out.gravity_I, 0, g)
    put3(dy, POSITION, v)
    put3(dy, VELOCITY, add(from_frame(q, specific), g))
    dy[HEAT] = out.heat_flux
