"""Content of the JSON files of a campaign's folder."""

from __future__ import annotations

from typing import Any, Literal

from edl6dof.campaign.storage.files import Sealed
from edl6dof.campaign.storage.identity import Identity


class Info(Sealed):
    """Content of ``campaign.json``.

    Attributes:
        until: when to stop early, as ``--until`` says it.
        identity: what the rows follow from.
        device: what computed them, if that is not the processor: their last digits follow from it too.
    """

    until: str | None
    identity: Identity
    device: str | None = None


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
