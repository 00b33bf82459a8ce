"""Whether a beam of the radar has failed: it is refused, or has no echo, in look after look in which the
others agree.

A filter says of each look which beams it refused (``SOLUTION.beams_refused``).  A look in which most beams
are refused isolates none of them: then the solution is wrong, or dust hides the ground from all.  Each beam
has a score, up by one when it is refused and down by one when it is not; at the limit it is excluded.  A
filter that goes on to compare an excluded beam with what it expects has it given back once it has agreed for
long.

Source: this project.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.interface.capacities import MAX_BEAMS
from edl6dof.jit import kernel
from edl6dof.records import COUNT


class BeamWatchParams(Params):
    """Exclusion of beams of the radar."""

    enabled: bool = param(True, "whether beams are excluded")
    refused_looks: int = param(
        30, "looks, more than it was taken in, in which a beam must have been refused", ge=1, le=10000
    )
    silent_looks: int = param(
        30, "looks on end in which it alone must have had no echo", ge=1, le=10000
    )  # fmt: skip
    agreed_looks: int = param(
        100, "looks on end in which it must agree again to be given back", ge=1, le=10000
    )


BEAM_WATCH = np.dtype(
    [
        ("refused", COUNT, (MAX_BEAMS,)),  # score
        ("silent", COUNT, (MAX_BEAMS,)),  # looks on end
        ("agreed", COUNT, (MAX_BEAMS,)),  # looks on end
    ],
    align=True,
)


@kernel
def watch_beams(params, n_beams, radar, solution, health, memory):
    """Exclude beams, and give them back, after a look of the filter at the ``radar``."""
    if params.enabled == 0 or solution.looked == 0:
        return
    locked = refused = 0
    for i in range(n_beams):
        locked += radar.locked[i]
        refused += solution.beams_refused >> i & 1
    few_refused, few_silent = 2 * refused <= locked and locked > 2, 2 * locked >= n_beams
    for i in range(n_beams):
        if radar.locked[i] == 0:
            memory.agreed[i] = 0
            memory.silent[i] = memory.silent[i] + 1 if few_silent else 0
        elif solution.beams_refused >> i & 1:
            memory.silent[i] = memory.agreed[i] = 0
            memory.refused[i] += 1 if few_refused else 0
        else:
            memory.silent[i] = 0
            memory.refused[i] = max(memory.refused[i] - 1, 0)
            memory.agreed[i] += 1
        if memory.refused[i] >= params.refused_looks or memory.silent[i] >= params.silent_looks:
            health.beam[i] = 0
            memory.refused[i] = memory.agreed[i] = 0
        elif health.beam[i] == 0 and memory.agreed[i] >= params.agreed_looks:
            health.beam[i] = 1
