"""From the log record to named columns in the units of their names, and to the states of instruments."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from math import nan
from typing import Literal, NamedTuple

import numpy as np

from edl6dof.config.errors import UnknownName
from edl6dof.config.units import UNITS
from edl6dof.interface.effectors import THRUSTER_FAILURES
from edl6dof.spatial.arrays import lengths, tan
from edl6dof.telemetry.channels import BRIEF, BRIEF_CHANNELS, CHANNELS, Channel
from edl6dof.vehicle.faults.component import Component, Components


class Telemetry(Mapping[str, np.ndarray]):
    """``t_s``, every channel, and the columns of each thruster, radar beam and propellant branch, which
    :func:`describe` explains; of a brief log ``t_s`` and its channels.

    A column, shape (rows,), is made at each access: a view of the log if no unit changes, otherwise a copy.
    """

    def __init__(
        self,
        log: np.ndarray,
        thrusters: Sequence[str],
        beams: Sequence[str] = (),
        branches: Sequence[str] = (),
    ) -> None:
        self._log, self._names = log, (tuple(thrusters), tuple(beams), tuple(branches))
        self._places, self._named = (
            (_BRIEF_PLACES, {}) if log.dtype == BRIEF else (_PLACES, _slots(*self._names))
        )

    def __getitem__(self, name: str) -> np.ndarray:
        place = self._places.get(name)
        if place is None:
            if name not in self._named:
                raise UnknownName("channel", name, self)
            field, index = self._named[name]
            return self._log[field][:, index]
        group, field, from_si = place
        values = self._log[group][field] if field else self._log[group]
        return values if from_si == 1.0 else values * from_si

    def unit(self, name: str) -> str:
        """Return the printed unit of a column."""
        return describe(name)[0]

    def meaning(self, name: str) -> str:
        """Return the meaning of a column."""
        return describe(name)[1]

    def rows(self, start: int, stop: int | None) -> Telemetry:
        """Some rows of all columns."""
        return Telemetry(self._log[start:stop], *self._names)

    def around(self, t: float) -> Telemetry:
        """The rows before and after time ``t`` (s), or the nearest two; one row if the log has only one."""
        times = self["t_s"]
        after = max(1, min(int(np.searchsorted(times, t)), len(times) - 1))
        return self.rows(after - 1, after + 1)

    def at(self, t: float, *names: str) -> list[float]:
        """Values of channels at time ``t`` (s), interpolated linearly; held beyond the ends."""
        near = self.around(t)
        table, times = np.array([near[name] for name in names]), near["t_s"]
        if len(times) == 1:
            return table[:, 0].tolist()
        share = min(max((t - times[0]) / (times[1] - times[0]), 0.0), 1.0)
        return (table[:, 0] + share * (table[:, 1] - table[:, 0])).tolist()

    def length_at(self, t: float, *names: str) -> float:
        """Length of the vector of some channels at time ``t`` (s), interpolated as by :meth:`at`."""
        return float(lengths(np.array(self.at(t, *names))))

    def largest(self, *names: str) -> float:
        """Largest magnitude of some channels of one unit over all rows, of which there must be one."""
        return float(np.max([np.max(np.abs(self[name])) for name in names]))

    def longest(self, *names: str) -> float:
        """Largest length over all rows of the vector of some channels of one unit, computed in SI units."""
        columns, from_si = self._si(names)
        return float(np.max(lengths(np.stack(columns, axis=-1)))) * from_si[0]

    def nearest(self, place: Sequence[str], other: Sequence[str]) -> float:
        """Least distance (m) of two places, given by their channels, over all rows; ``nan`` without rows."""
        steps = [self[one] - self[two] for one, two in zip(place, other, strict=True)]
        return float(np.fmin.reduce(lengths(np.stack(steps, axis=-1)), initial=nan))

    def fastest_swing(self, rate: str, roll: str, angle: str) -> float:
        """Largest magnitude over all rows of a body rate less the part due to banking about the velocity,
        from the channels of the rate, of the roll rate, and of an angle; ``nan`` without rows.

        A bank at rate p about the velocity at angle of attack alpha shows as a yaw rate p tan(alpha) in the
        body (sideslip: in pitch); S1 counts the rates of the angle-of-attack and sideslip channels.
        """
        (q, p, alpha), from_si = self._si((rate, roll, angle))
        return float(np.max(np.abs(q - p * tan(alpha)))) * from_si[0] if len(q) else nan

    def _si(self, names: Sequence[str]) -> tuple[list[np.ndarray], list[float]]:
        """Columns in SI, and their factors to the unit."""
        places = [self._places[name] for name in names]
        return [self._log[group][field] for group, field, _ in places], [place[2] for place in places]

    def __repr__(self) -> str:
        return f"<Telemetry: {len(self)} channels, {len(self._log):,} rows>"

    def __iter__(self) -> Iterator[str]:
        return iter((*self._places, *self._named))

    def __len__(self) -> int:
        return len(self._places) + len(self._named)


class _Slot(NamedTuple):
    """Columns for each thruster (``owner`` 0), beam (1) or branch (2): prefix and suffix of the column's
    name, field of the log, and meaning.
    """

    prefix: str
    suffix: str
    field: str
    owner: Literal[0, 1, 2]
    meaning: str


_STATES = ", ".join(f"{number} {kind.replace('_', ' ')}" for number, kind in enumerate(THRUSTER_FAILURES, 1))
_SLOTS = (
    _Slot("rcs", "", "duty", 0, "mean thrust fraction of thruster {} over the last integration step"),
    _Slot("fault", "", "fault", 0, f"true state of thruster {{}}: 0 works, {_STATES}"),
    _Slot("valve", "", "valve", 0, "1 if thruster {} is commanded to fire in this control cycle, else 0"),
    _Slot("range", "_m", "range", 1, "last range measured by radar beam {}; 0 without an echo"),
    _Slot("used", "_kg", "used", 2, "propellant that went through branch {} since the start"),
    _Slot("metered", "_kg", "metered", 2,
          "propellant counted by the flow meter of branch {} since the start; 0 without a meter"),
    _Slot("expected", "_kg_s", "expected", 2,
          "flow through branch {} expected from the commands, mean of a control cycle"),
)  # fmt: skip


@lru_cache
def _slots(*names: tuple[str, ...]) -> dict[str, tuple[str, int]]:
    """Field and index of the columns of each thruster, radar beam and propellant branch."""
    return {
        f"{slot.prefix}.{name}{slot.suffix}": (slot.field, index)
        for slot in _SLOTS
        for index, name in enumerate(names[slot.owner])
    }


def range_of(beam: str) -> str:
    """Name of the telemetry column that holds the measured range of a radar beam."""
    return f"range.{beam}_m"


def describe(name: str) -> tuple[str, str]:
    """Return unit and meaning of a telemetry column.

    Raises:
        UnknownName: there is no column of this name.
    """
    if name == "t_s":
        return "s", "time since the initial state"
    prefix, _, rest = name.partition(".")
    for slot in _SLOTS:
        if prefix == slot.prefix:
            unit = UNITS[slot.suffix[1:]].label if slot.suffix else ""
            return unit, slot.meaning.format(rest.removesuffix(slot.suffix))
    if name not in _BY_NAME:
        raise UnknownName("channel", name, _BY_NAME)
    channel = _BY_NAME[name]
    return channel.unit, channel.meaning


_BY_NAME = {channel.name: channel for channel in CHANNELS}


def _places(channels: Iterable[Channel]) -> dict[str, tuple[str, str, float]]:
    """Group and field in the log record, and factor to the unit, of each channel."""
    return {
        "t_s": ("t", "", 1.0),
        **{channel.name: (channel.group, channel.field, channel.from_si) for channel in channels},
    }


# computed once, because every access of a column reads them
_PLACES, _BRIEF_PLACES = _places(CHANNELS), _places(BRIEF_CHANNELS)

IN_USE, SATURATED, EXCLUDED = "in use", "saturated", "excluded"
NO_ECHO, USED, NOT_USED = "no echo", "used", "locked, not used"
#: States of an inertial instrument, and of a radar beam, from telemetry that has a bit of a number for each.
INERTIAL_STATES, BEAM_STATES = (IN_USE, SATURATED, EXCLUDED), (NO_ECHO, USED, NOT_USED, EXCLUDED)

#: Channels (bit masks) of each kind of instrument: those that are not excluded, and those that are saturated
#: or, of beams, used.
CHANNELS_OF: dict[Component, tuple[str, str]] = {
    "gyro": ("nav.gyros_in_use", "sensed.gyros_saturated"),
    "accelerometer": ("nav.accelerometers_in_use", "sensed.accelerometers_saturated"),
    "beam": ("nav.beams_in_use", "nav.beams_used"),
}


class Instrument(NamedTuple):
    """One instrument: kind, name, and the index into ``states`` at each row, shape (rows,)."""

    kind: Component
    name: str
    states: Sequence[str]
    state: np.ndarray

    def holds(self, state: str) -> np.ndarray:
        """Rows in which it is in a state, shape (rows,), bool."""
        return self.state == self.states.index(state)


def instruments(table: Mapping[str, np.ndarray], names: Components) -> list[Instrument]:
    """The instruments of a flight, except those whose columns are missing.

    Args:
        table: columns of telemetry by name.
        names: names of the instruments by kind, in their order.
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
