"""Check in every cycle that all quantities of the flight computer are finite, and find the first one that is
not.

Comparisons with what is not a number are false: no trigger fires and no limit is exceeded; nothing but this
look would end such a flight.
"""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.onboard import FSW
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.records import finite_words, first_not_finite, offset
from edl6dof.sensors.registry import SENSORS
from edl6dof.vehicle.plant import STATE_NAMES

#: Exponent of a number that is infinite or none, its lowest bit, and the sign.
_EXPONENT, _LOWEST, _SIGN = (
    np.uint64(0x7FF0_0000_0000_0000),
    np.uint64(0x0010_0000_0000_0000),
    np.uint64(0x8000_0000_0000_0000),
)


#: Fields of the state that follow from the outputs.
_FROM_OUTPUTS = ("inputs", "balance")
#: What is looked at in every cycle: whatever is wrong with the vehicle shows in what it senses or in its
#: state, and whatever is wrong with the memory of the flight computer in what guidance, control and
#: modulation make of it.  Images are finite whatever the vehicle does: an eye that meets nothing reads 0.
_SENSED = tuple(finite_words(SENSED, offset(SENSORS, "sensed")))
_WORKED_OUT = tuple(
    run
    for name in ("mission", "vehicle", "nav", "guide", "disturbance", "demand", "command")
    for run in finite_words(FSW[name], offset(FSW, name))
)


@kernel
def _gather(words, runs, wrong):
    """Set the top bit of ``wrong`` if a word has every bit of the exponent set: adding the lowest one carries
    into the sign.
    """
    for first, end in runs:
        for i in range(first, end):
            wrong |= (words[i] & _EXPONENT) + _LOWEST
    return wrong


@kernel
def works_with_finite(sensors, memory):
    """True if the outputs of sensors, navigation, guidance, estimation, control and modulation are finite;
    given as ``uint64`` words.
    """
    return _gather(memory, _WORKED_OUT, _gather(sensors, _SENSED, _LOWEST)) < _SIGN


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
