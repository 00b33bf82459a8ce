"""The folder of a campaign: its plan, and its rows in parts that are written completely or not at all.

::

    runs/tianwen1_mc/
      campaign.json     identity of the campaign: hashes of plan, sources, plugins and tables, versions
      campaign.yaml     the plan, every default written out
      parts/000000.parquet ...   while it flies; each holds a fixed range of cases, its SHA-256 next to it
      cases.parquet     all rows, when it is complete
      summary.json      success probability, causes, speed, and the SHA-256 of the rows

If the program is killed or the disk is full, at most the cases of unwritten parts are lost, and a resumed
campaign gives the same table, byte for byte.  This depends on the order in which files appear: a campaign has
begun when ``campaign.yaml`` exists, and is complete when ``summary.json`` exists; the parts are deleted
afterwards.  A campaign is replaced by deleting ``campaign.yaml`` first.  Every read checks a hash.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pyarrow as pa
from filelock import FileLock, Timeout

from edl6dof.campaign.parts import NAMES, Parts, open_parquet
from edl6dof.config.errors import refusal
from edl6dof.durable import make_folder, put_in_place, sync, write_atomic
from edl6dof.manifest import Sealed, digest, hash_of, read_file, read_sealed, sha256, write_sealed

#: Name of an unfinished file of a killed program, with the name of the finished one.
_LEFT = re.compile(r"\.(?:(?P<name>.+)\.\d+\.part|\d+\.(?P<other>.+))")

#: Lock of the process that works in the folder.
_LOCK = ".lock"

_FILES = re.compile(
    r"campaign\.(?:yaml|json)|cases\.parquet|summary\.json|made\.json|(?:report|assurance)\.(?:html|pdf)"
)
_FOLDERS = {"parts": NAMES, "report": re.compile(r".+\.png")}


class Identity(Sealed):
    """Everything that the rows of a campaign follow from: SHA-256 hashes and versions.

    Attributes:
        plan: hash of the plan.
        sources: hash of every source file of the package that a row can follow from.
        versions: versions of the package and of the libraries that can change a bit, by name.
        plugins: hash of each plugin by its path.
        files: hash of each table, vehicle and planet file that is read, by its path; paths in the package
            begin at its folder.
    """

    plan: str
    sources: str
    versions: dict[str, str]
    plugins: dict[str, str]
    files: dict[str, str]

    @property
    def digest(self) -> str:
        """One hash of all items."""
        return digest(self.model_dump())

    def items(self) -> Iterator[tuple[str, str]]:
        """Yield each item with its name in messages."""
        yield from (("plan", self.plan), ("sources of edl6dof", self.sources), *self.versions.items())
        yield from ((f"plugin {name}", value) for name, value in self.plugins.items())
        yield from ((f"file {name}", value) for name, value in self.files.items())


class Info(Sealed):
    """Content of ``campaign.json``; ``until``: condition to stop early, as in ``--until``."""

    until: str | None
    identity: Identity


class Cause(Sealed):
    """A cause of failures and the number of cases that failed by it."""

    cause: str
    cases: int


class Summary(Sealed):
    """Content of ``summary.json``: results of a campaign.

    Attributes:
        campaign: hash of the identity in ``campaign.json``.
        cases_sha256: hash of ``cases.parquet``.
        faults: figures of a fault matrix, see :mod:`edl6dof.campaign.faults`.
    """

    name: str
    kind: Literal["campaign"] = "campaign"
    cases: int
    cases_planned: int
    successes: int
    p_success: float
    p_success_95: list[float]
    causes: list[Cause]
    edl6dof_version: str
    engine: str
    flown_in_this_run: int
    flights_per_second: float
    campaign: str = ""
    cases_sha256: str = ""
    faults: dict[str, Any] | None = None


def _file(name: str) -> Any:
    """A property: the file of this name in a campaign's folder."""
    return property(lambda store: store.folder / name)


@dataclass(frozen=True)
class Store:
    """A campaign's folder.  Every read raises ``ConfigError`` for content that is not as it was written."""

    folder: Path
    _info = _file("campaign.json")
    _plan = _file("campaign.yaml")
    _cases = _file("cases.parquet")
    _summary = _file("summary.json")

    @property
    def info(self) -> Info:
        """Content of ``campaign.json``."""
        if not self.folder.is_dir() or not os.path.lexists(self._info):
            raise refusal(self.folder, "is not the folder of a campaign (no campaign.json)")
        return read_sealed(self._info, Info)

    @property
    def plan_text(self) -> str:
        """Text of the plan."""
        info = self.info
        if self.is_half_begun:
            words = "has no campaign.yaml: the program was stopped while it began or replaced the campaign"
            raise refusal(self.folder, f"{words}; begin it anew with --force")
        plan = read_file(self._plan)
        if sha256(plan) != info.identity.plan:
            words = "is damaged: it is not as it was written; begin the campaign anew with --force"
            raise refusal(self._plan, words)
        return plan.decode()

    @property
    def is_half_begun(self) -> bool:
        """True if a program was stopped while it wrote the plan; other files are then ignored."""
        return os.path.lexists(self._info) and not os.path.lexists(self._plan)

    @property
    def complete(self) -> bool:
        """True if all rows are in one table."""
        return os.path.lexists(self._summary)

    def require_complete(self) -> None:
        """Refuse a folder without a campaign, or with an incomplete one."""
        if self.info and not self.complete:  # reading it checks that there is a campaign
            raise refusal(self.folder, "is not complete; go on with edl6dof campaign FOLDER --resume")

    @property
    def summary(self) -> Summary:
        """Result of the campaign; reading it checks the hash of its table."""
        found, campaign = read_sealed(self._summary, Summary), self.info.identity.digest
        if found.campaign != campaign:
            raise refusal(self._summary, "belongs to another campaign; fly this one anew with --force")
        if hash_of(self._cases) != found.cases_sha256:
            words = "is damaged: it is not as it was written, and its parts are gone"
            raise refusal(self._cases, f"{words}; fly it anew with --force")
        return found

    @property
    def parts(self) -> Parts:
        """The parts of this campaign."""
        return Parts(self.folder / "parts", self.info.identity.digest)

    @contextmanager
    def lock(self, make: bool = False) -> Iterator[None]:
        """Keep other processes out; the system lifts the lock when the process ends, however it ends.

        Args:
            make: True to make the folder if there is none; the folder is removed again if it stays empty.

        Raises:
            ConfigError: another process works in the folder, or there is none.
        """
        made = [path for path in (self.folder, *self.folder.parents) if not path.exists()] if make else []
        if make and not self.folder.exists():
            make_folder(self.folder)
        if not self.folder.is_dir():
            raise refusal(self.folder, "is not a folder" if self.folder.exists() else "no such folder")
        lock = FileLock(self.folder / _LOCK)
        try:
            lock.acquire(timeout=0.0)
        except (Timeout, FileNotFoundError):  # or its owner has just removed the folder
            raise refusal(self.folder, "another process flies this campaign") from None
        try:
            yield
        finally:
            with suppress(OSError):  # Windows lets nobody remove an open file, and filelock does it there
                (self.folder / _LOCK).unlink()
            lock.release()
            with suppress(OSError):
                for folder in made:
                    folder.rmdir()

    def _entries(self) -> list[Path]:
        return sorted(path for path in self.folder.iterdir() if path.name != _LOCK)

    def check_new(self, force: bool) -> None:
        """Check that a campaign may begin in this folder.

        Raises:
            ConfigError: the folder is not empty; with ``force``, the folder is not that of a campaign.
        """
        if not (entries := self._entries()):
            return
        if not force:
            words = "exists, and a campaign keeps its folder, to be found again: go on with --resume"
            raise refusal(self.folder, f"{words}, replace it with --force, or choose another with --out")
        if not os.path.lexists(self._info) and not all(_LEFT.fullmatch(entry.name) for entry in entries):
            words = "is not the folder of a campaign; it is not replaced even with --force"
            raise refusal(self.folder, words)
        list(self._own())

    def begin(self, plan_text: str, info: Info, force: bool = False) -> None:
        """Put a plan into the folder; with ``force``, in place of the campaign that is there.

        Raises:
            ConfigError: see :meth:`check_new`.
        """
        make_folder(self.folder)
        self.check_new(force)
        self._clear()
        write_sealed(self._info, info)
        write_atomic(self._plan, plan_text.encode())

    def _clear(self) -> None:
        """Remove everything but ``campaign.json``, the plan first: without it, other files are ignored."""
        own = list(self._own())
        self._plan.unlink(missing_ok=True)
        sync(self.folder)
        for file in own:
            if file not in (self._plan, self._info):
                file.unlink()
        for name in _FOLDERS:
            with suppress(FileNotFoundError):
                (self.folder / name).rmdir()
        sync(self.folder)

    def _own(self) -> Iterator[Path]:
        """Every file in the folder.

        Raises:
            ConfigError: a file is none that this program writes into the folder of a campaign.
        """
        for entry in self._entries():
            names = _FOLDERS.get(entry.name)
            if names is not None and entry.is_dir() and not entry.is_symlink():
                yield from (_required(file, names) for file in sorted(entry.iterdir()))
            else:
                yield _required(entry, _FILES)

    def tidy(self) -> None:
        """Remove the unfinished files of killed programs, and the parts of a complete campaign."""
        for entry in (*self.folder.glob(".*.part"), *self.folder.glob("parts/.*.part")):
            if _LEFT.fullmatch(entry.name):
                entry.unlink()
        if self.complete:
            self._remove_parts()

    def finish(self, count: int, summary: Summary) -> None:
        """Write the first ``count`` parts as one table, then the summary, and remove all parts.

        Raises:
            ConfigError: a part is damaged or of another campaign.
            OSError: the table cannot be written.
        """
        partial = self.folder / f".cases.parquet.{os.getpid()}.part"
        try:
            self.parts.concatenate(count, partial)
            cases = hash_of(partial)
            put_in_place(partial, self._cases)
        finally:
            partial.unlink(missing_ok=True)
        own = {"campaign": self.info.identity.digest, "cases_sha256": cases}
        write_sealed(self._summary, summary.model_copy(update=own))
        self._remove_parts()

    def _remove_parts(self) -> None:
        folder = self.folder / "parts"
        for file in folder.glob("*"):
            if NAMES.fullmatch(file.name):
                file.unlink()
        with suppress(OSError):
            folder.rmdir()

    def table(self, columns: list[str] | None = None) -> pa.Table:
        """Return all rows so far; columns that no case has are left out."""
        _ = self.plan_text  # without a plan nothing counts
        if self.complete:
            _ = self.summary  # which checks the table
            file = open_parquet(self._cases, self._cases)
            names = [name for name in file.schema_arrow.names if columns is None or name in columns]
            return file.read(names).replace_schema_metadata()
        if indices := self.parts.indices():
            return self.parts.table(indices, columns)
        raise refusal(self.folder, "no case has flown yet")


def _required(path: Path, names: re.Pattern[str]) -> Path:
    """Return the path if it is a file with one of the names, finished or not; refuse any other."""
    left = _LEFT.fullmatch(path.name)
    name = (left["name"] or left["other"]) if left else path.name
    if path.is_file() and names.fullmatch(name):
        return path
    words = "is not of the campaign: the folder is not replaced even with --force; move it elsewhere"
    raise refusal(path, words)
