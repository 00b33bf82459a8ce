"""Errors of a navigation that is not simulated: constant errors of position, velocity and specific force, and
noise of the specific force, on top of ideal instruments.

For guidance studies: of a point mass, which has no body to carry instruments, and of a rigid body with the
set ``perfect``. The errors are those of one flight; a campaign disperses them. Left out: errors of attitude
and rate, and the growth of navigation errors as accelerations are integrated. Source: none, the simplest
error there is.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, Vec3, param
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.vector import add, along_track, put3, take3
from edl6dof.vehicle.plant import POSITION, VELOCITY


class NavigationErrorParams(Params):
    """Errors on top of ideal instruments; along the radius, along the track and across it."""

    largest = {"m": 1e6}

    position_m: Vec3 = param((0.0, 0.0, 0.0), "error of the position")
    velocity_m_s: Vec3 = param((0.0, 0.0, 0.0), "error of the velocity")
    force_scale: float = param(0.0, "relative error of the specific force", gt=-1.0, le=1.0)
    force_noise_m_s2: float = param(
        0.0, "noise of each axis of the specific force, standard deviation of a reading", ge=0.0
    )


UNIT = record(("key", "i8"))
MEMORY = record(("cycle", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Add the errors to the readings of the ideal instruments, which come before in ``sensors.carried``."""
    r, v = take3(plant.y, POSITION), take3(plant.y, VELOCITY)
    put3(sensed.r_I, 0, add(r, along_track(r, v, take3(params.position, 0))))
    put3(sensed.v_I, 0, add(v, along_track(r, v, take3(params.velocity, 0))))
    x, y = normal_pair(unit.key, 2 * memory.cycle)
    z, _ = normal_pair(unit.key, 2 * memory.cycle + 1)
    memory.cycle += 1
    noise = (x, y, z)
    for i in range(3):
        true = outputs.specific_force_B[i]
        sensed.specific_force_B[i] = (1.0 + params.force_scale) * true + params.force_noise * noise[i]


def plan(params: NavigationErrorParams, rng: Stream, unit: np.void) -> None:
    """Draw the key of the noise."""
    unit["key"] = rng.keys()


MEMBER = Member(
    "navigation_error",
    NavigationErrorParams,
    {"measure": measure},
    "constant errors and white noise",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("r_I", "v_I", "specific_force_B"),
)
