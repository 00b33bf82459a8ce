"""Commands from outside by name and in the units of their names, written into the ``EXTERNAL`` record of a
flight.

A command holds for the cycles of the step that it is given to; without one the flight software's own word
counts again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.config.wording import unknown

Command = Mapping[str, Any]

#: Quantities of the command ``estimate``, their fields and sizes.
ESTIMATE = {
    "r_I_m": ("r_I", 3),
    "v_I_m_s": ("v_I", 3),
    "q_I2B": ("q_I2B", 4),
    "w_B_rad_s": ("w_B", 3),
    "height_m": ("height_above_ground", 1),
}


class Commander:
    """Writes commands into the flight-software memory of one flight.

    Args:
        memory: ``FSW`` record array of length one.
        thrusters: names of the thrusters.
    """

    def __init__(self, memory: np.ndarray, thrusters: Sequence[str]):
        self._record, self._thrusters = memory["external"], list(thrusters)
        self._flags = self._record["given"]
        self._held: tuple[str, ...] = ()
        fields, radians = self._record, np.pi / 180.0
        duty, isolated = fields["duty"][0], fields["isolated"][0]
        self._writers: dict[str, tuple[str, Callable[[Any], None]]] = {
            "bank_deg": ("bank", self._number("bank", radians)),
            "bank_rate_deg_s": ("bank_rate", self._number("bank_rate", radians)),
            "thrust_n": ("thrust", self._vector("thrust_N")),
            "throttle": ("throttle", self._number("throttle", 1.0)),
            "torque_nm": ("torque", self._vector("torque_B")),
            "duties": ("duties", lambda value: self._by_thruster(duty, value)),
            "isolate": ("isolate", lambda value: self._isolate(isolated, value)),
            "safe_spot_m": ("safe_spot", self._place("fine_L")),
            "coarse_spot_m": ("coarse_spot", self._place("coarse_L")),
            "estimate": ("estimate", self._estimate),
        }

    @property
    def names(self) -> list[str]:
        """Names of the commands."""
        return list(self._writers)

    def give(self, command: Command | None) -> None:
        """Let a command count from now on, and no other.

        Raises:
            ValueError: there is no such command, or its value is not of its kind or not finite.
        """
        names = () if command is None else tuple(command)
        if names != self._held:
            self._take_back(names)
        for name in names:
            try:
                self._writers[name][1](command[name])  # type: ignore[index]  # with names there is a command
            except (TypeError, ValueError, OverflowError) as error:
                raise ValueError(f"{name}: {error}") from None

    def _take_back(self, names: tuple[str, ...]) -> None:
        """Let the commands of these names count."""
        for name in names:
            if name not in self._writers:
                raise ValueError(unknown("command", name, self._writers))
        for name in self._held:
            self._flags[self._writers[name][0]] = 0
        for name in names:
            self._flags[self._writers[name][0]] = 1
        self._held = names

    @property
    def holds(self) -> bool:
        """True while a command is in force."""
        return bool(self._held)

    def take_up(self) -> None:
        """See which commands count in the memory, after others have written to it."""
        flags = self._flags[0]
        self._held = tuple(name for name, (flag, _) in self._writers.items() if flags[flag])

    def _number(self, field: str, factor: float) -> Callable[[Any], None]:
        place = self._record[field]

        def write(value: Any) -> None:
            if isinstance(value, str | bytes | bool):
                raise ValueError(f"a command must be a number (got {value!r})")
            number = float(value) * factor
            if not -1e300 < number < 1e300:
                raise ValueError(f"a command must be finite (got {value!r})")
            place[0] = number

        return write

    def _vector(self, field: str) -> Callable[[Any], None]:
        place = self._record[field][0]
        return lambda value: _put(place, value)

    def _place(self, field: str) -> Callable[[Any], None]:
        """Of north and east, which records hold as east and north."""
        place = self._record[field][0, ::-1]
        return lambda value: _put(place, value)

    def _by_thruster(self, place: np.ndarray, value: Any) -> None:
        if isinstance(value, Mapping):
            duties: list[Any] = [0.0] * len(self._thrusters)
            for name, duty in value.items():
                duties[self._index(name)] = duty
            value = duties
        _put(place[: len(self._thrusters)], value)

    def _isolate(self, place: np.ndarray, names: Iterable[str]) -> None:
        if isinstance(names, str | bytes | Mapping) or not isinstance(names, Iterable):
            raise ValueError(f"names of thrusters are needed, in a list (got {names!r})")
        place[:] = 0
        for name in names:
            place[self._index(name)] = 1

    def _index(self, name: str) -> int:
        if name not in self._thrusters:
            raise ValueError(unknown("thruster", name, self._thrusters))
        return self._thrusters.index(name)

    def _estimate(self, value: Mapping[str, Any]) -> None:
        if not isinstance(value, Mapping):
            raise ValueError(f"an estimate needs {', '.join(ESTIMATE)}, each by its name (got {value!r})")
        for name in value:
            if name not in ESTIMATE:
                raise ValueError(unknown("quantity of an estimate", name, ESTIMATE))
        if missing := [name for name in ESTIMATE if name not in value]:
            raise ValueError(f"an estimate needs {', '.join(missing)} too")
        for name, (field, size) in ESTIMATE.items():
            place = self._record[field]
            _put(place if size == 1 else place[0], value[name])


def _put(place: np.ndarray, value: Any) -> None:
    """Numbers into their place, one or as many as it has.

    Raises:
        ValueError: they are not so many, or not finite.
    """
    count = place.shape[0]
    needed = f"a command needs {count} number{'s' * (count > 1)} (got {value!r})"
    try:
        numbers = np.asarray(value)
    except ValueError:  # lists of unlike lengths
        raise ValueError(needed) from None
    if numbers.dtype.kind not in "iuf" or numbers.shape not in ((count,), *[()] * (count == 1)):
        raise ValueError(needed)
    if not np.isfinite(numbers).all():
        raise ValueError(f"a command must be finite (got {value!r})")
    place[:] = numbers
