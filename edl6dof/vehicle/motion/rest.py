"""Rest on the ground: neither sliding nor rocking.

A rocking vehicle stands still for an instant at each end of its swing, so rest is judged over a while.
"""

from __future__ import annotations

from math import radians

from edl6dof.kernels import kernel
from edl6dof.spatial.vector import norm, take3
from edl6dof.vehicle.plant import POSITION, RATE, VELOCITY

#: Speed (m/s) over the ground and body rate (rad/s) of a vehicle at rest.  Friction that is smooth in speed
#: lets one on a slope creep by up to 0.01 m/s.
REST_SPEED, REST_RATE = 0.05, radians(1.0)


@kernel
def ground_speed(spin, y):
    """Speed (m/s) in the state ``y``, relative to a planet that spins at ``spin`` (rad/s)."""
    r, v = take3(y, POSITION), take3(y, VELOCITY)
    return norm((v[0] + spin * r[1], v[1] - spin * r[0], v[2]))


@kernel
def note_motion(case, plant):
    """Note the time of the present state if the vehicle is not at rest in it."""
    y = plant.y
    if ground_speed(case.planet.rotation_rate, y) > REST_SPEED or norm(take3(y, RATE)) > REST_RATE:
        plant.moved_time = plant.t
