"""A throttle that no longer moves: thrust that rests while its command goes elsewhere.

The thrust that the specific force shows is smoothed.  Where it begins to rest, what it then is above its
command is noted: the drag of the air shows as thrust, a weak engine gives less, a thruster stuck on gives
more.  If the command moves away from there and the thrust stays, the throttle stands: any other engine would
follow, by the share of the command that it gives.  That is believed for good, and the thrust followed from
then on whenever it rests.

Source: this project.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.estimation.engine_shortfall import RESTS
from edl6dof.jit import kernel


class HeldThrustParams(Params):
    """Belief in a throttle that stands."""

    lag_s: float = param(0.2, "lag with which the measured thrust is smoothed", status="estimate", gt=0.0)
    settled_s: float = param(1.0, "time for which the thrust has to stay behind", status="estimate", ge=0.0)
    believed_from: float = param(
        0.15,
        "change of the command, over it, that the thrust has not followed, from which it is believed",
        status="estimate",
        gt=0.0,
    )


HELD_THRUST = np.dtype(
    [
        ("smoothed", "f8"),  # N: measured thrust
        ("reference", "f8"),  # N: where it began to rest
        ("offset", "f8"),  # N: how far it was above its command there
        ("stayed", "f8"),  # s: for how long it has not followed
        ("held", "f8"),  # N: thrust of the throttle that stands; 0: it moves
    ],
    align=True,
)


@kernel
def held_thrust(params, commanded, measured, dt, memory):
    """Thrust (N) of a throttle that is believed to stand; 0 while there is none.

    Args:
        params: ``HeldThrustParams`` record.
        commanded: thrust of all engines that burn, N; 0: none burns.
        measured: thrust that the specific force shows, N.
        dt: since the last call, s.
        memory: ``HELD_THRUST`` record, updated.
    """
    if commanded <= 0.0:
        memory.smoothed = memory.reference = memory.stayed = 0.0
        return memory.held
    memory.smoothed += (1.0 - exp(-dt / params.lag)) * (measured - memory.smoothed)
    above = memory.smoothed - commanded
    if abs(memory.smoothed - memory.reference) > RESTS * memory.reference:
        memory.reference, memory.offset, memory.stayed = memory.smoothed, above, 0.0
    elif memory.held > 0.0 or abs(above - memory.offset) > params.believed_from * commanded:
        memory.stayed += dt
        if memory.stayed >= params.settled:
            memory.held = memory.smoothed
    else:
        memory.stayed = 0.0
    return memory.held
