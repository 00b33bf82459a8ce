"""A matrix of faults from the lists that a user gives: components, kinds and moments."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.design.sections import FaultGroup, FaultMatrixParams, FaultMoment
from edl6dof.campaign.faults import (
    KINDS,
    OF_INSTRUMENTS,
    OF_THRUSTERS,
    matrix_plan,
    may_fail,
    phases_of,
    usual_phases_of,
)
from edl6dof.config.document.yamltree import parse_yaml
from edl6dof.config.errors import ConfigError, Problem, did_you_mean
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import fly
from edl6dof.telemetry.timeline import NO_MILESTONE, milestone
from edl6dof.vehicle.faults.component import Component
from edl6dof.vehicle.faults.fault import about

#: Time from the start of a phase to the fault by default, s; most moments of a matrix.
AFTER_S, _MOST = 1.0, 2000
_NUMBER = r"(\d+\.?\d*|\.\d+)(?: *s)?"
_TIME, _EVERY = re.compile(_NUMBER), re.compile(rf"every +{_NUMBER}")
#: Events that no mission names.
_ALWAYS = ("bank_reversal", "trim_wing_open", "line_stretch", "touchdown")


class FaultRequest(NamedTuple):
    """Requested faults and moments; lists are texts with commas, empty or ``None`` for the defaults."""

    sensors: bool = False  # fail instruments instead of thrusters
    kinds: str = ""  # kinds of fault
    components: str = ""  # names of what fails
    pairs: bool = False  # fail every two of them together
    phases: str = ""  # phases in which they fail
    after_s: float | None = None  # time from the start of the phase to the fault, s
    at: str | None = None  # moments instead: 60,129.5 or every 10 s or bank_reversal, or several of these
    settings: str = ""  # other keys of each fault, as YAML


def faults_plan(
    scenario: str, sets: Sequence[str], request: FaultRequest, vehicles: int | None, seed: int | None
) -> Plan:
    """Return the plan of requested faults; see :func:`edl6dof.campaign.faults.matrix_plan`."""
    matrix = matrix_of(load_scenario(scenario, sets), request)
    return matrix_plan(scenario, matrix, sets, vehicles, seed)


def matrix_of(loaded: LoadedScenario, request: FaultRequest) -> FaultMatrixParams:
    """Resolve requested faults and moments in a scenario.

    Raises:
        ConfigError: lists all problems of the request.
    """
    choice = _Choice(loaded, request)
    failing = choice.failing()
    moments = choice.moments(list(dict.fromkeys(kind for kind, _, _ in failing)))
    if choice.problems:
        raise ConfigError(choice.problems)
    groups = [
        FaultGroup(
            kind=kind,
            component=component,
            names=names,
            moments=moments[kind],
            settings={**choice.settings, **({kind: size} if size else {})},
        )
        for kind, component, names in failing
        for size in ([{}] if request.pairs else about(kind).sizes(component))
    ]
    return FaultMatrixParams(groups=groups, together=choice.together)


class _Choice:
    """Resolves a request in a scenario and collects its problems."""

    def __init__(self, loaded: LoadedScenario, request: FaultRequest):
        self.loaded, self.scenario, self.request = loaded, loaded.scenario, request
        self.together = 2 if request.pairs else 1
        self.problems: list[Problem] = []
        self.settings = self._settings()

    def _settings(self) -> dict[str, Any]:
        """Return the other keys of each fault."""
        try:
            data = parse_yaml(self.request.settings or "{}", "").data
        except ConfigError as error:
            data = "; ".join(problem.message for problem in error.problems)
        if isinstance(data, dict):
            return data
        self._refuse("--with", f"must be keys of a fault, such as 'duration_s: 20' (got {data})")
        return {}

    def failing(self) -> list[tuple[str, Component, list[str]]]:
        """Return the kinds of fault, each with a kind of component and the names of the failing ones."""
        sensors, kinds = self.request.sensors, self.request.kinds
        possible = {kind: may_fail(self.scenario, kind) for kind in self._kinds()}
        every = [name for of_kind in possible.values() for names in of_kind.values() for name in names]
        every = list(dict.fromkeys(every))
        only = self._listed("--components", self.request.components, every) or every
        found = []
        for kind, of_kind in possible.items():
            chosen = {what: [one for one in names if one in only] for what, names in of_kind.items()}
            enough = [(kind, what, names) for what, names in chosen.items() if len(names) >= self.together]
            if not enough and (not sensors or kinds not in ("", "all")):
                self._refuse(f"--kinds {kind}", self._nothing(list(of_kind)))
            found += enough
        if not found and not self.problems:
            self._refuse("--components", self._nothing(["instrument"]))
        return found

    def _nothing(self, components: Sequence[str]) -> str:
        what = " or ".join(components).replace("_", " ")
        if self.together == 2:
            return f"there are not two of {what} to fail together"
        return f"there is no {what} that could fail"

    def _kinds(self) -> list[str]:
        kinds = self.request.kinds
        if not self.request.sensors:
            asked = ",".join(OF_THRUSTERS) if kinds == "all" else kinds
            return self._listed("--kinds", asked or OF_THRUSTERS[0], KINDS)
        if self.scenario.navigation_filter == "given":
            words = "navigation takes the word of ideal instruments: carry real ones (--set sensors.carried"
            choose = "choose a filter (--set flight_software.navigation.filter=error_state)"
            self._refuse("--sensors", f"{words}=[...]) and {choose}")
        asked = "" if kinds == "all" else kinds
        return self._listed("--kinds", asked or ",".join(OF_INSTRUMENTS), OF_INSTRUMENTS)

    def moments(self, kinds: Sequence[str]) -> dict[str, list[FaultMoment]]:
        """Return the moments of the faults of each kind."""
        phases, after_s, at = self.request.phases, self.request.after_s, self.request.at
        if at is None:
            return self._in_phases(kinds, phases, AFTER_S if after_s is None else after_s)
        if phases or after_s is not None:
            self._refuse("--at", "names the moments itself; leave out --phases and --after")
        try:
            return dict.fromkeys(kinds, moments_at(at, self.loaded))
        except ConfigError as error:
            self.problems += error.problems
            return {}

    def _in_phases(self, kinds: Sequence[str], phases: str, after_s: float) -> dict[str, list[FaultMoment]]:
        if not (math.isfinite(after_s) and after_s >= 0.0):
            self._refuse("--after", f"must be a time in s, 0 or more (got {after_s:g})")
            after_s = 0.0
        asked = self._listed("--phases", phases, self.scenario.phase_names)
        if not phases_of(self.scenario):
            self._refuse("--phases", "there is no phase in which thrusters may fire; give times with --at")
        return {
            kind: [
                FaultMoment.model_validate({"name": phase, "at": {"phase": phase, "plus_s": after_s}})
                for phase in asked or usual_phases_of(self.scenario, kind)
            ]
            for kind in kinds
        }

    def _listed(self, option: str, text: str, allowed: Sequence[str]) -> list[str]:
        """Return the names in a text with commas, in the order of ``allowed``."""
        names = _parts(text)
        for name in names:
            if name not in allowed:
                hint = did_you_mean(name, allowed)
                self._refuse(option, f"no {name!r}{hint} (there are: {', '.join(allowed) or 'none'})")
        return [name for name in allowed if name in names]

    def _refuse(self, option: str, words: str) -> None:
        self.problems.append(Problem(option, 0, 0, "", words))


def _parts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def moments_at(text: str, loaded: LoadedScenario) -> list[FaultMoment]:
    """Return the moments that ``--at`` names, in the order of time.

    Times of events and intervals are those of the nominal flight, which is flown to find them.  Events with
    the same name are numbered.

    Raises:
        ConfigError: lists every part of the text that is not a moment.
    """
    parts = _parts(text)
    if mistakes := list(_mistakes(parts, loaded.scenario)):
        raise ConfigError(Problem("--at", 0, 0, "", words) for words in mistakes)
    events = [] if all(map(_TIME.fullmatch, parts)) else fly(loaded).events
    found: dict[str, float] = {}
    missing = []
    for part in parts:
        if match := _TIME.fullmatch(part):
            found[f"{float(match[1]):g} s"] = float(match[1])
        elif match := _EVERY.fullmatch(part):
            step = float(match[1])
            end = next((event["t_s"] for event in events if event["key"] == "touchdown"), events[-1]["t_s"])
            times = [round(k * step, 9) for k in range(math.ceil(end / step))]  # no rounding of a sum
            found |= {f"{t:g} s": t for t in times}
        else:
            here = [event for event in events if event["key"] == part or event.get("milestone") == part]
            times = [event["t_s"] for event in here]
            numbers = [""] if len(times) == 1 else [f" {k}" for k in range(1, len(times) + 1)]
            found |= {part + number: t for number, t in zip(numbers, times, strict=True)}
            if not times:
                missing.append(Problem("--at", 0, 0, "", f"there is no {part} in the nominal flight"))
    if missing:
        raise ConfigError(missing)
    return [
        FaultMoment.model_validate({"name": name, "at": {"time_s": time}})
        for name, time in sorted(found.items(), key=lambda item: item[1])
    ]


def _mistakes(parts: Sequence[str], scenario: Scenario) -> Iterator[str]:
    """Yield a message for every part that cannot be a moment, or one if there are no parts."""
    allowed, shortest = event_names(scenario), scenario.simulation.time_limit_s / _MOST
    if not parts:
        yield f"names no moment; such as 60,129.5 or 'every 10 s' or {', '.join(allowed)}"
    for part in parts:
        if match := _EVERY.fullmatch(part):
            if float(match[1]) < shortest:
                yield f"{part!r}: the interval must be at least {shortest:g} s"
        elif not _TIME.fullmatch(part) and part not in allowed:
            events = f"(a time in s, 'every 10 s', or an event: {', '.join(allowed)})"
            yield f"no {part!r}{did_you_mean(part, allowed)} {events}"


def event_names(scenario: Scenario) -> list[str]:
    """Return the names of the events and milestones of a flight, in the order of the mission."""
    events = scenario.mission.events.values()
    own = (name for event in events for name in (event.name, milestone(event, scenario.vehicle)))
    return [name for name in dict.fromkeys((*own, *_ALWAYS)) if name != NO_MILESTONE]
