"""Ground tracking: the state that the ground has determined and sends up once before entry, in the first
cycle; its error is drawn for each case.

Source: radial, along-track and cross-track axes as in Vallado, Fundamentals of Astrodynamics and Applications
(2013), section 3.3.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, Vec3, param
from edl6dof.config.dtype import in_si
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.registry import Member
from edl6dof.spatial.random_numbers import Stream
from edl6dof.spatial.vector import add, along_track, put3, take3
from edl6dof.vehicle.plant import POSITION, VELOCITY


class GroundTrackingParams(Params):
    """Ground tracking; standard deviations along the radius, along the track and across it."""

    largest = {"m": 1e6}

    position_m: Vec3 = param((300.0, 500.0, 300.0), "standard deviations of the position", status="estimate")
    velocity_m_s: Vec3 = param((0.4, 0.4, 0.4), "standard deviations of the velocity", status="estimate")


#: The error of this case: radial, along-track, cross-track.
UNIT = record(("position", "f8", (3,)), ("velocity", "f8", (3,)))
MEMORY = record(("sent", FLAG))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Send the state up in the first cycle."""
    tracking = sensed.tracking
    tracking.fresh = 1 - memory.sent
    if memory.sent == 0:
        r, v = take3(plant.y, POSITION), take3(plant.y, VELOCITY)
        put3(tracking.r_I, 0, add(r, along_track(r, v, take3(unit.position, 0))))
        put3(tracking.v_I, 0, add(v, along_track(r, v, take3(unit.velocity, 0))))
        memory.sent = 1


def plan(params: GroundTrackingParams, rng: Stream, unit: np.void) -> None:
    """Draw the error of this case."""
    given = in_si(params)
    unit["position"] = given["position"] * rng.standard_normal(3)
    unit["velocity"] = given["velocity"] * rng.standard_normal(3)


MEMBER = Member(
    "ground_tracking",
    GroundTrackingParams,
    {"measure": measure},
    "Vallado, Fundamentals of Astrodynamics and Applications (2013), section 3.3",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("tracking",),
)
