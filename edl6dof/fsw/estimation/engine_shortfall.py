"""Loss of engine thrust: the thrust that the specific force shows, against the one commanded.

While the commanded thrust rests, the ratio of both is taken with a first-order lag.  The air that slows the
lander shows as thrust and hides a little of the loss; no more than all of the commanded thrust is ever
believed.  A loss is believed from a bound on that dispersed masses and thrusts of healthy engines stay below,
and followed from then on, until other engines burn.

Source: this project; a bias of the thrust estimated from accelerometers: Crassidis and Junkins, Optimal
Estimation of Dynamic Systems (2011), section 5.3, with the first-order lag as its steady gain.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import clamp

#: Change of the commanded thrust, over it, up to which it rests.
RESTS = 0.05


class EngineShortfallParams(Params):
    """Belief in a loss of thrust."""

    settled_s: float = param(
        1.0,
        "time for which the command has to rest before the thrust is looked at",
        status="estimate",
        ge=0.0,
    )
    lag_s: float = param(0.5, "lag with which the loss is followed", status="estimate", gt=0.0)
    believed_from: float = param(
        0.1,
        "loss, over the commanded thrust, from which it is believed; 1: never",
        status="estimate",
        gt=0.0,
        le=1.0,
    )
    most: float = param(0.5, "largest loss that is believed", status="estimate", ge=0.0, lt=1.0)


ENGINE_SHORTFALL = record(
    ("commanded", "f8"),  # N: where the command began to rest
    ("rested", "f8"),  # s: for how long it has
    ("loss", "f8"),  # of the commanded thrust, followed
    ("believed", FLAG),
)


@kernel
def engine_shortfall(params, commanded, measured, dt, memory):
    """Loss of thrust over the commanded one that is believed, 0 while there is none.

    Args:
        params: ``EngineShortfallParams`` record.
        commanded: thrust of all engines that burn, N; 0: none burns.
        measured: thrust that the specific force shows, N.
        dt: since the last call, s.
        memory: ``ENGINE_SHORTFALL`` record, updated.
    """
    if commanded <= 0.0:
        memory.commanded = memory.rested = memory.loss = 0.0
        memory.believed = 0
        return 0.0
    memory.rested += dt
    if abs(commanded - memory.commanded) > RESTS * commanded:
        memory.commanded, memory.rested = commanded, 0.0
    elif memory.rested >= params.settled:
        seen = 1.0 - measured / commanded
        memory.loss += (1.0 - exp(-dt / params.lag)) * (seen - memory.loss)
        if memory.loss >= params.believed_from:
            memory.believed = 1
    return clamp(memory.loss, 0.0, params.most) if memory.believed != 0 else 0.0
