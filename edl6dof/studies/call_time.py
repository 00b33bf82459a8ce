"""How long one call of an entry law takes: the compiled law alone, over states of the nominal flight.

Source: none, a measurement.
"""

from __future__ import annotations

from time import thread_time

import numpy as np

from edl6dof.fsw.functions import software_functions
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.entry.registry import ENTRY_MEMORY, entry_guidance
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.jit import kernel
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.scenario.records import build_records
from edl6dof.sim.underway import moments_at

#: Flight times (s) at which calls are timed, and how often each.
TIMED_AT = (90.0, 110.0, 130.0, 160.0, 200.0)
REPEATS = 20
#: Blocks of calls of which the quickest counts: the others were disturbed by whatever else the machine does.
BLOCKS = 15


@kernel
def _repeat(functions, onboards, navs, memories, work, outs, repeats):
    """Call an entry law again and again on a few states, each time with its memory as it was."""
    for _ in range(repeats):
        for j in range(navs.shape[0]):
            work[0] = memories[j]
            entry_guidance(functions, onboards[0], navs[j], work[0], outs[0])


def call_time(loaded: LoadedScenario) -> float:
    """Mean processor time of one guidance call (us) over states of the nominal flight, steering and air data
    included.
    """
    onboard = build_records(loaded).onboard
    saved = moments_at(loaded, TIMED_AT)
    navs, memories = np.zeros(len(saved), NAV), np.zeros(len(saved), ENTRY_MEMORY)
    for j, state in enumerate(saved):
        navs[j], memories[j] = state.fsw["nav"][0], state.fsw["guidance"]["entry"][0]
    functions = software_functions(onboard[0])
    rest = (onboard, navs, memories, np.zeros(1, ENTRY_MEMORY), np.zeros(1, GUIDE))
    _repeat(functions, *rest, 1)
    blocks = []
    for _ in range(BLOCKS):
        start = thread_time()
        _repeat(functions, *rest, REPEATS)
        blocks.append(thread_time() - start)
    return 1e6 * min(blocks) / (REPEATS * len(saved))
