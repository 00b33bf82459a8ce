"""From the log record to named columns in the units of their names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np

from edl6dof.config.errors import UnknownName
from edl6dof.interface.thrusters import THRUSTER_FAILURES
from edl6dof.records import offset
from edl6dof.telemetry.channels import BRIEF, BRIEF_CHANNELS, CHANNELS, Channel
from edl6dof.telemetry.extremes import fastest_turns, largest, longest, nearest, rows_of_words


class Telemetry(Mapping[str, np.ndarray]):
    """``t_s``, every channel, and for each thruster ``rcs.<name>`` (mean duty of the last step, 0..1),
    ``fault.<name>`` (0 for none) and ``valve.<name>`` (1 while a pulse is commanded), for each radar beam
    ``range.<name>_m`` (0 without an echo), and for each propellant branch ``used.<name>_kg`` (what went
    through it since the start), ``metered.<name>_kg`` (what its flow meter counted of it) and
    ``expected.<name>_kg_s`` (the flow that commands call for); of a brief log ``t_s`` and its channels.

    A column, shape (rows,), is made when it is asked for, so that the log is held in memory once: a view of
    it where no unit changes, else a copy.
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

    def rows(self, start: int, stop: int | None) -> Telemetry:
        """Some rows of all columns."""
        return Telemetry(self._log[start:stop], *self._names)

    def beside(self, t: float) -> Telemetry:
        """The two rows before and after time ``t`` (s), or the nearest two; one row of a log that has no
        more.
        """
        times = self["t_s"]
        after = max(1, min(int(np.searchsorted(times, t)), len(times) - 1))
        return self.rows(after - 1, after + 1)

    def at(self, t: float, *names: str) -> list[float]:
        """Values of some channels at time ``t`` (s), on the straight lines between the rows beside it; beyond
        an end its value is held.
        """
        near = self.beside(t)
        words, from_si = words_of(self._log.dtype, names)
        table, times = rows_of_words(near._log)[:, words] * from_si, near["t_s"]
        if len(times) == 1:
            return table[0].tolist()
        share = min(max((t - times[0]) / (times[1] - times[0]), 0.0), 1.0)
        return (table[0] + share * (table[1] - table[0])).tolist()

    def largest(self, *names: str) -> np.ndarray:
        """Largest magnitude of each of some channels over all rows, ``nan`` of no rows: in a fraction of the
        time that columns take.
        """
        words, from_si = words_of(self._log.dtype, names)
        return largest(self._log, words) * from_si

    def longest(self, *names: str) -> float:
        """Largest length over all rows of the vector of some channels of one unit, ``nan`` of no rows."""
        words, from_si = words_of(self._log.dtype, names)
        return longest(self._log, words) * float(from_si[0])

    def nearest(self, place: Sequence[str], other: Sequence[str]) -> float:
        """Least distance over all rows of two places, each given by its channels in the unit of their record,
        ``nan`` where there are none.
        """
        a, b = (words_of(self._log.dtype, tuple(names))[0] for names in (place, other))
        return nearest(self._log, a, b)

    def fastest_swings(self, swings: Sequence[Sequence[str]]) -> np.ndarray:
        """Largest magnitudes over all rows of some rates without their part that is banking about the
        velocity, ``nan`` of no rows; each is given by the channels of the rate, of the roll rate, and of an
        angle.

        A bank at rate p about the velocity at angle of attack alpha shows as a yaw rate p tan(alpha) in the
        body (sideslip: in pitch); S1 counts the rates of the angle-of-attack and sideslip channels.
        """
        rates, rolls, angles = (words_of(self._log.dtype, names) for names in zip(*swings, strict=True))
        return fastest_turns(self._log, rates[0], int(rolls[0][0]), angles[0]) * rates[1]

    def __repr__(self) -> str:
        return f"<Telemetry: {len(self)} channels, {len(self._log):,} rows>"

    def __iter__(self) -> Iterator[str]:
        return iter((*self._places, *self._named))

    def __len__(self) -> int:
        return len(self._places) + len(self._named)


@lru_cache
def _slots(
    thrusters: tuple[str, ...], beams: tuple[str, ...], branches: tuple[str, ...]
) -> dict[str, tuple[str, int]]:
    """Field and index of the columns of each thruster, radar beam and propellant branch."""
    kinds = (
        *((kind, "", field, thrusters) for kind, field in _PER_THRUSTER),
        ("range", "_m", "range", beams),
        *((kind, suffix, kind, branches) for kind, suffix in _PER_BRANCH),
    )
    return {
        f"{kind}.{name}{suffix}": (field, index)
        for kind, suffix, field, names in kinds
        for index, name in enumerate(names)
    }


def range_of(beam: str) -> str:
    """Name of the column of a radar beam."""
    return f"range.{beam}_m"


def describe(name: str) -> tuple[str, str]:
    """Unit and meaning of a telemetry column.

    Raises:
        UnknownName: there is none of this name.
    """
    if name == "t_s":
        return "s", "time since the initial state"
    if name.startswith("rcs."):
        return "", f"mean thrust fraction of thruster {name[4:]} over the last integration step"
    if name.startswith("fault."):
        codes = ", ".join(
            f"{number} {kind.replace('_', ' ')}" for number, kind in enumerate(THRUSTER_FAILURES, 1)
        )
        return "", f"true state of thruster {name[6:]}: 0 works, {codes}"
    if name.startswith("valve."):
        return "", f"whether thruster {name[6:]} is commanded to fire in the present control cycle"
    if name.startswith("range."):
        return "m", f"range that radar beam {name[6:-2]} read last; 0 without an echo"
    if name.startswith("used."):
        return "kg", f"propellant that went through branch {name[5:-3]} since the start"
    if name.startswith("metered."):
        return "kg", f"what the flow meter of branch {name[8:-3]} has counted of it; 0 without a meter"
    if name.startswith("expected."):
        return "kg/s", f"flow through branch {name[9:-5]} that commands call for, mean of a control cycle"
    if name not in _BY_NAME:
        raise UnknownName("channel", name, _BY_NAME)
    channel = _BY_NAME[name]
    return channel.unit, channel.meaning


_PER_THRUSTER = (("rcs", "duty"), ("fault", "fault"), ("valve", "valve"))
_PER_BRANCH = (("used", "_kg"), ("metered", "_kg"), ("expected", "_kg_s"))
_BY_NAME = {channel.name: channel for channel in CHANNELS}


def _places(channels: Iterable[Channel]) -> dict[str, tuple[str, str, float]]:
    """Group and field of the log record, and factor to the unit, of every column that is not of a
    thruster.
    """
    return {
        "t_s": ("t", "", 1.0),
        **{channel.name: (channel.group, channel.field, channel.from_si) for channel in channels},
    }


@lru_cache
def words_of(dtype: np.dtype, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Where channels stand in a row, in eight-byte words, and their factors to the unit."""
    places = [_PLACES[name] for name in names]
    offsets = [offset(dtype, group) + offset(dtype[group], field) for group, field, _ in places]
    return np.array(offsets) // 8, np.array([from_si for _, _, from_si in places])


# looked up many times for every flight
_PLACES, _BRIEF_PLACES = _places(CHANNELS), _places(BRIEF_CHANNELS)
