"""How long one call of a powered law takes: the compiled law alone, over states of the nominal descent.

Source: none, a measurement.
"""

from __future__ import annotations

from time import thread_time

import numpy as np

from edl6dof.fsw.functions import software_functions
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.target import POWERED_TARGET
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.jit import kernel
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.scenario.records import build_records
from edl6dof.sim.flight import fly
from edl6dof.sim.underway import Moment, moments_at

#: Times (s) of the states after backshell release; the calls come later by what a law takes to plan again.
SAVED_AFTER_S, LATER_S = (3.0, 11.0, 19.0, 27.0), 1.0
REPEATS, BLOCKS = 20, 10


@kernel
def _repeat(functions, onboards, states, navs, targets, memories, work, outs, repeats):
    """Call a powered law again and again on one state, each time with its memory as it was."""
    powered = onboards[0].guidance.powered
    for _ in range(repeats):
        work[0] = memories[0]
        functions.powered_law(powered, onboards[0].vehicle, states[0], navs[0], targets[0], work[0], outs[0])


def call_time(loaded: LoadedScenario) -> float:
    """Longest processor time (us) of a guidance call over states of the nominal descent: what a law remembers
    is one second old, so that one that plans now and then plans in the call.
    """
    onboard = build_records(loaded).onboard
    released = fly(loaded).metrics["backshell_s"]
    times = [released + after + later for after in SAVED_AFTER_S for later in (0.0, LATER_S)]
    moments = moments_at(loaded, times)
    if len(moments) < len(times):
        raise ValueError(f"the nominal flight is over before {times[len(moments)]:g} s")
    pairs = zip(moments[::2], moments[1::2], strict=True)
    return max(_timed(onboard, before, after) for before, after in pairs)


def _timed(onboard: np.ndarray, before: Moment, after: Moment) -> float:
    states, navs, targets, memories = (
        np.zeros(1, dtype) for dtype in (VEHICLE_STATE, NAV, POWERED_TARGET, POWERED_LAWS.memory)
    )
    states[0], navs[0] = after.fsw["vehicle"][0], after.fsw["nav"][0]
    targets[0], memories[0] = before.fsw["guidance"]["target"][0], before.fsw["guidance"]["powered"][0]
    given = (software_functions(onboard[0]), onboard, states, navs, targets, memories)
    rest = (np.zeros(1, POWERED_LAWS.memory), np.zeros(1, GUIDE))
    _repeat(*given, *rest, 1)
    blocks = []
    for _ in range(BLOCKS):
        start = thread_time()
        _repeat(*given, *rest, REPEATS)
        blocks.append(thread_time() - start)
    return 1e6 * min(blocks) / REPEATS
