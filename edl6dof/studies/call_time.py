"""How long one call of an entry law takes: the compiled law alone, over states of the nominal flight.

Source: none, a measurement.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np

from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY, entry_guidance
from edl6dof.fsw.navigation import NAV
from edl6dof.jit import kernel
from edl6dof.sim.flight import fly
from edl6dof.sim.records import build_records
from edl6dof.sim.scenario import LoadedScenario

#: Flight times (s) at which calls are timed, and how often each.
TIMED_AT = (90.0, 110.0, 130.0, 160.0, 200.0)
REPEATS = 200


@kernel
def _repeat(law, onboards, navs, memories, work, outs, repeats):
    """Call an entry law again and again on a few states, each time with its memory as it was."""
    for _ in range(repeats):
        for j in range(navs.shape[0]):
            work[0] = memories[j]
            entry_guidance(law, onboards[0], navs[j], work[0], outs[0])


def call_time(loaded: LoadedScenario) -> float:
    """Mean time of one guidance call (us), steering and air data included, over states of the nominal flight."""
    onboard = build_records(loaded).onboard
    saved = [flight.saved for t in TIMED_AT if (flight := fly(loaded, save_at_s=t)).saved is not None]
    navs, memories = np.zeros(len(saved), NAV), np.zeros(len(saved), ENTRY_MEMORY)
    for j, state in enumerate(saved):
        navs[j], memories[j] = state.fsw["nav"][0], state.fsw["entry"][0]
    law = ENTRY_LAWS.names.index(loaded.scenario.flight_software.guidance.entry.law)
    rest = (onboard, navs, memories, np.zeros(1, ENTRY_MEMORY), np.zeros(1, GUIDE))
    _repeat(law, *rest, 1)
    start = perf_counter()
    _repeat(law, *rest, REPEATS)
    return 1e6 * (perf_counter() - start) / (REPEATS * len(saved))
