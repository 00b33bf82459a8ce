"""The JSON files of a campaign's folder: each carries its own hash, and is whole or a message names it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from edl6dof.config.errors import refusal
from edl6dof.durable import write_atomic
from edl6dof.manifest import read_file, sha256


class Sealed(BaseModel):
    """Content of a JSON file that carries its own hash."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


Content = TypeVar("Content", bound=Sealed)

#: Key under which a sealed file holds the hash of all else in it.
_SEAL = "sha256"


def digest(data: Any) -> str:
    """SHA-256 of plain data; the order of keys does not count."""
    return sha256(json.dumps(data, sort_keys=True).encode())


def write_sealed(path: Path, data: Sealed) -> None:
    """Write a JSON file that carries its own hash, durably."""
    plain = data.model_dump(mode="json")
    write_atomic(path, (json.dumps({**plain, _SEAL: digest(plain)}, indent=1) + "\n").encode())


def read_sealed(path: Path, kind: type[Content]) -> Content:
    """Read what :func:`write_sealed` wrote.

    Raises:
        ConfigError: it cannot be read, or is not as it was written.
    """
    try:
        plain = json.loads(read_file(path))
        intact = isinstance(plain, dict) and plain.pop(_SEAL, None) == digest(plain)
    except (ValueError, RecursionError):
        intact = False
    if not intact:
        raise refusal(path, "is damaged: it is not as it was written")
    try:
        return kind.model_validate_json(json.dumps(plain))
    except ValidationError:
        raise refusal(path, "was written by another version of edl6dof") from None


class Identity(Sealed):
    """What the rows of a campaign follow from.

    Attributes:
        plan: SHA-256 of the plan.
        sources: SHA-256 of every source file of the package that a row can follow from.
        versions: of the package and of the libraries that can still move a bit, by name.
        plugins: SHA-256 of each plugin by its path.
        files: SHA-256 of each table, vehicle and planet file that is read, by its path; those of the package
            from its folder on.
    """

    plan: str
    sources: str
    versions: dict[str, str]
    plugins: dict[str, str]
    files: dict[str, str]

    @property
    def digest(self) -> str:
        """One hash of it all."""
        return digest(self.model_dump())

    def items(self) -> Iterator[tuple[str, str]]:
        """Each item by the name that messages give it."""
        yield from (("plan", self.plan), ("sources of edl6dof", self.sources), *self.versions.items())
        yield from ((f"plugin {name}", value) for name, value in self.plugins.items())
        yield from ((f"file {name}", value) for name, value in self.files.items())


class Info(Sealed):
    """Content of ``campaign.json``.

    Attributes:
        until: when to stop early, as ``--until`` says it.
        identity: what the rows follow from.
    """

    until: str | None
    identity: Identity


class Cause(Sealed):
    """A cause of failures and how many cases failed by it."""

    cause: str
    cases: int


class Summary(Sealed):
    """Content of ``summary.json``: how a campaign ended.

    Attributes:
        campaign: hash of the identity in ``campaign.json``.
        cases_sha256: hash of ``cases.parquet``.
        faults: what a fault matrix came to, see :mod:`edl6dof.campaign.fault_figures`.
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
