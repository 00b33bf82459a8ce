"""The folder of a campaign: its plan, and the rows in parts that appear whole or not at all.

::

    runs/tianwen1_mc/
      campaign.yaml     the plan, every default written out
      campaign.json     version, source hash, plugins with theirs, number of cases, size of a part
      parts/000000.parquet ...   while it flies; each holds a fixed range of cases
      cases.parquet     all rows, when it is complete
      summary.json      success probability, causes, speed

A part is written beside its place, forced to the disk and renamed; killing the program at any moment, or filling the disk, loses
at most the cases of the parts not yet in place, and going on gives the same table, byte for byte.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

#: Cases in one part: a few seconds of flying.
PART = 50

#: Rows in memory while the parts are put together.
_ROW_GROUP = 4096

_OPTIONS = {"compression": "zstd", "use_dictionary": ["cause", "outcome"], "write_statistics": False}


class StoreError(Exception):
    """The folder cannot be used; the text says why."""


@dataclass(frozen=True)
class Store:
    """A campaign's folder."""

    folder: Path

    @property
    def plan_text(self) -> str:
        """The plan that the folder was begun with."""
        return self._read("campaign.yaml").decode()

    @property
    def info(self) -> dict[str, Any]:
        """What ``campaign.json`` says."""
        return json.loads(self._read("campaign.json"))

    @property
    def complete(self) -> bool:
        """Whether all rows are together in one table."""
        return (self.folder / "cases.parquet").is_file()

    def _read(self, name: str) -> bytes:
        try:
            return (self.folder / name).read_bytes()
        except OSError:
            raise StoreError(f"{self.folder} is not the folder of a campaign (no {name})") from None

    def begin(self, plan_text: str, info: dict[str, Any]) -> None:
        """Make a new folder.

        Raises:
            StoreError: there is something already.
        """
        if self.folder.exists() and (not self.folder.is_dir() or any(self.folder.iterdir())):
            raise StoreError(f"{self.folder} exists; go on with --resume, replace it with --force, or choose another with --out")
        (self.folder / "parts").mkdir(parents=True, exist_ok=True)
        write_atomic(self.folder / "campaign.yaml", plan_text.encode())
        write_atomic(self.folder / "campaign.json", (json.dumps(info, indent=1) + "\n").encode())

    def clear(self) -> None:
        """Remove the files of a campaign, and nothing else.

        Raises:
            StoreError: the folder holds something that is no campaign.
        """
        if not self.folder.exists():
            return
        if any(self.folder.iterdir()) and not (self.folder / "campaign.json").is_file():
            raise StoreError(f"{self.folder} is not the folder of a campaign; it is not replaced even with --force")
        for file in self.parts():
            file.unlink()
        with suppress(OSError):
            (self.folder / "parts").rmdir()
        for name in ("cases.parquet", "summary.json", "report.html", "campaign.yaml", "campaign.json"):
            (self.folder / name).unlink(missing_ok=True)

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Keep other processes out; the system lifts the lock when the process ends, however it ends.

        Raises:
            StoreError: another process works here.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(self.folder, os.O_RDONLY)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise StoreError(f"{self.folder}: another process flies this campaign") from None
        finally:
            os.close(handle)

    def part(self, index: int) -> Path:
        """File of a part."""
        return self.folder / "parts" / f"{index:06d}.parquet"

    def has_part(self, index: int, first: int, last: int) -> bool:
        """Whether a part is in place with exactly its cases."""
        try:
            with pq.ParquetFile(self.part(index)) as file:
                return file.read(["case"])["case"].to_pylist() == list(range(first, last))
        except (OSError, pa.ArrowException, KeyError):
            return False

    def write_part(self, index: int, table: pa.Table) -> None:
        """Put a part in place."""
        sink = pa.BufferOutputStream()
        pq.write_table(table, sink, **_OPTIONS)
        write_atomic(self.part(index), sink.getvalue())

    def parts(self) -> list[Path]:
        """Files of all parts in place, in order."""
        return sorted((self.folder / "parts").glob("[0-9]*.parquet"))

    def finish(self, parts: int, summary: dict[str, Any]) -> None:
        """Put the first ``parts`` parts together, and remove them."""
        files = [self.part(index) for index in range(parts)]
        partial = self.folder / f".cases.{os.getpid()}.part"
        try:
            _concatenate(files, partial)
            os.replace(partial, self.folder / "cases.parquet")
        finally:
            partial.unlink(missing_ok=True)
        write_atomic(self.folder / "summary.json", (json.dumps(summary, indent=1) + "\n").encode())
        for file in self.parts():
            file.unlink()
        with suppress(OSError):
            (self.folder / "parts").rmdir()

    def table(self, columns: list[str] | None = None) -> pa.Table:
        """All rows so far; columns that no case has are left out."""
        files = [self.folder / "cases.parquet"] if self.complete else self.parts()
        if not files:
            raise StoreError(f"{self.folder}: no case has flown yet")
        schema = _common_schema(files)
        wanted = [name for name in schema.names if columns is None or name in columns]
        return pa.concat_tables(_read(file, schema, wanted) for file in files)


def _common_schema(files: list[Path]) -> pa.Schema:
    """Columns of all parts, in the order in which they first appear; an all-empty column takes the type of a later part."""
    return pa.unify_schemas([pq.read_schema(file).remove_metadata() for file in files], promote_options="permissive")


def _read(path: Path, schema: pa.Schema, names: list[str]) -> pa.Table:
    """Columns of a part; those it lacks are empty."""
    with pq.ParquetFile(path) as file:
        known = set(file.schema_arrow.names)
        table = file.read([name for name in names if name in known], use_threads=False)
    kinds = {name: schema.field(name).type for name in names}
    columns = [table[name].cast(kind) if name in known else pa.nulls(len(table), kind) for name, kind in kinds.items()]
    return pa.table(columns, schema=pa.schema([schema.field(name) for name in names]))


def _concatenate(files: list[Path], target: Path) -> None:
    """One file of many, some row groups at a time."""
    schema = _common_schema(files)
    with pq.ParquetWriter(target, schema, **_OPTIONS) as writer:
        waiting: list[pa.Table] = []
        for file in files:
            waiting.append(_read(file, schema, schema.names))
            if sum(map(len, waiting)) >= _ROW_GROUP:
                writer.write_table(pa.concat_tables(waiting))
                waiting = []
        if waiting:
            writer.write_table(pa.concat_tables(waiting))
    with open(target, "rb") as file:
        os.fsync(file.fileno())


def write_atomic(path: Path, content: bytes | pa.Buffer) -> None:
    """Write a file that is either the old or the new one after any kill or full disk."""
    partial = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(partial, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
