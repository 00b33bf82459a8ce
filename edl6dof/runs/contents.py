"""Contents of the files of a run: types of the JSON files, which a file read back must have, and the landing
map as plain arrays.
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import NotRequired, TypeVar

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from edl6dof.metrics.published import PublishedFigure
from edl6dof.telemetry.landing_map import LandingMap

LANDING_MAP = "landing_map.npz"
#: Largest array of such a file, in bytes; a map of 256 x 256 single-precision numbers has a fourth of it.
_LARGEST = 1_048_576
#: Room for what a ``.npy`` member says of itself before its data.
_HEADER = 1024

Content = TypeVar("Content")

_EXACT = ConfigDict(strict=True, allow_inf_nan=False)


@with_config(_EXACT)
class Limit(TypedDict):
    """One limit of the scenario with the flight's value, in ``unit``; null where it could not be formed."""

    name: str
    value: float | None
    limit: float
    unit: str
    ok: bool


@with_config(_EXACT)
class Summary(TypedDict):
    """``summary.json``: outcome, figures by name with unit suffix, limits, and the published figures of the
    real flight.
    """

    name: str
    outcome: str
    success: bool
    reached_goal: NotRequired[bool]
    warnings: NotRequired[list[str]]
    time_s: float
    phase: str
    edl6dof_version: str
    seed: int
    scenario_sha256: str
    figures: dict[str, float | None]
    limits: list[Limit]
    published: dict[str, float | PublishedFigure]


@with_config(_EXACT)
class Event(TypedDict):
    """One event of ``events.json`` with the state of the vehicle then, null where that is not finite.

    The beginning of a phase says which phase it is and what for, an event of the mission which milestone it
    is (empty for none), a diagnosis which thruster it is about and
    what was found.
    """

    t_s: float
    key: str
    name: str
    detail: str
    phase: NotRequired[str]
    role: NotRequired[str]
    milestone: NotRequired[str]
    thruster: NotRequired[str]
    isolated: NotRequired[str]
    altitude_m: float | None
    height_m: float | None
    speed_m_s: float | None
    mach: float | None


def parsed(content: bytes, kind: type[Content]) -> Content:
    """The content of a file, whose types are right.

    Raises:
        ValueError: it is not of this kind; the text says where.
    """
    try:
        return TypeAdapter(kind).validate_json(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise ValueError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}".removeprefix(": ")) from None


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
