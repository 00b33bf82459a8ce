"""State of each instrument, row by row, from telemetry that holds a bit of a number for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from edl6dof.telemetry.columns import range_of
from edl6dof.vehicle.faults.component import Component, Components

IN_USE, SATURATED, EXCLUDED = "in use", "saturated", "excluded"
NO_ECHO, USED, NOT_USED = "no echo", "used", "locked, not used"
#: What can be said of an inertial instrument, and of a radar beam.
INERTIAL_STATES, BEAM_STATES = (IN_USE, SATURATED, EXCLUDED), (NO_ECHO, USED, NOT_USED, EXCLUDED)

#: Channels of the kinds of instruments: which are not excluded, and which say that they are saturated, or
#: are used, if they are.
CHANNELS_OF: dict[Component, tuple[str, str]] = {
    "gyro": ("nav.gyros_in_use", "sensed.gyros_saturated"),
    "accelerometer": ("nav.accelerometers_in_use", "sensed.accelerometers_saturated"),
    "beam": ("nav.beams_in_use", "nav.beams_used"),
}


class Instrument(NamedTuple):
    """One instrument: its kind, name, and the index into ``states`` at each row, shape (rows,)."""

    kind: Component
    name: str
    states: Sequence[str]
    state: np.ndarray

    def holds(self, state: str) -> np.ndarray:
        """Rows in which it is in a state, shape (rows,), bool."""
        return self.state == self.states.index(state)


def instruments(table: Mapping[str, np.ndarray], names: Components) -> list[Instrument]:
    """The instruments of a flight from the columns of its telemetry; none of a kind whose columns it does not
    have.

    Args:
        table: columns by name.
        names: of the instruments by kind, in their order.
    """
    return [
        _beam(table, index, name) if kind == "beam" else _inertial(table, kind, index, name)
        for kind, channels in CHANNELS_OF.items()
        for index, name in enumerate(names.get(kind, ()))
        if set(channels) <= set(table) and (kind != "beam" or range_of(name) in table)
    ]


def columns_of(names: Components) -> tuple[str, ...]:
    """Columns that :func:`instruments` needs."""
    every = (channel for kind, channels in CHANNELS_OF.items() if names.get(kind) for channel in channels)
    return (*every, *(range_of(beam) for beam in names.get("beam", ())))


def _inertial(table: Mapping[str, np.ndarray], kind: Component, index: int, name: str) -> Instrument:
    in_use, saturated = (_bit(table[channel], index) for channel in CHANNELS_OF[kind])
    state = np.where(~in_use, INERTIAL_STATES.index(EXCLUDED), np.where(saturated, 1, 0))
    return Instrument(kind, name, INERTIAL_STATES, state)


def _beam(table: Mapping[str, np.ndarray], index: int, name: str) -> Instrument:
    in_use, used = (_bit(table[channel], index) for channel in CHANNELS_OF["beam"])
    locked = table[range_of(name)] > 0.0
    state = np.where(~locked, 0, np.where(used, BEAM_STATES.index(USED), BEAM_STATES.index(NOT_USED)))
    return Instrument("beam", name, BEAM_STATES, np.where(in_use, state, BEAM_STATES.index(EXCLUDED)))


def _bit(numbers: np.ndarray, index: int) -> np.ndarray:
    return np.nan_to_num(numbers).astype(np.int64) >> index & 1 != 0
