"""The rows of a campaign in parts, each written completely or not at all.

The SHA-256 of each part is written first, in a file of its own, as ``sha256sum`` writes it.  A part also
contains the identity of its campaign.  A part that is damaged or of another campaign is flown again.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from edl6dof.config.errors import ConfigError, refusal
from edl6dof.durable import make_folder, write_atomic
from edl6dof.manifest import read_file, sha256

#: Cases in one part: a few seconds of flying.
PART = 50

#: Rows in memory while the parts are put together.
_ROW_GROUP = 4096

#: Names of files in the folder of the parts.
NAMES = re.compile(r"(\d{6,})\.(?:parquet|sha256)")

_OPTIONS = {
    "compression": "zstd",
    "use_dictionary": ["cause", "outcome"],
    "write_statistics": False,
    "write_page_checksum": True,
}
_IDENTITY = b"edl6dof.campaign"


@dataclass(frozen=True)
class Parts:
    """The parts of one campaign; part ``k`` has the ``PART`` cases from number ``k * PART`` on."""

    folder: Path
    identity: str

    def path(self, index: int) -> Path:
        """Path of the file of a part."""
        return self.folder / f"{index:06d}.parquet"

    def indices(self) -> list[int]:
        """Numbers of the parts that exist, in ascending order."""
        found = map(NAMES.fullmatch, (path.name for path in self.folder.glob("*.parquet")))
        return sorted(int(match[1]) for match in found if match)

    def write(self, index: int, table: pa.Table) -> None:
        """Write a part, and its hash first.

        Raises:
            OSError: a file cannot be written.
        """
        sink = pa.BufferOutputStream()
        pq.write_table(table.replace_schema_metadata({_IDENTITY: self.identity}), sink, **_OPTIONS)
        path, written = self.path(index), sink.getvalue()
        make_folder(self.folder)
        write_atomic(path.with_suffix(".sha256"), f"{sha256(written)}  {path.name}\n".encode())
        write_atomic(path, written)

    def read(self, index: int) -> pq.ParquetFile:
        """Read a part.

        Raises:
            ConfigError: the part is not as this campaign wrote it, or cannot be read.
        """
        path = self.path(index)
        written = read_file(path)
        if read_file(path.with_suffix(".sha256")) != f"{sha256(written)}  {path.name}\n".encode():
            raise refusal(path, "is damaged: it is not as it was written; campaign --resume flies it again")
        file = open_parquet(path, pa.BufferReader(written))
        if (file.schema_arrow.metadata or {}).get(_IDENTITY) != self.identity.encode():
            raise refusal(path, "belongs to another campaign; campaign --resume flies it again")
        return file

    def successes(self, index: int, first: int, last: int) -> int | None:
        """Number of successful cases; ``None`` if a part is unreadable or has other cases than its own."""
        with suppress(ConfigError):
            table = self.read(index).read(["case", "success"])
            if table["case"].to_pylist() == list(range(first, last)):
                return pc.sum(table["success"]).as_py()
        return None

    def table(self, indices: Iterable[int], columns: Collection[str] | None = None) -> pa.Table:
        """The rows of some parts; columns that no case has are left out.

        Raises:
            ConfigError: see :meth:`read`.
        """
        indices = list(indices)  # one part at a time is held
        schema = _schema(map(self.read, indices))
        return _joined(schema, (_read(self.read(index), columns) for index in indices), columns)

    def concatenate(self, count: int, target: Path) -> None:
        """Write the first ``count`` parts as one file, some row groups at a time.

        Raises:
            ConfigError: see :meth:`read`.
            OSError: the file cannot be written.
        """
        schema = _schema(map(self.read, range(count)))
        with target.open("wb") as file, pq.ParquetWriter(file, schema, **_OPTIONS) as writer:
            waiting: list[pa.Table] = []
            for index in range(count):
                waiting.append(_read(self.read(index)))
                if sum(map(len, waiting)) >= _ROW_GROUP or index == count - 1:
                    writer.write_table(_joined(schema, waiting))
                    waiting = []


def open_parquet(path: Path, source: Path | pa.BufferReader) -> pq.ParquetFile:
    """A Parquet file whose pages are checked as they are read; ``path`` is its name in messages.

    Raises:
        ConfigError: the file cannot be read.
    """
    try:
        return pq.ParquetFile(source, page_checksum_verification=True)
    except (OSError, pa.ArrowException) as error:
        raise refusal(path, f"cannot be read: {error}") from None


def _schema(files: Iterable[pq.ParquetFile]) -> pa.Schema:
    """Columns in the order of first appearance; one without values takes its type from a later file."""
    schemas = [file.schema_arrow.remove_metadata() for file in files]
    return pa.unify_schemas(schemas, promote_options="permissive")


def _read(file: pq.ParquetFile, columns: Collection[str] | None = None) -> pa.Table:
    names = [name for name in file.schema_arrow.names if columns is None or name in columns]
    return file.read(names, use_threads=False).replace_schema_metadata()


def _joined(
    schema: pa.Schema, tables: Iterable[pa.Table], columns: Collection[str] | None = None
) -> pa.Table:
    """Concatenate tables under the columns of a schema; a column that a table lacks is null in its rows."""
    wanted = pa.schema([field for field in schema if columns is None or field.name in columns])
    return pa.concat_tables([wanted.empty_table(), *tables], promote_options="permissive")
