"""Contents of the JSON files of a campaign's folder, each of which carries its own hash."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

from edl6dof.manifest import Sealed, digest


class Identity(Sealed):
    """Everything that the rows of a campaign follow from.

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
        faults: what a fault matrix came to, see :mod:`edl6dof.campaign.faults`.
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
