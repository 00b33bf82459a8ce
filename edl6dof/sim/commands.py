"""Commands into a stepped flight and observations out of it, by name and in the units of the names.

Commands are written into the ``EXTERNAL`` record of the flight.  Observations are the estimates of its flight
computer, and, apart from them, the true state.  A command is in force for the cycles of its step; then the
flight software's own value counts again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import degrees
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
        """Put a command into force in place of the one before; ``None``: no command.

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
        """Take the former commands out of force and put those of these names into force."""
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
        """Read from the memory which commands are in force, after it was written to by others."""
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
        """Writer of north and east, which the record stores as east and north."""
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
    """Write a number, or an array of as many as ``place`` has, into ``place``.

    Raises:
        ValueError: their number is wrong, or one is not finite.
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


#: Estimates of navigation and mission logic: name, field of ``NAV`` and factor.
_DEG = degrees(1.0)
_NAVIGATED: tuple[tuple[str, str, float], ...] = (
    ("altitude_m", "altitude", 1.0),
    ("height_m", "height", 1.0),
    ("latitude_deg", "latitude", _DEG),
    ("longitude_deg", "longitude", _DEG),
    ("speed_m_s", "speed", 1.0),
    ("flight_path_angle_deg", "flight_path_angle", _DEG),
    ("azimuth_deg", "azimuth", _DEG),
    ("mach", "mach", 1.0),
    ("dynamic_pressure_pa", "dynamic_pressure", 1.0),
    ("drag_m_s2", "drag", 1.0),
    ("lift_m_s2", "lift", 1.0),
    ("bank_deg", "bank", _DEG),
    ("alpha_deg", "alpha", _DEG),
    ("beta_deg", "beta", _DEG),
    ("tilt_deg", "tilt", _DEG),
    ("gravity_m_s2", "gravity", 1.0),
)
#: Vectors among these estimates: name and field of ``NAV``.
_VECTORS: tuple[tuple[str, str], ...] = (
    ("v_N_m_s", "v_N"),  # north, east, down
    ("site_L_m", "site_L"),  # east, north, up of the landing site
    ("q_I2B", "q_I2B"),
    ("w_B_rad_s", "w_B"),
    ("specific_force_B_m_s2", "specific_force_B"),
)
#: Quantities of guidance: name, field and factor.
_GUIDED: tuple[tuple[str, str, float], ...] = (
    ("range_to_go_m", "range_to_go", 1.0),
    ("crossrange_m", "crossrange", 1.0),
    ("time_to_go_s", "time_to_go", 1.0),
)

Reader = Callable[[], Any]


def _number(record: np.ndarray, field: str, factor: float) -> Reader:
    values = record[field]
    return lambda: float(values[0]) * factor


def _vector(values: np.ndarray, place: slice = slice(None)) -> Reader:
    return lambda: values[0, place].copy()


def navigated(fsw: np.ndarray) -> dict[str, Reader]:
    """Readers of the estimates of the flight computer, by name; ``fsw``: its memory, shape (1,)."""
    nav, guide, vehicle = fsw["nav"], fsw["guide"], fsw["vehicle"]
    found = {name: _number(nav, field, factor) for name, field, factor in _NAVIGATED}
    found |= {name: _vector(nav[field]) for name, field in _VECTORS}
    found |= {name: _number(guide, field, factor) for name, field, factor in _GUIDED}
    found["mass_kg"] = _number(vehicle, "mass", 1.0)
    phase, engine = fsw["mission"]["phase"], vehicle["ignited"]
    found["phase"] = lambda: int(phase[0])
    found["engine_on"] = lambda: bool(engine[0])
    found["disturbance_torque_nm"] = _vector(fsw["disturbance"]["torque"])
    return found


def wanted(fsw: np.ndarray, thrusters: int) -> dict[str, Reader]:
    """Readers of the demands of the flight software itself, by the names of commands."""
    own = fsw["own"]
    return {
        "bank_deg": _number(own, "bank", _DEG),
        "thrust_n": _vector(own["thrust_N"]),
        "torque_nm": _vector(own["torque_B"]),
        "duties": _vector(own["duty"], slice(thrusters)),
    }


def true_state(plant: np.ndarray, outputs: np.ndarray) -> dict[str, Reader]:
    """Functions that read the true state, by name; ``outputs`` belong to the last evaluated derivative."""
    found = {
        name: _number(outputs, field, 1.0)
        for name, field in (
            ("altitude_m", "altitude"),
            ("height_m", "height"),
            ("mach", "mach"),
            ("dynamic_pressure_pa", "dynamic_pressure"),
            ("mass_kg", "mass"),
        )
    }
    y = plant["y"]
    places = {"r_I_m": slice(0, 3), "v_I_m_s": slice(3, 6), "q_I2B": slice(6, 10), "w_B_rad_s": slice(10, 13)}
    found |= {name: _vector(y, place) for name, place in places.items()}
    return found
