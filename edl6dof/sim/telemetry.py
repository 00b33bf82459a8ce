"""From the log record to named columns in the units of their names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from edl6dof.sim.channels import CHANNELS
from edl6dof.vehicle.faults import THRUSTER_KINDS


class Telemetry(Mapping[str, np.ndarray]):
    """``t_s``, every channel, and for each thruster ``rcs.<name>`` (mean duty of the last step, 0..1), ``fault.<name>`` (0 for none) and
    ``valve.<name>`` (1 while a pulse is commanded).

    A column, shape (rows,), is made when it is asked for, so that the log is held in memory once: a view of it where no unit
    changes, else a copy.
    """

    def __init__(self, log: np.ndarray, thrusters: Sequence[str]) -> None:
        self._log, self._thrusters = log, thrusters
        self._slots = {f"{kind}.{name}": (field, index) for index, name in enumerate(thrusters) for kind, field in _PER_THRUSTER}
        self._names = ("t_s", *_BY_NAME, *self._slots)

    def __getitem__(self, name: str) -> np.ndarray:
        if name in self._slots:
            field, index = self._slots[name]
            return self._log[field][:, index]
        if name == "t_s":
            return self._log["t"]
        channel = _BY_NAME[name]
        values = self._log[channel.group][channel.field]
        return values if channel.from_si == 1.0 else values * channel.from_si

    def rows(self, start: int, stop: int) -> Telemetry:
        """Some rows of all columns."""
        return Telemetry(self._log[start:stop], self._thrusters)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def describe(name: str) -> tuple[str, str]:
    """Unit and meaning of a telemetry column."""
    if name == "t_s":
        return "s", "time since the initial state"
    if name.startswith("rcs."):
        return "", f"mean thrust fraction of thruster {name[4:]} over the last integration step"
    if name.startswith("fault."):
        codes = ", ".join(f"{number} {kind.replace('_', ' ')}" for number, kind in enumerate(THRUSTER_KINDS, 1))
        return "", f"true state of thruster {name[6:]}: 0 works, {codes}"
    if name.startswith("valve."):
        return "", f"whether thruster {name[6:]} is commanded to fire in the present control cycle"
    channel = _BY_NAME[name]
    return channel.unit, channel.meaning


_PER_THRUSTER = (("rcs", "duty"), ("fault", "fault"), ("valve", "valve"))
_BY_NAME = {channel.name: channel for channel in CHANNELS}
