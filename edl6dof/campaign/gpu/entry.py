"""What a thread of the GPU runs: one flight.

The loop and all that it calls are the processor's: numba-cuda makes a device function of each kernel that it
meets, and of families it sees the static chain alone (:mod:`edl6dof.dispatch`).
"""

from __future__ import annotations

from numba import cuda

import edl6dof.campaign.gpu.apart  # noqa: F401  said to the compiler
from edl6dof.metrics.telling_rows import keep_telling
from edl6dof.sim.loop import fly
from edl6dof.sim.outcome import FLYING

#: Beside the outcomes of the loop: a flight with more rows that figures need than there is room for.
CROWDED = -1


@cuda.jit
def fly_flights(
    cases, onboards, which_onboard, tables_, which_tables, plants, outputs_, peaks_, works, sensors_,
    memories, cycles, outcomes, rows, count, steps, log, brief, needs, which_needs, keep, room,
):  # fmt: skip
    """Fly ``count`` base cycles of the flight of this thread, if it still flies.

    Each record array has an element for each flight; but ``onboards``, ``tables_`` and ``needs`` one for
    each that differs, of which ``which_onboard``, ``which_tables`` and ``which_needs`` say whose is whose.
    ``log`` or ``brief`` has a line of rows for each flight; the lines of the other are empty.  ``cycles``,
    ``outcomes`` and ``rows`` (base cycle that each is at, outcome code, rows logged) are updated.

    ``keep`` has a flag for each row of ``brief``, or none: with them, rows that no figure needs are dropped,
    and a flight with less ``room`` than so many rows stops as ``CROWDED``.
    """
    i = cuda.grid(1)
    if i < len(plants) and outcomes[i] == FLYING:
        if keep.shape[1] > 0 and rows[i] + room > keep.shape[1]:
            outcomes[i] = CROWDED
            return
        told, read = which_onboard[i], which_tables[i]
        outcomes[i], flown, new = fly(
            cases[i : i + 1], onboards[told : told + 1], tables_[read : read + 1], plants[i : i + 1],
            outputs_[i : i + 1], peaks_[i : i + 1], works[i : i + 1], sensors_[i : i + 1],
            memories[i : i + 1], cycles[i], cycles[i] + count, min(cycles[i], 1), steps,
            log[i], brief[i], rows[i],
        )  # fmt: skip
        cycles[i] += flown
        rows[i] += new
        if keep.shape[1] > 0:
            rows[i] = keep_telling(needs[which_needs[i]], plants[i], brief[i], rows[i], keep[i])
