"""What each law flies: dispersed landings, diverts, late releases, and faults of the engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import load_plan
from edl6dof.interface.roles import PARACHUTE, POWERED_DECELERATION
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.scenario.schema import Scenario

SCENARIO = "tianwen1_mc"
POWERED = "flight_software.guidance.powered"
DISPERSED = "dispersed"
#: Diverts (m) against the drift, and dispersed flights for each flight of one of them.
DIVERTS, _PER_DIVERT = (0.0, 300.0, 600.0), 10
#: Heights (m) of a late release of the backshell, in flights that are not dispersed: the first three are too
#: low for any law to stop.
LATE_RELEASES = (300.0, 325.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 800.0)


def _weak(left: float) -> dict[str, Any]:
    return {"kind": "engine_shortfall", "engine_shortfall": {"thrust_factor": left}}


def _late(seconds: float) -> dict[str, Any]:
    return {"kind": "ignition_delay", "ignition_delay": {"delay_s": seconds}}


#: Faults of the engine in flights that are not dispersed: when after backshell release (s), and which.
ENGINE_FAULTS: dict[str, tuple[float, dict[str, Any]]] = {
    **{f"{100.0 * left:g} % thrust": (0.0, _weak(left)) for left in (0.8, 0.7, 0.6)},
    **{f"{late:g} s late": (0.0, _late(late)) for late in (2.0, 4.0)},
    **{f"stuck {after:g} s": (after, {"kind": "throttle_stuck"}) for after in (5.0, 20.0, 35.0)},
    "dead 20 s": (20.0, {"kind": "engine_dead"}),
}


def divert(metres: float) -> str:
    """Condition of a divert."""
    return f"divert {metres:g} m"


def release(height: float) -> str:
    """Condition of a late release."""
    return f"released at {height:g} m"


def with_law(law: str) -> LoadedScenario:
    """The landing flown by a law."""
    return load_scenario(SCENARIO, ["simulation.log_every=5", f"{POWERED}.law={law}"])


def dispersed(flights: int) -> list[Case]:
    """The first cases of the campaign, the same whatever law flies them."""
    return list(load_plan(SCENARIO).cases(0, flights))


def cases(scenario: Scenario, flights: Sequence[Case], law: str) -> list[Case]:
    """All that a law flies of the scenario."""
    conditions: list[tuple[str, Case, dict[str, float]]] = [(DISPERSED, one, {}) for one in flights]
    some = flights[: max(len(flights) // _PER_DIVERT, 1)]
    conditions += [(divert(m), one, {f"{POWERED}.target.divert_m": m}) for m in DIVERTS for one in some]
    planned = [
        Case(i, one.truth, {**one.belief, **told}, one.profile, _label(law, condition, one.index))
        for i, (condition, one, told) in enumerate(conditions)
    ]
    planned += _late_releases(scenario, law, len(planned))
    return [*planned, *_with_faults(scenario, law, len(planned))]


def _phase(scenario: Scenario, role: str) -> str:
    return next(phase.name for phase in scenario.mission.phases if phase.role == role)


def _late_releases(scenario: Scenario, law: str, first: int) -> Iterator[Case]:
    key = f"mission.phases.{_phase(scenario, PARACHUTE)}.until.value"
    for i, height in enumerate(LATE_RELEASES):
        yield Case(first + i, {}, {key: height}, 0, _label(law, release(height), i))


def _with_faults(scenario: Scenario, law: str, first: int) -> Iterator[Case]:
    braking = _phase(scenario, POWERED_DECELERATION)
    for i, (name, (after, fault)) in enumerate(ENGINE_FAULTS.items()):
        at = {"phase": braking, "plus_s": after}
        truth = {"faults": [{"engine": "main", "at": at, **fault}]}
        yield Case(first + i, truth, {}, 0, _label(law, name, i))


def _label(law: str, condition: str, flight: int) -> dict[str, Any]:
    return {"law": law, "condition": condition, "flight": flight}
