"""The landing map of a run as a file: plain arrays, each by its name."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np

from edl6dof.telemetry.landing_map import LandingMap

LANDING_MAP = "landing_map.npz"
#: Largest array of such a file, in bytes; a map of 256 x 256 single-precision numbers has a fourth of it.
_LARGEST = 1_048_576
#: Room for what a ``.npy`` member says of itself before its data.
_HEADER = 1024


def write_landing_map(found: LandingMap, folder: Path) -> None:
    """Write a landing map into the folder of a run."""
    np.savez_compressed(folder / LANDING_MAP, **found._asdict())


def read_landing_map(content: bytes) -> LandingMap:
    """The landing map in the bytes of its file; nothing that is not plain numbers is made of them.

    Raises:
        ValueError: they are no landing map.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return LandingMap(**{name: _member(archive, name) for name in LandingMap._fields})
    except Exception:  # a broken archive makes its readers raise errors of a dozen kinds
        raise ValueError("is no landing map") from None


def _member(archive: zipfile.ZipFile, name: str) -> np.ndarray:
    info = archive.getinfo(f"{name}.npy")
    if info.file_size > _LARGEST + _HEADER:
        raise ValueError(f"{name} is too large")
    values = np.lib.format.read_array(io.BytesIO(archive.read(info)), allow_pickle=False)
    if values.dtype.kind not in "fi":
        raise ValueError(f"{name} holds no numbers")
    return values
