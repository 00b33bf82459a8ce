"""The files of a run that hold its numbers: how they are written, and what a file read back must be."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NotRequired, TypeVar

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from edl6dof import __version__
from edl6dof.config.dump import json_text
from edl6dof.metrics.published import PublishedFigure, published_figures
from edl6dof.telemetry.landing_map import LandingMap

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight


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
    """``summary.json``: outcome, figures by name, limits, and published figures of the real flight."""

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


#: Rows written at a time: keeps the memory of writing small beside the telemetry itself.
ROW_GROUP = 2_500


def write_run(flight: Flight, folder: Path) -> None:
    """Write these files into ``folder``, which exists."""
    (folder / "scenario.yaml").write_text(flight.resolved_scenario, encoding="utf-8")
    write_telemetry(flight, folder / "telemetry.parquet")
    (folder / "events.json").write_text(json_text(flight.events), encoding="utf-8")
    (folder / "summary.json").write_text(json_text(summary(flight)), encoding="utf-8")
    if flight.landing_map is not None:
        write_landing_map(flight.landing_map, folder)


def summary(flight: Flight) -> dict[str, Any]:
    """Outcome, figures, limits and published figures of a flight, ready for JSON."""
    return {
        "name": flight.name,
        "outcome": flight.outcome,
        "success": flight.success,
        "reached_goal": flight.termination.reached,
        "time_s": flight.time_s,
        "phase": flight.phase,
        "edl6dof_version": __version__,
        "seed": flight.scenario.seed,
        "scenario_sha256": hashlib.sha256(flight.resolved_scenario.encode()).hexdigest(),
        "warnings": flight.loaded.warnings,
        "figures": flight.metrics,
        "limits": [
            {"name": c.label, "value": c.value, "limit": c.limit, "unit": c.unit, "ok": c.ok}
            for c in flight.checks
        ],
        "published": {
            beside.figure.name: beside.published.model_dump(exclude_none=True)
            for beside in published_figures(flight.scenario.published)
        },
    }


def write_telemetry(flight: Flight, path: Path) -> None:
    """Write all telemetry columns as Parquet; unit and meaning of each are in the column's metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from edl6dof.telemetry.columns import describe

    fields = []
    for name in flight.telemetry:
        unit, meaning = describe(name)
        fields.append(pa.field(name, pa.float64(), metadata={"unit": unit, "meaning": meaning}))
    metadata = {
        "edl6dof_version": __version__,
        "scenario": flight.resolved_scenario,
        "outcome": flight.outcome,
        "phases": json.dumps(flight.phase_names),
    }
    schema = pa.schema(fields, metadata=metadata)
    rows = len(flight.log)
    options = {"compression": "zstd", "use_dictionary": False, "use_byte_stream_split": True}
    with pq.ParquetWriter(path, schema, **options) as writer:
        for start in range(0, rows, ROW_GROUP):
            columns = flight.telemetry.rows(start, start + ROW_GROUP).values()
            # from their memory as it is: pa.array would import pandas, where that is installed
            part = [_array(np.ascontiguousarray(values, float)) for values in columns]
            writer.write_table(pa.Table.from_arrays(part, schema=schema))
            del columns, part
    pa.default_memory_pool().release_unused()  # 30 MB that the system would not get back


def _array(values: np.ndarray) -> Any:
    import pyarrow as pa

    return pa.Array.from_buffers(pa.float64(), len(values), [None, pa.py_buffer(values)])
