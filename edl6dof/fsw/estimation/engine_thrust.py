"""Engine thrust that the specific force shows, against the one commanded: loss of thrust, and stuck throttle.

Loss of thrust: while the commanded thrust rests, the ratio of both is taken with a first-order lag.  The air
that slows the lander shows as thrust and hides a little of the loss; no more than all of the commanded thrust
is ever believed.  A loss is believed from a bound on that dispersed masses and thrusts of healthy engines
stay below, and followed from then on, until other engines burn.

Stuck throttle: the measured thrust stays constant while its command falls.  The measured thrust is smoothed.
Where it rests, it is noted together with the command at which it came to rest, and later changes of the
command are compared with it.  Thrust that follows the command from there, even by a share of it, is noted
again: a weak engine gives less, and the drag of the air or a thruster that is stuck on adds to the measured
thrust.  Where the command has fallen and the thrust rests, the throttle is stuck.  A throttle that stops on
its way down to the end of its band has followed a share, and its command falls no more: it is stuck where the
thrust rests above its command by more than drag and thrusters can hold of the weight.  Either is believed for
good, and the thrust is followed from then on whenever it rests.  A command that rises and is not followed
says less: a weak engine does the same.

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
        1.0, "time for which the command must rest before the thrust is looked at", status="estimate", ge=0.0
    )
    lag_s: float = param(0.5, "lag with which the loss is followed", status="estimate", gt=0.0)
    believed_from: float = param(
        0.1, "loss, over the command, from which it is believed; 1: never", status="estimate", gt=0.0, le=1.0
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
    """Loss of thrust, over the commanded one, that is believed; 0 while there is none.

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


#: Share of a change of the command that thrust has to follow to count as one that moves.
FOLLOWS = 0.35


class StuckThrottleParams(Params):
    """Belief in a throttle that is stuck."""

    lag_s: float = param(0.2, "lag with which the measured thrust is smoothed", status="estimate", gt=0.0)
    settled_s: float = param(1.0, "time for which the thrust has to stay behind", status="estimate", ge=0.0)
    believed_from: float = param(
        0.2, "unfollowed fall of the command, over it, from which it is believed", status="estimate", gt=0.0
    )
    over_from: float = param(
        0.4,
        "thrust above its command, over the weight, from which it is believed: more than all axial thrusters "
        "and the drag without a canopy, less than an engine at the lower end of its band has over it if it "
        "stops the lander in the air",
        status="estimate",
        gt=0.0,
    )


STUCK_THROTTLE = record(
    ("smoothed", "f8"),  # N: measured thrust
    ("resting", "f8"),  # N: where it began to rest
    ("meanwhile", "f8"),  # N: and its command then
    ("rested", "f8"),  # s: for how long it has
    ("stayed", "f8"),  # s: and for how long away from its command
    ("reference", "f8"),  # N: thrust that was noted
    ("asked", "f8"),  # N: and its command
    ("held", "f8"),  # N: thrust of the stuck throttle; 0: it moves
)


@kernel
def stuck_throttle(params, commanded, measured, full, weight, dt, memory):
    """Return the thrust (N) of a throttle that is believed to be stuck; 0 while there is none.

    Args:
        params: ``StuckThrottleParams`` record.
        commanded, measured: as of :func:`engine_shortfall`, N.
        full: thrust of all engines that burn at full level, N.
        weight: of the lander, N.
        dt: since the last call, s.
        memory: ``STUCK_THROTTLE`` record, updated.
    """
    if commanded <= 0.0:
        memory.smoothed = memory.resting = memory.reference = memory.rested = memory.stayed = 0.0
        return memory.held
    if memory.reference == 0.0:
        memory.reference = memory.asked = commanded
    memory.smoothed += (1.0 - exp(-dt / params.lag)) * (measured - memory.smoothed)
    memory.rested += dt
    memory.stayed += dt
    if abs(memory.smoothed - memory.resting) > RESTS * memory.resting:
        memory.resting, memory.meanwhile = memory.smoothed, commanded
        memory.rested = memory.stayed = 0.0
    fallen, followed = memory.asked - commanded, memory.reference - memory.smoothed
    left_behind = fallen > params.believed_from * commanded and followed < FOLLOWS * fallen
    above = min(memory.smoothed, full) - commanded > params.over_from * weight
    away = memory.held > 0.0 or left_behind or above
    if not away:
        memory.stayed = 0.0
    if memory.stayed >= params.settled:
        memory.held = memory.smoothed
    moved = abs(memory.smoothed - memory.reference) > RESTS * memory.reference
    if moved and not away and memory.rested >= params.settled:
        memory.reference, memory.asked = memory.smoothed, memory.meanwhile
    return memory.held
