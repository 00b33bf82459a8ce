"""Comparison of measured and commanded engine thrust, which detects a loss of thrust and a stuck throttle.

Loss of thrust: while the commanded thrust is steady, the ratio of measured to commanded thrust is filtered
with a first-order lag. The drag of the lander counts as thrust and hides a part of the loss; a thrust above
the command counts as no loss. A loss is accepted when it exceeds a bound that healthy engines with dispersed
masses and thrusts do not reach. From then on the filtered loss is used, until the engines stop.

Stuck throttle: the smoothed measured thrust stays constant although its command falls. When the measured
thrust is steady, thrust and command are stored as a reference for later changes. If the thrust then follows a
change of the command, even in part, the reference is renewed, because a weak engine follows only in part, and
drag or a thruster stuck on adds to the measured thrust. If the command has fallen and the thrust is steady,
the throttle is stuck. A throttle that stops on its way to the lower end of its band has followed in part, and
its command falls no further. It counts as stuck if the steady thrust exceeds the command by a share of the
weight that drag and thrusters cannot explain. In both cases the throttle counts as stuck until the end of the
flight, and the estimated thrust is updated whenever the measured thrust is steady. A command that rises
without effect is no evidence: a weak engine shows the same.

Source: this project; a bias of the thrust estimated from accelerometers: Crassidis and Junkins, Optimal
Estimation of Dynamic Systems (2011), section 5.3, with the first-order lag as its steady gain.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.vector import clamp

#: Relative change up to which a thrust counts as steady.
RESTS = 0.05


class EngineShortfallParams(Params):
    """Belief in a loss of thrust."""

    settled_s: float = param(
        1.0, "time of steady command before the thrust is evaluated", status="estimate", ge=0.0
    )
    lag_s: float = param(0.5, "lag of the filtered loss", status="estimate", gt=0.0)
    believed_from: float = param(
        0.1, "relative loss of thrust from which it is accepted; 1: never", status="estimate", gt=0.0, le=1.0
    )
    most: float = param(0.5, "largest loss that is accepted", status="estimate", ge=0.0, lt=1.0)


ENGINE_SHORTFALL = record(
    ("commanded", "f8"),  # N: command when it became steady
    ("rested", "f8"),  # s: for how long the command has been steady
    ("loss", "f8"),  # filtered, over the commanded thrust
    ("believed", FLAG),
)


@kernel
def engine_shortfall(params, commanded, measured, dt, memory):
    """Return the believed loss of thrust, over the commanded thrust; 0 while none is believed.

    Args:
        params: ``EngineShortfallParams`` record.
        commanded: axial thrust commanded of all burning engines, N; 0: none burns.
        measured: axial thrust by the measured specific force, N.
        dt: time since the last call, s.
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


#: Change of the thrust, over that of the command, from which the throttle counts as moving.
FOLLOWS = 0.35


class StuckThrottleParams(Params):
    """Belief in a throttle that is stuck."""

    lag_s: float = param(0.2, "lag with which the measured thrust is smoothed", status="estimate", gt=0.0)
    settled_s: float = param(
        1.0, "duration of the deviation after which the throttle is judged stuck", status="estimate", ge=0.0
    )
    believed_from: float = param(
        0.2,
        "fall of the command without effect on the thrust, divided by the present command, "
        "from which the throttle is judged stuck",
        status="estimate",
        gt=0.0,
    )
    over_from: float = param(
        0.4,
        "excess of the thrust over its command, divided by the weight, from which the "
        "throttle is judged stuck: more than axial thrusters and drag without a canopy give, "
        "less than an engine stuck at the lower end of its band has if it stops the lander in"
        " the air",
        status="estimate",
        gt=0.0,
    )


STUCK_THROTTLE = record(
    ("smoothed", "f8"),  # N: measured thrust
    ("resting", "f8"),  # N: measured thrust when it became steady
    ("meanwhile", "f8"),  # N: command at that time
    ("rested", "f8"),  # s: for how long the measured thrust has been steady
    ("stayed", "f8"),  # s: for how long it has also deviated from its command
    ("reference", "f8"),  # N: stored steady thrust
    ("asked", "f8"),  # N: its command
    ("held", "f8"),  # N: thrust of the stuck throttle; 0: it moves
)


@kernel
def stuck_throttle(params, commanded, measured, full, weight, dt, memory):
    """Return the thrust (N) of a throttle that is believed to be stuck; 0 while there is none.

    Args:
        params: ``StuckThrottleParams`` record.
        commanded, measured: as for :func:`engine_shortfall`, N.
        full: thrust of all burning engines at full level, N.
        weight: weight of the lander, N.
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
