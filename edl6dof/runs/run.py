"""A run folder read back, for reports, plots and exports: nothing is flown, no code is loaded."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.config.document.document import Document
from edl6dof.config.document.source import parse_document
from edl6dof.config.errors import UnknownName, refusal
from edl6dof.manifest import Manifest
from edl6dof.runs.run_files import LANDING_MAP, Content, Event, Summary, parsed, read_landing_map
from edl6dof.spatial.arrays import interpolate
from edl6dof.telemetry.landing_map import LandingMap
from edl6dof.telemetry.timeline import first_times

TELEMETRY = "telemetry.parquet"


class Run(Mapping[str, np.ndarray]):
    """The telemetry columns of a run by name, read when they are asked for; and its events, summary and
    scenario.

    Every file is compared with the hash of its manifest, and its types are checked, before anything of it is
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
        """Map that the lander saw and the site it chose; ``None`` of a flight without hazard detection."""
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

    @cached_property
    def when(self) -> dict[str, float]:
        """Time (s) of the first event of each key, and of the first phase of each role."""
        return first_times(self.events)

    @property
    def t(self) -> np.ndarray:
        """Time of the rows, s."""
        return self["t_s"]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._columns:
            if name not in self:
                raise UnknownName("channel", name, self)
            # to_numpy of arrow would import pandas, a tenth of a second
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
        """Printed unit of a column."""
        return self._described(name, b"unit")

    def meaning(self, name: str) -> str:
        """Return the meaning of a column."""
        return self._described(name, b"meaning")

    def at(self, name: str, t: float) -> float:
        """A column at a time (s), interpolated."""
        return float(interpolate(t, self.t, self[name]))

    def between(self, since: str = "", until: str = "") -> np.ndarray:
        """Rows between two events, shape (rows,), bool; unbounded where one is empty or did not happen."""
        return (self.t >= self.when.get(since, -np.inf)) & (self.t <= self.when.get(until, np.inf))

    def file(self, name: str) -> Path:
        """A file of the folder for a program that reads it itself, compared with its hash.

        Raises:
            ConfigError: it is missing or damaged.
        """
        self._manifest.read(name)
        return self.folder / name

    def _described(self, name: str, key: bytes) -> str:
        if name not in self:
            raise UnknownName("channel", name, self)
        return (self._schema.field(name).metadata or {}).get(key, b"").decode()

    @cached_property
    def _schema(self) -> Any:
        return self._file.schema_arrow  # which makes it anew each time

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
            raise refusal(
                path,
                "is not the telemetry of a run: it needs a column t_s, a row, and numbers in all columns",
            )
        return file

    def _json(self, name: str, kind: type[Content]) -> Content:
        try:
            return parsed(self._manifest.read(name), kind)
        except ValueError as error:
            raise refusal(self.folder / name, f"is not the file of a run: {error}") from None
