"""A flight saved in the middle: everything that changes, and the scenario, in one file.

Continuing gives the same bits as flying through: the state of the plant, the largest loads met, sensors,
flight-software memory and the cycle number are copied byte for byte; everything else follows from them, and
random profiles from the scenario's seed.  Compiled code trusts these records, so the content of a file is
checked first.
"""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import ConfigError, Problem, refusal
from edl6dof.durable import write_atomic
from edl6dof.fsw.diagnosis.diagnose import KIND_NAMES
from edl6dof.fsw.onboard import FSW
from edl6dof.records import first_not_finite, out_of_range
from edl6dof.sensors.registry import SENSORS
from edl6dof.vehicle.plant import PEAKS, STATE

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

_RECORDS = {"plant": STATE, "peaks": PEAKS, "sensors": SENSORS, "fsw": FSW}
#: Largest text of a scenario, and largest file, in bytes; a saved state has some ten thousand, and some
#: million once the imagers have seen ground.
_LARGEST_SCENARIO, _LARGEST_FILE = 2_000_000, 16_000_000
#: Room for the header of a ``.npy`` member.
_HEADER = 1024
#: Last base cycle of the longest flight that a scenario may ask for: 20,000 s at 200 Hz.
_LAST_CYCLE = 4_000_000


def layout_hash() -> str:
    """Hash of the record layouts; a saved state only fits the layout that wrote it."""
    return hashlib.sha256(
        repr([(name, dtype.descr) for name, dtype in _RECORDS.items()]).encode()
    ).hexdigest()


@dataclass(frozen=True, repr=False)
class State:
    """State of a flight at the start of a base cycle."""

    cycle: int
    plant: np.ndarray
    peaks: np.ndarray
    sensors: np.ndarray
    fsw: np.ndarray
    scenario_text: str

    def __repr__(self) -> str:
        return f"<State at t = {self.plant['t'][0]:.2f} s, base cycle {self.cycle}>"

    def save(self, path: Path) -> None:
        """Write to ``path`` atomically."""
        write_atomic(path, self.packed())

    def packed(self) -> bytes:
        """Content of the file that :meth:`save` writes."""
        buffer = io.BytesIO()
        records: dict[str, Any] = {
            name: np.frombuffer(getattr(self, name).tobytes(), dtype=np.uint8) for name in _RECORDS
        }
        np.savez_compressed(
            buffer,
            cycle=np.array(self.cycle),
            scenario=np.frombuffer(self.scenario_text.encode(), dtype=np.uint8),
            layout=np.frombuffer(layout_hash().encode(), dtype=np.uint8),
            **records,
        )
        return buffer.getvalue()

    @classmethod
    def load(cls, path: Path) -> State:
        """Read a saved state.

        Raises:
            ConfigError: the file is missing, is no saved state, was written by another version, or holds
                values that no flight has; each with the field, the value and what is allowed.
        """
        try:
            content = read_regular(path, _LARGEST_FILE)
        except OSError as error:
            raise refusal(path, f"cannot be read: {error.strerror or error}") from None
        return cls.unpacked(content, path)

    @classmethod
    def unpacked(cls, content: bytes, name: str | Path) -> State:
        """Read a state from the bytes of its file; ``name``: of the file, for messages.

        Raises:
            ConfigError: as of :meth:`load`.
        """
        try:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                state = _read(archive, name)
        except ConfigError:
            raise
        except Exception:  # a broken archive makes its readers raise errors of a dozen kinds
            raise refusal(name, "is not a state saved by 'edl6dof fly --save-state'") from None
        if found := [Problem(str(name), 0, 0, *problem) for problem in state._impossible()]:
            raise ConfigError(found)
        return state

    def check_fits(self, scenario: Scenario) -> None:
        """Check that a flight of ``scenario`` can continue from this state.

        Raises:
            ConfigError: the time does not belong to the cycle, or a record numbers a phase or thruster that
                the scenario does not have.
        """
        found = []
        rate = scenario.flight_software.rates.base_hz
        if not abs(float(self.plant["t"][0]) - self.cycle / rate) <= 1e-6:
            message = (
                f"must stay what it was: base cycle {self.cycle} began at t = {float(self.plant['t'][0]):g} "
                f"s (got {rate})"
            )
            found.append(("flight_software.rates.base_hz", message))
        sizes = {"phases": len(scenario.mission.phases), "thrusters": len(scenario.vehicle.rcs.thrusters)}
        found += self._out_of_range(sizes)
        if found:
            raise ConfigError(
                [
                    Problem("(saved state)", 0, 0, path, f"does not fit the scenario: {message}")
                    for path, message in found
                ]
            )

    def _impossible(self) -> Iterator[tuple[str, str]]:
        """Field and message of each value that no flight can have."""
        if not 0 <= self.cycle <= _LAST_CYCLE:
            yield "cycle", f"must be 0 .. {_LAST_CYCLE} (got {self.cycle})"
        yield from self._out_of_range({})
        for name in _RECORDS:
            if path := first_not_finite(getattr(self, name)):
                yield f"{name}.{path}", "must be finite"
        diagnosis = self.fsw["diagnosis"][0]
        for index, kind in enumerate(
            diagnosis["isolated"]["kind"][: max(diagnosis["n_isolated"], 0)].tolist()
        ):
            if kind not in KIND_NAMES:
                yield (
                    f"fsw.diagnosis.isolated.kind[{index}]",
                    f"must be one of {', '.join(map(str, KIND_NAMES))} (got {kind})",
                )

    def _out_of_range(self, sizes: dict[str, int]) -> list[tuple[str, str]]:
        return [
            (f"{name}.{path}", words)
            for name in _RECORDS
            for path, words in out_of_range(getattr(self, name), sizes)
        ]


def _read(archive: zipfile.ZipFile, path: str | Path) -> State:
    """Read a saved state from its archive; members larger than any state has are refused."""
    if _member(archive, "layout", 64).tobytes().decode() != layout_hash():
        raise refusal(
            path, "was saved by another version of edl6dof whose records differ; fly to that time again"
        )
    cycle = _member(archive, "cycle", 8)
    if cycle.shape != () or cycle.dtype != np.dtype("i8"):
        raise ValueError("cycle is no whole number")
    records = {}
    for name, dtype in _RECORDS.items():
        data = _member(archive, name, dtype.itemsize)
        if data.shape != (dtype.itemsize,) or data.dtype != np.uint8:
            raise ValueError(f"{name} is no record")
        records[name] = np.frombuffer(data.tobytes(), dtype=dtype).copy()
    try:
        text = _member(archive, "scenario", _LARGEST_SCENARIO).tobytes().decode()
    except UnicodeDecodeError as error:
        raise refusal(path, f"holds a scenario that is not UTF-8 (byte {error.start})") from None
    return State(int(cycle), scenario_text=text, **records)


def _member(archive: zipfile.ZipFile, name: str, largest: int) -> np.ndarray:
    """Array of an archive member of at most ``largest`` bytes; a larger one is not unpacked."""
    info = archive.getinfo(f"{name}.npy")
    if info.file_size > largest + _HEADER:
        raise ValueError(f"{name} is too large")
    return np.load(io.BytesIO(archive.read(info)), allow_pickle=False)
