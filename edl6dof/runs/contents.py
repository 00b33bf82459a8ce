"""What the JSON files of a run hold: the types that are written, and that a file read back must have."""

from __future__ import annotations

from typing import NotRequired, TypeVar

from pydantic import ConfigDict, TypeAdapter, ValidationError, with_config
from typing_extensions import TypedDict

from edl6dof.metrics.published import PublishedFigure

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
