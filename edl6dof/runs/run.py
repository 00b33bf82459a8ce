"""The folder of one flight: how its files are written, and how they are read back for reports, plots and
exports without flying anything or loading code.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NotRequired, TypeVar

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from edl6dof import __version__
from edl6dof.config.document.document import Document
from edl6dof.config.document.source import parse_document
from edl6dof.config.dump import json_text
from edl6dof.config.errors import UnknownName, refusal
from edl6dof.manifest import Manifest
from edl6dof.metrics.published import PublishedFigure, published_figures
from edl6dof.spatial.arrays import interpolate
from edl6dof.telemetry.landing_map import LandingMap
from edl6dof.telemetry.timeline import first_times

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight

TELEMETRY, LANDING_MAP = "telemetry.parquet", "landing_map.npz"
#: Rows written at a time, so that writing needs little memory.
ROW_GROUP = 2_500
#: Largest array of a landing map, in bytes; a map of 256 x 256 single-precision numbers has a fourth of it.
_LARGEST = 1_048_576
#: Room for the header of a ``.npy`` member.
_HEADER = 1024

Content = TypeVar("Content")
_EXACT = ConfigDict(strict=True, allow_inf_nan=False)


@with_config(_EXACT)
class Limit(TypedDict):
    """One limit of the scenario with the flight's value, in ``unit``; null if the flight has no value."""

    name: str
    value: float | None
    limit: float
    unit: str
    least: bool
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

    The start of a phase also has the ``phase`` and its ``role``, an event of the mission its ``milestone``
    (empty for none), a diagnosis the ``thruster`` and the kind of fault ``isolated``.
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


class FlightColumns(Mapping[str, np.ndarray]):
    """Telemetry columns of a flight by name, each shape (rows,), with its events and figures."""

    @property
    @abstractmethod
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline."""

    @property
    @abstractmethod
    def figures(self) -> Mapping[str, float | None]:
        """Figures of merit by name with unit suffix."""

    @cached_property
    def when(self) -> dict[str, float]:
        """Time (s) of the first event of each key, and of the first phase of each role."""
        return first_times(self.events)

    @property
    def t(self) -> np.ndarray:
        """Time of the rows, s."""
        return self["t_s"]

    def at(self, name: str, t: float) -> float:
        """Return a column at a time (s), interpolated."""
        return float(interpolate(t, self.t, self[name]))

    def between(self, since: str = "", until: str = "") -> np.ndarray:
        """Return the rows between two events, shape (rows,), bool; without a bound where one is empty or did
        not happen.
        """
        return (self.t >= self.when.get(since, -np.inf)) & (self.t <= self.when.get(until, np.inf))


class Run(FlightColumns):
    """The telemetry columns of a run by name, read when they are asked for; and its events, summary and
    scenario.

    Every file is compared with its hash in the manifest, and its types are checked, before any content is
    used.

    Raises:
        ConfigError: the folder is no run, or one of its files is missing, damaged or cannot be read.
    """

    def __init__(self, folder: Path):
        self.folder = folder
        if not folder.is_dir():
            raise refusal(folder, "no such folder; name the folder of a run")
        self._manifest = Manifest.of(folder)
        if self._manifest.kind != "flight":
            raise refusal(folder, f"holds a result of kind {self._manifest.kind!r}; name the folder of a run")
        for name in (TELEMETRY, "events.json", "summary.json", "scenario.yaml"):
            if not (folder / name).is_file():
                raise refusal(folder / name, "is missing: the run is not complete")

    @cached_property
    def summary(self) -> Summary:
        """Outcome, figures, limits and published figures."""
        return self._json("summary.json", Summary)

    @cached_property
    def events(self) -> list[Event]:
        """The timeline."""
        return self._json("events.json", list[Event])

    @property
    def figures(self) -> dict[str, float | None]:
        """Figures of merit by name; ``None`` for one that could not be computed."""
        return self.summary["figures"]

    @cached_property
    def scenario_text(self) -> str:
        """The resolved scenario as YAML."""
        return self._manifest.read("scenario.yaml").decode("utf-8")

    @cached_property
    def document(self) -> Document:
        """The resolved scenario with the status of its numbers."""
        return parse_document(self.scenario_text, str(self.folder / "scenario.yaml"))

    @cached_property
    def scenario(self) -> dict[str, Any]:
        """The resolved scenario as plain data: every default is in it."""
        return self.document.data

    @cached_property
    def landing_map(self) -> LandingMap | None:
        """Map of hazard detection and the spot chosen on it; ``None`` without hazard detection."""
        if LANDING_MAP not in self._manifest.files:
            return None
        try:
            return read_landing_map(self._manifest.read(LANDING_MAP))
        except ValueError as error:
            raise refusal(self.folder / LANDING_MAP, str(error)) from None

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.summary["name"]

    @cached_property
    def phase_names(self) -> list[str]:
        """Names of the mission phases; ``guide.phase`` is the index."""
        return [str(phase["name"]) for phase in self.scenario["mission"]["phases"]]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            if name not in self:
                raise UnknownName("channel", name, self)
            # arrow's to_numpy would import pandas, which takes a tenth of a second
            parts = [np.from_dlpack(part) for part in self._file.read([name]).column(0).chunks]
            self._columns[name] = np.concatenate(parts)
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self._schema.names

    def __iter__(self) -> Iterator[str]:
        return iter(self._schema.names)

    def __len__(self) -> int:
        return len(self._schema)

    def unit(self, name: str) -> str:
        """Return the printed unit of a column."""
        return self._described(name, b"unit")

    def meaning(self, name: str) -> str:
        """Return the meaning of a column."""
        return self._described(name, b"meaning")

    def file(self, name: str) -> Path:
        """Return a file of the folder, compared with its hash, for a program that reads it itself.

        Raises:
            ConfigError: the file is missing or damaged.
        """
        self._manifest.read(name)
        return self.folder / name

    def _described(self, name: str, key: bytes) -> str:
        if name not in self:
            raise UnknownName("channel", name, self)
        return (self._schema.field(name).metadata or {}).get(key, b"").decode()

    @cached_property
    def _schema(self) -> Any:
        return self._file.schema_arrow  # each access builds the schema: keep it

    @cached_property
    def _columns(self) -> dict[str, np.ndarray]:
        return {}

    @cached_property
    def _file(self) -> Any:
        import pyarrow as pa
        import pyarrow.parquet as pq

        path = self.folder / TELEMETRY
        content = self._manifest.read(TELEMETRY)
        try:
            file = pq.ParquetFile(pa.BufferReader(content))
        except (OSError, pa.ArrowException) as error:
            raise refusal(path, f"cannot be read: {error}") from None
        schema, rows = file.schema_arrow, file.metadata.num_rows
        if "t_s" not in schema.names or rows == 0 or any(field.type != pa.float64() for field in schema):
            words = "it needs a column t_s, a row, and numbers in all columns"
            raise refusal(path, f"is not the telemetry of a run: {words}")
        return file

    def _json(self, name: str, kind: type[Content]) -> Content:
        """Content of a JSON file, with its types checked."""
        try:
            return TypeAdapter(kind).validate_json(self._manifest.read(name))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = f"{'.'.join(map(str, first['loc']))}: {first['msg']}".removeprefix(": ")
            raise refusal(self.folder / name, f"is not the file of a run: {where}") from None


def write_run(flight: Flight, folder: Path) -> None:
    """Write the files with the numbers of a flight into ``folder``, which must exist."""
    (folder / "scenario.yaml").write_text(flight.resolved_scenario, encoding="utf-8")
    write_telemetry(flight, folder / TELEMETRY)
    (folder / "events.json").write_text(json_text(flight.events), encoding="utf-8")
    (folder / "summary.json").write_text(json_text(summary(flight)), encoding="utf-8")
    if flight.landing_map is not None:
        write_landing_map(flight.landing_map, folder)


def summary(flight: Flight) -> dict[str, Any]:
    """Return outcome, figures, limits and published figures of a flight, ready for JSON."""
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
        "figures": flight.figures,
        "limits": [
            {
                "name": c.label,
                "value": c.value,
                "limit": c.limit,
                "unit": c.unit,
                "least": c.least,
                "ok": c.ok,
            }
            for c in flight.checks
        ],
        "published": {
            beside.figure.name: beside.published.model_dump(exclude_none=True)
            for beside in published_figures(flight.scenario.published)
        },
    }


def write_telemetry(flight: Flight, path: Path) -> None:
    """Write all telemetry columns as Parquet, with unit and meaning in the metadata of each column."""
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
            given = flight.telemetry.rows(start, start + ROW_GROUP).values()
            columns = [np.ascontiguousarray(values, float) for values in given]
            # wrap the memory directly: pa.array would import pandas, if that is installed
            part = [
                pa.Array.from_buffers(pa.float64(), len(one), [None, pa.py_buffer(one)]) for one in columns
            ]
            writer.write_table(pa.Table.from_arrays(part, schema=schema))
            del given, columns, part
    pa.default_memory_pool().release_unused()  # 30 MB that the system would not get back


def write_landing_map(found: LandingMap, folder: Path) -> None:
    """Write a landing map into the folder of a run."""
    np.savez_compressed(folder / LANDING_MAP, **found._asdict())


def read_landing_map(content: bytes) -> LandingMap:
    """Return the landing map from the bytes of its file; only arrays of plain numbers are accepted.

    Raises:
        ValueError: the bytes are no landing map.
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
