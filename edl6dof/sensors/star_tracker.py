"""Star trackers: the attitude, in cycles in which they see stars, with noise and an error of alignment.

They see stars above an altitude, until an event of the mission if one is named, while the body turns slowly
enough.  Noise is larger about the boresight than across it.  A fault turns the attitude about the diagonal
of the axes of B.

Source: Liebe, IEEE Transactions on Aerospace and Electronic Systems 38(2), 2002.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import Capacity, Hardware, param, unique_names
from edl6dof.config.dtype import in_si
from edl6dof.interface.capacities import MAX_TRACKERS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT, record
from edl6dof.registry import Member
from edl6dof.sensors.counters import SenseAxis
from edl6dof.spatial.quaternion import multiply, normalise
from edl6dof.spatial.random_numbers import Stream, normal_pair
from edl6dof.spatial.vector import add, dot, norm, put4, scale, sub, take3
from edl6dof.vehicle.plant import OUTAGE, RATE, STUCK, take_attitude

#: Component of the diagonal of the axes of B along each of them.
_DIAGONAL = 1.0 / sqrt(3.0)


def one_head() -> list[SenseAxis]:
    """One star tracker, s1, that looks along -z of B."""
    return [SenseAxis(name="s1", axis=(0.0, 0.0, -1.0))]


class StarTrackerParams(Hardware):
    """Star trackers of one kind; errors as standard deviations."""

    heads: Annotated[list[SenseAxis], Capacity(MAX_TRACKERS)] = param(
        None, "the star trackers and their lines of sight", factory=one_head, min_length=1,
        max_length=MAX_TRACKERS,
    )  # fmt: skip
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

    _names_differ = field_validator("heads")(unique_names)


#: Errors of the trackers in this case: alignment of each, a small rotation in B (rad), and key of its noise;
#: and the number of the event that ends their view, counted from one; zero for none.
UNIT = record(
    ("misalignment", "f8", (MAX_TRACKERS, 3)),
    ("key", "i8", (MAX_TRACKERS,)),
    ("until", "i8"),
)
MEMORY = record(("cycle", COUNT))


@kernel
def measure(params, unit, case, tables, plant, outputs, memory, sensed):
    """Measure the present attitude, in cycles in which stars are seen."""
    stars, y, cycle = sensed.stars, plant.y, memory.cycle
    memory.cycle += 1
    over = unit.until > 0 and plant.t >= plant.done[unit.until - 1]
    sees = cycle % params.every_cycles == 0 and not over
    sees = sees and outputs.altitude >= params.lowest and norm(take3(y, RATE)) <= params.rate
    for i in range(params.n_heads):
        fault = plant.instruments.stars[i]
        stars.valid[i] = 1 if sees and fault.mode != OUTAGE else 0
        held = fault.mode == STUCK and stars.q_I2B[i, 0] != 0.0
        if stars.valid[i] != 0 and not held:
            off = add(take3(unit.misalignment[i], 0), noise(params, unit, i, cycle))
            wrong = fault.offset
            if fault.noise > 0.0:
                wrong += fault.noise * normal_pair(unit.key[i], -1 - cycle)[0]
            wrong *= _DIAGONAL
            off = add(off, (wrong, wrong, wrong))
            q = normalise(multiply(take_attitude(y), (1.0, 0.5 * off[0], 0.5 * off[1], 0.5 * off[2])))
            put4(stars.q_I2B[i], q)


@kernel
def noise(params, unit, head, cycle):
    """Small rotation (rad, B) by which the reading of a head errs in this cycle."""
    a, b = normal_pair(unit.key[head], 2 * cycle)
    c, about = normal_pair(unit.key[head], 2 * cycle + 1)
    boresight = take3(params.heads[head].axis, 0)
    across = scale(params.noise, (a, b, c))
    across = sub(across, scale(dot(across, boresight), boresight))
    return add(across, scale(params.boresight_noise * about, boresight))


def plan(params: StarTrackerParams, rng: Stream, unit: np.void) -> None:
    """Draw the alignment errors of this case."""
    sigma = in_si(params)["misalignment"]
    for head in range(len(params.heads)):
        unit["misalignment"][head] = sigma * rng.standard_normal(3)
        unit["key"][head] = rng.keys()


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
