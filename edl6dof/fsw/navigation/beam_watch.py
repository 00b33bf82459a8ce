"""Whether the range or the speed of a radar beam has failed: it is refused, or the beam has no echo, in look
after look in which the others agree.

Range and speed are watched apart: ground of another shape than expected contradicts ranges, never speeds.  A
filter says of each look which it refused (``SOLUTION.ranges_refused``, ``speeds_refused``).  A look in which
most are refused isolates none of them: then the solution is wrong, or dust hides the ground from all.  Each
has a score, up by one when it is refused and down by one when it is not; at the limit it is excluded.  A
filter that goes on to compare what is excluded with what it expects has it given back once it has agreed for
long.

Source: this project.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.filters.kalman.beams import locked_beams
from edl6dof.interface.capacities import MAX_BEAMS
from edl6dof.kernels import kernel
from edl6dof.records import COUNT
from edl6dof.spatial.elementary import cos
from edl6dof.spatial.quaternion import to_frame
from edl6dof.spatial.vector import dot, scale, take3, unit


class BeamWatchParams(Params):
    """Exclusion of beams of the radar."""

    enabled: bool = param(True, "whether beams are excluded")
    refused_looks: int = param(
        30, "looks, more than it was taken in, in which a beam must have been refused", ge=1, le=10000
    )
    silent_looks: int = param(
        30, "looks on end in which it alone must have had no echo", ge=1, le=10000
    )  # fmt: skip
    silent_angle_deg: float = param(
        45.0,
        "angle to the vertical beyond which a healthy beam may have no echo: limit of incidence less a slope",
        status="estimate",
        gt=0.0,
        le=90.0,
    )
    agreed_looks: int = param(
        100, "looks on end in which it must agree again to be given back", ge=1, le=10000
    )


_SCORES = np.dtype(
    [
        ("refused", COUNT, (MAX_BEAMS,)),  # score
        ("silent", COUNT, (MAX_BEAMS,)),  # looks on end
        ("agreed", COUNT, (MAX_BEAMS,)),  # looks on end
    ],
    align=True,
)
BEAM_WATCH = np.dtype([("range", _SCORES), ("speed", _SCORES)], align=True)


@kernel
def watch_beams(params, instruments, radar, solution, health, memory):
    """Exclude ranges and speeds of beams, and give them back, after a look of the filter at the ``radar``."""
    if params.enabled != 0 and solution.looked != 0:
        n_beams = instruments.n_beams
        locked = locked_beams(radar, n_beams)
        due = steep_beams(params, instruments, solution)
        watch_readings(
            params,
            n_beams,
            locked,
            due,
            refused=solution.ranges_refused,
            healthy=health.beam_range,
            memory=memory.range,
        )
        watch_readings(
            params,
            n_beams,
            locked,
            due,
            refused=solution.speeds_refused,
            healthy=health.beam_speed,
            memory=memory.speed,
        )


@kernel
def steep_beams(params, instruments, solution):
    """Bits of the beams that meet the ground so steeply that they must have an echo."""
    q = (solution.q_I2B[0], solution.q_I2B[1], solution.q_I2B[2], solution.q_I2B[3])
    down = to_frame(q, scale(-1.0, unit(take3(solution.r_I, 0))))
    least, bits = cos(params.silent_angle), 0
    for i in range(instruments.n_beams):
        if dot(take3(instruments.beam_axis[i], 0), down) > least:
            bits |= 1 << i
    return bits


@kernel
def watch_readings(params, n_beams, locked, due, refused, healthy, memory):
    """Likewise of one kind of reading; ``locked``, ``due`` (those that must have an echo), ``refused``:
    a bit for each beam, ``healthy``: flags.
    """
    echoes = against = 0
    for i in range(n_beams):
        echoes += locked >> i & 1
        against += refused >> i & 1
    few_refused, few_silent = 2 * against <= echoes and echoes > 2, 2 * echoes >= n_beams
    for i in range(n_beams):
        if locked >> i & 1 == 0:
            memory.agreed[i] = 0
            memory.silent[i] = memory.silent[i] + 1 if few_silent and due >> i & 1 else 0
        elif refused >> i & 1:
            memory.silent[i] = memory.agreed[i] = 0
            memory.refused[i] += 1 if few_refused else 0
        else:
            memory.silent[i] = 0
            memory.refused[i] = max(memory.refused[i] - 1, 0)
            memory.agreed[i] += 1
        if memory.refused[i] >= params.refused_looks or memory.silent[i] >= params.silent_looks:
            healthy[i] = 0
            memory.refused[i] = memory.agreed[i] = 0
        elif healthy[i] == 0 and memory.agreed[i] >= params.agreed_looks:
            healthy[i] = 1
