"""Whether all that the flight computer works with is finite, asked in every cycle; and what was not finite
first.

Comparisons with what is not a number are false: no trigger fires and no limit is exceeded; nothing but this
look would end such a flight.
"""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.mission.sequencer import SEQUENCE
from edl6dof.fsw.onboard import FSW
from edl6dof.interface.command import COMMAND
from edl6dof.interface.sensed import SENSED
from edl6dof.jit import kernel
from edl6dof.records import first_not_finite, offset
from edl6dof.sensors.registry import SENSORS
from edl6dof.vehicle.plant import STATE_NAMES

#: Exponent of a number that is infinite or none, its lowest bit, and the sign.
_EXPONENT, _LOWEST, _SIGN = (
    np.uint64(0x7FF0_0000_0000_0000),
    np.uint64(0x0010_0000_0000_0000),
    np.uint64(0x8000_0000_0000_0000),
)


def _words(layout: np.dtype, first: str, last: str, base: int = 0) -> tuple[int, int]:
    """Eight-byte words of a record from one field through another; whole numbers between are never negative,
    and so look finite.
    """
    start, end = offset(layout, first), offset(layout, last) + layout[last].itemsize
    return (base + start) // 8, (base + end) // 8


#: Fields of the state that follow from the outputs.
_FROM_OUTPUTS = ("inputs",)
#: What is looked at in every cycle: whatever is wrong with the vehicle shows in what it senses or in its
#: state, and whatever is wrong with the memory of the flight computer in what guidance, control and
#: modulation make of it.  Images, which stand behind, are finite whatever the vehicle does: an eye that meets
#: nothing reads 0.
_SENSED = _words(SENSED, "t", "branch_used", offset(SENSORS, "sensed"))
_PHASE_START = _words(SEQUENCE, "phase_start", "phase_start", offset(FSW, "mission"))
_WORKED_OUT = _words(FSW, "vehicle", "demand")
_COMMANDED = _words(COMMAND, "closes", "alpha", offset(FSW, "command"))


@kernel
def _gather(words, fields, wrong):
    """Set the top bit of ``wrong`` if a word has every bit of the exponent set: adding the lowest one carries
    into the sign.
    """
    for i in range(fields[0], fields[1]):
        wrong |= (words[i] & _EXPONENT) + _LOWEST
    return wrong


@kernel
def works_with_finite(sensors, memory):
    """Whether what is sensed, navigated, guided, estimated, demanded and commanded is finite; given as
    ``uint64`` words.
    """
    wrong = _gather(sensors, _SENSED, _LOWEST)
    wrong = _gather(memory, _PHASE_START, wrong)
    wrong = _gather(memory, _WORKED_OUT, wrong)
    wrong = _gather(memory, _COMMANDED, wrong)
    return wrong < _SIGN


def first_cause(
    plant: np.ndarray, outputs: np.ndarray, work: np.ndarray, sensors: np.ndarray, fsw: np.ndarray
) -> str | None:
    """The first quantity that is not finite, in the order in which one follows from the other; ``None`` when
    all are.

    Args:
        plant, outputs: state of the plant and what follows from it, shape (1,).
        work: of the integrator, shape (1,): the stage in which a step failed.
        sensors, fsw: readings under way and sensed; memory of the flight software; shape (1,).
    """
    own = [name for name in plant.dtype.names or () if name not in _FROM_OUTPUTS]
    steps = (("plant", plant[own]), ("stage", work["stage"]), ("outputs", outputs), ("k", work["k"]))
    under_way = [name for name in sensors.dtype.names or () if name != "sensed"]
    readings = (("sensors", sensors[under_way]), ("sensors", sensors))
    for name, record in (*steps, ("plant", plant), *readings, ("fsw", fsw)):
        if path := first_not_finite(record):
            return _plain_name(name, path)
    return None


def _plain_name(record: str, path: str) -> str:
    """``velocity x (I)`` for a state, ``rate of velocity x (I)`` for a derivative, ``sensed.t``,
    ``fsw.guide.bank`` for anything else.
    """
    field, _, index = path.partition("[")
    if (record, field) == ("plant", "y") or record in ("stage", "k"):
        state = STATE_NAMES[int(index.rstrip("]").split(",")[-1])]
        return f"rate of {state}" if record == "k" else state
    return f"{record}.{path}".removeprefix("sensors.")
