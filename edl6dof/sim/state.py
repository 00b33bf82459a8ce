"""A flight saved in the middle: everything that changes, and the scenario, in one file.

Continuing gives the same bits as flying through: plant, sensors, flight-software memory and the cycle number are copied byte for byte,
and random profiles follow from the scenario's seed.
"""

from __future__ import annotations

import hashlib
import io
import os
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.regular import read_regular
from edl6dof.fsw.onboard import FSW
from edl6dof.sensors.sensed import SENSED
from edl6dof.vehicle.plant import PLANT

#: Size, in bytes, of the largest saved state that is read, packed and unpacked.
LARGEST = 50_000_000

_RECORDS = {"plant": PLANT, "sensed": SENSED, "fsw": FSW}


def layout_hash() -> str:
    """Hash of the record layouts; a saved state only fits the layout that wrote it."""
    return hashlib.sha256(repr([(name, dtype.descr) for name, dtype in _RECORDS.items()]).encode()).hexdigest()


@dataclass(frozen=True)
class State:
    """State of a flight at the start of a base cycle."""

    cycle: int
    plant: np.ndarray
    sensed: np.ndarray
    fsw: np.ndarray
    scenario_text: str

    def save(self, path: Path) -> None:
        """Write to ``path`` atomically."""
        buffer = io.BytesIO()
        records = {name: np.frombuffer(getattr(self, name).tobytes(), dtype=np.uint8) for name in _RECORDS}
        np.savez_compressed(
            buffer,
            cycle=np.array(self.cycle),
            scenario=np.frombuffer(self.scenario_text.encode(), dtype=np.uint8),
            layout=np.frombuffer(layout_hash().encode(), dtype=np.uint8),
            **records,
        )
        partial = path.with_name(f".{path.name}.{os.getpid()}.part")
        partial.write_bytes(buffer.getvalue())
        partial.replace(path)

    @classmethod
    def load(cls, path: Path) -> State:
        """Read a saved state.

        Raises:
            ConfigError: the file is missing, is no saved state, or was written by another version.
        """
        try:
            content = io.BytesIO(read_regular(path, LARGEST))
            with zipfile.ZipFile(content) as archive:
                if sum(member.file_size for member in archive.infolist()) > LARGEST:
                    raise ValueError("unpacks to more than any state holds")
            with np.load(content, allow_pickle=False) as file:
                if file["layout"].tobytes().decode() != layout_hash():
                    raise _problem(path, "was saved by another version of edl6dof whose records differ; fly to that time again")
                records = {name: np.frombuffer(file[name].tobytes(), dtype=dtype).copy() for name, dtype in _RECORDS.items()}
                return cls(int(file["cycle"]), scenario_text=file["scenario"].tobytes().decode(), **records)
        except OSError as error:
            raise _problem(path, f"cannot be read: {error.strerror or error}") from None
        except (ValueError, LookupError, NotImplementedError, zipfile.BadZipFile, zlib.error, EOFError):
            raise _problem(path, "is not a state saved by 'edl6dof fly --save-state'") from None


def _problem(path: Path, message: str) -> ConfigError:
    return ConfigError([Problem(str(path), 0, 0, "", message)])
