"""What each law flies: dispersed landings, diverts, and faults of the engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import load_plan
from edl6dof.scenario.schema import LoadedScenario, load_scenario

SCENARIO = "tianwen1_mc"
POWERED = "flight_software.guidance.powered"
DISPERSED = "dispersed"
#: Diverts (m) against the drift, and dispersed flights for each flight of one of them.
DIVERTS, _PER_DIVERT = (0.0, 300.0, 600.0), 10

#: Faults of the engine in flights that are not dispersed: kind, and time after backshell release (s).
ENGINE_FAULTS: tuple[tuple[str, float], ...] = (
    ("engine_shortfall", 0.0),
    ("ignition_delay", 0.0),
    ("throttle_stuck", 5.0),
    ("throttle_stuck", 20.0),
    ("throttle_stuck", 35.0),
    ("engine_dead", 20.0),
)


def divert(metres: float) -> str:
    """Condition of a divert."""
    return f"divert {metres:g} m"


def fault(kind: str, after: float) -> str:
    """Condition of a fault."""
    return f"{kind} {after:g} s"


def with_law(law: str) -> LoadedScenario:
    """The landing flown by a law."""
    return load_scenario(SCENARIO, ["simulation.log_every=5", f"{POWERED}.law={law}"])


def dispersed(flights: int) -> list[Case]:
    """The first cases of the campaign, the same whatever law flies them."""
    return list(load_plan(SCENARIO).cases(0, flights))


def cases(flights: Sequence[Case], law: str) -> list[Case]:
    """All that a law flies."""
    conditions: list[tuple[str, Case, dict[str, float]]] = [(DISPERSED, one, {}) for one in flights]
    some = flights[: max(len(flights) // _PER_DIVERT, 1)]
    conditions += [(divert(m), one, {f"{POWERED}.target.divert_m": m}) for m in DIVERTS for one in some]
    planned = [
        Case(i, one.truth, {**one.belief, **told}, one.profile, _label(law, condition, one.index))
        for i, (condition, one, told) in enumerate(conditions)
    ]
    return [*planned, *_with_faults(law, len(planned))]


def _with_faults(law: str, first: int) -> Iterator[Case]:
    for i, (kind, after) in enumerate(ENGINE_FAULTS):
        at = {"phase": "powered_deceleration", "plus_s": after}
        truth = {"faults": [{"engine": "main", "kind": kind, "at": at}]}
        yield Case(first + i, truth, {}, 0, _label(law, fault(kind, after), i))


def _label(law: str, condition: str, flight: int) -> dict[str, Any]:
    return {"law": law, "condition": condition, "flight": flight}
