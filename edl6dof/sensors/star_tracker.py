"""Star tracker: the attitude, in cycles in which it sees stars, with noise and the error of its alignment.

It sees stars above an altitude, until an event of the mission if one is named, while the body turns slowly
enough.  Noise is larger about the boresight than across it.

Source: Liebe, IEEE Transactions on Aerospace and Electronic Systems 38(2), 2002.
"""

from __future__ import annotations

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import Hardware, Vec3, param, unit_vector
from edl6dof.config.dtype import in_si
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.spatial.quaternion import multiply, normalise
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.vector import add, dot, norm, scale, sub, take3
from edl6dof.vehicle.plant import RATE, take_attitude


class StarTrackerParams(Hardware):
    """Star tracker; errors as standard deviations."""

    boresight: Vec3 = param(
        (0.0, 0.0, -1.0), "unit vector of the line of sight in B", status="estimate", min_length=3
    )
    noise_arcsec: float = param(
        8.0, "noise about each axis across the boresight", status="estimate", ge=0.0, le=36000.0
    )
    boresight_noise_arcsec: float = param(
        24.0, "noise about the boresight", status="estimate", ge=0.0, le=36000.0
    )
    misalignment_arcsec: float = param(
        10.0, "error of alignment about each axis, drawn for each case", status="estimate", ge=0.0, le=36000.0
    )
    every_cycles: int = param(5, "base cycles from one reading to the next", status="estimate", ge=1, le=1000)
    lowest_m: float = param(
        118e3, "altitude below which it sees no stars", status="estimate", ge=-1e4, le=1e9
    )
    until: str | None = param(
        None,
        "event of the mission after which it sees no stars: it is covered, or leaves with a part",
        status="estimate",
        record=False,
        max_length=60,
    )
    rate_deg_s: float = param(3.0, "largest rate at which it sees stars", status="estimate", gt=0.0, le=1e4)

    _unit_length = field_validator("boresight")(unit_vector)


#: Errors of the tracker in this case: its alignment, a small rotation in B (rad), and the key of its noise;
#: and the number of the event that ends its view, counted from one; zero for none.
UNIT = record(("misalignment", "f8", (3,)), ("key", "i8"), ("until", "i8"))
MEMORY = record(("cycle", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Measure the present attitude, in cycles in which stars are seen."""
    stars, y, cycle = sensed.stars, plant.y, memory.cycle
    memory.cycle += 1
    over = unit.until > 0 and plant.t >= plant.done[unit.until - 1]
    due = cycle % params.every_cycles == 0 and plant.instruments.star_tracker_lost == 0 and not over
    stars.valid = 0
    if due and outputs.altitude >= params.lowest and norm(take3(y, RATE)) <= params.rate:
        off = add(take3(unit.misalignment, 0), noise(params, unit, cycle))
        true = take_attitude(y)
        q = normalise(multiply(true, (1.0, 0.5 * off[0], 0.5 * off[1], 0.5 * off[2])))
        for i in range(4):
            stars.q_I2B[i] = q[i]
        stars.valid = 1


@kernel
def noise(params, unit, cycle):
    """Small rotation (rad, B) by which the reading of this cycle errs."""
    a, b = normal_pair(unit.key, 2 * cycle)
    c, about = normal_pair(unit.key, 2 * cycle + 1)
    boresight = take3(params.boresight, 0)
    across = scale(params.noise, (a, b, c))
    across = sub(across, scale(dot(across, boresight), boresight))
    return add(across, scale(params.boresight_noise * about, boresight))


def plan(params: StarTrackerParams, rng: Stream, unit: np.void) -> None:
    """Draw the alignment error of this case."""
    unit["misalignment"] = in_si(params)["misalignment"] * rng.standard_normal(3)
    unit["key"] = rng.keys()


MEMBER = Member(
    "star_tracker",
    StarTrackerParams,
    {"measure": measure},
    "Liebe, IEEE Transactions on Aerospace and Electronic Systems 38(2), 2002",
    memory=MEMORY,
    tables=UNIT,
    plan=plan,
    writes=("stars",),
)
