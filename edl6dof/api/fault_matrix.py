"""A matrix of faults from the lists that somebody writes: what is to fail, and when."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.design.sections import FaultGroup, FaultMatrixParams, FaultMoment
from edl6dof.campaign.faults import (
    KINDS,
    OF_INSTRUMENTS,
    OF_THRUSTERS,
    may_fail,
    phases_of,
    usual_phases_of,
)
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.wording import nearest
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import fly
from edl6dof.telemetry.timeline import NO_MILESTONE, milestone
from edl6dof.vehicle.faults.component import Component

#: Time from the start of a phase to the fault where none is given, s.
AFTER_S = 1.0
_NUMBER = r"(\d+\.?\d*|\.\d+)(?: *s)?"
_TIME, _EVERY = re.compile(_NUMBER), re.compile(rf"every +{_NUMBER}")
#: More moments in one matrix are a slip of the pen.
_MOST = 2000
#: Events that no mission names.
_ALWAYS = ("bank_reversal", "trim_wing_open", "line_stretch", "touchdown")

#: What a part of ``at`` asks for: times, an interval, or the name of an event.
_Wanted = float | tuple[float] | str


def listed(names: str | float | Iterable[str | float]) -> str:
    """Write names, or times, as a text with commas."""
    return str(names) if isinstance(names, str | float | int) else ",".join(map(str, names))


def matrix_of(
    loaded: LoadedScenario,
    *,
    sensors: bool = False,
    kinds: str = "",
    components: str = "",
    pairs: bool = False,
    phases: str = "",
    after_s: float | None = None,
    at: str | None = None,
) -> FaultMatrixParams:
    """Choose what fails, and when; lists are texts with commas, empty or ``None`` for the usual.

    Args:
        loaded: the scenario.
        sensors: fail instruments instead of thrusters.
        kinds: kinds of fault.
        components: names of what fails.
        pairs: fail every two of them together.
        phases: phases in which they fail.
        after_s: time from the start of the phase to the fault, s.
        at: moments instead: ``60,129.5``, ``every 10 s``, ``bank_reversal,mortar``, or several of these.

    Raises:
        ConfigError: everything that is wrong with what is wanted.
    """
    choice = _Choice(loaded, sensors, 2 if pairs else 1)
    failing = choice.failing(kinds, components)
    moments = choice.moments(list(dict.fromkeys(kind for kind, _, _ in failing)), phases, after_s, at)
    if choice.problems:
        raise ConfigError(choice.problems)
    groups = [
        FaultGroup(kind=kind, component=component, names=names, moments=moments[kind])
        for kind, component, names in failing
    ]
    return FaultMatrixParams(groups=groups, together=choice.together)


class _Choice:
    """Looks up what is wanted in a scenario, and collects what is wrong with it."""

    def __init__(self, loaded: LoadedScenario, sensors: bool, together: int):
        self.loaded, self.scenario = loaded, loaded.scenario
        self.sensors, self.together = sensors, together
        self.problems: list[Problem] = []

    def failing(self, kinds: str, components: str) -> list[tuple[str, Component, list[str]]]:
        """Kinds of fault, each with a kind of component and the names of those that fail so."""
        there = {kind: may_fail(self.scenario, kind) for kind in self._kinds(kinds)}
        every = dict.fromkeys(
            name for of_kind in there.values() for names in of_kind.values() for name in names
        )
        only = self._listed("--components", components, list(every)) or list(every)
        found = []
        for kind, of_kind in there.items():
            chosen = {what: [one for one in names if one in only] for what, names in of_kind.items()}
            enough = [(kind, what, names) for what, names in chosen.items() if len(names) >= self.together]
            if not enough and (not self.sensors or kinds not in ("", "all")):
                self._refuse(f"--kinds {kind}", self._nothing(list(of_kind)))
            found += enough
        if not found and not self.problems:
            self._refuse("--components", self._nothing(["instrument"]))
        return found

    def _nothing(self, components: Sequence[str]) -> str:
        what = " or ".join(components).replace("_", " ")
        return f"there are not two of {what} to fail together" * (self.together - 1) or (
            f"there is no {what} that could fail"
        )

    def _kinds(self, kinds: str) -> list[str]:
        if not self.sensors:
            asked = ",".join(OF_THRUSTERS) if kinds == "all" else kinds
            return self._listed("--kinds", asked or OF_THRUSTERS[0], KINDS)
        if self.scenario.navigation_filter == "given":
            self._refuse(
                "--sensors",
                "navigation takes the word of ideal instruments: carry real ones (--set "
                "sensors.carried=[...]) and choose a filter (--set "
                "flight_software.navigation.filter=error_state)",
            )
        asked = "" if kinds == "all" else kinds
        return self._listed("--kinds", asked or ",".join(OF_INSTRUMENTS), OF_INSTRUMENTS)

    def moments(
        self, kinds: Sequence[str], phases: str, after_s: float | None, at: str | None
    ) -> dict[str, list[FaultMoment]]:
        """When what fails by each kind of fault does."""
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
        """Names in a text with commas, in the order of ``allowed``."""
        names = [name.strip() for name in text.split(",") if name.strip()]
        for name in names:
            if name not in allowed:
                near = nearest(name, list(allowed))
                hint = f"; did you mean {near!r}?" if near else ""
                self._refuse(option, f"no {name!r}{hint} (there are: {', '.join(allowed) or 'none'})")
        return [name for name in allowed if name in names]

    def _refuse(self, option: str, words: str) -> None:
        self.problems.append(Problem(option, 0, 0, "", words))


def moments_at(text: str, loaded: LoadedScenario) -> list[FaultMoment]:
    """The moments that ``--at`` names, in the order of time; of events and intervals those of the nominal
    flight, which is flown for it.

    Raises:
        ConfigError: every part of the text that is none.
    """
    wanted, problems = _parsed(text, loaded.scenario)
    if problems:
        raise ConfigError(problems)
    if all(isinstance(one, float) for one in wanted):
        found = {_seconds(one): one for one in wanted if isinstance(one, float)}
    else:
        found = _of_flight(wanted, fly(loaded).events)
    return [
        FaultMoment.model_validate({"name": name, "at": {"time_s": time}})
        for name, time in sorted(found.items(), key=lambda item: item[1])
    ]


def _parsed(text: str, scenario: Scenario) -> tuple[list[_Wanted], list[Problem]]:
    allowed = event_names(scenario)
    wanted: list[_Wanted] = []
    problems: list[Problem] = []
    for part in filter(None, (part.strip() for part in text.split(","))):
        if match := _TIME.fullmatch(part):
            wanted.append(float(match[1]))
        elif (match := _EVERY.fullmatch(part)) and float(
            match[1]
        ) >= scenario.simulation.time_limit_s / _MOST:
            wanted.append((float(match[1]),))
        elif match:
            least = scenario.simulation.time_limit_s / _MOST
            problems.append(_problem(f"{part!r}: the interval must be at least {least:g} s"))
        elif part in allowed:
            wanted.append(part)
        else:
            problems.append(_problem(_not_known(part, allowed)))
    if not wanted and not problems:
        problems.append(
            _problem(f"names no moment; such as 60,129.5 or 'every 10 s' or {', '.join(allowed)}")
        )
    return wanted, problems


def event_names(scenario: Scenario) -> list[str]:
    """Names of the events of a flight, their own and those of milestones, in the order of the mission."""
    mission = scenario.mission
    own = [name for event in mission.events.values()
           for name in (event.name, milestone(event, scenario.vehicle))]  # fmt: skip
    return [name for name in dict.fromkeys((*own, *_ALWAYS)) if name != NO_MILESTONE]


def _of_flight(wanted: Sequence[_Wanted], events: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Time (s) of each moment by its name; of several events of one name each has its number."""
    end = next((event["t_s"] for event in events if event["key"] == "touchdown"), events[-1]["t_s"])
    found: dict[str, float] = {}
    problems: list[Problem] = []
    for one in wanted:
        if isinstance(one, float):
            found[_seconds(one)] = one
        elif isinstance(one, tuple):
            found.update((_seconds(t), t) for t in _every(one[0], end))
        elif times := _times_of(one, events):
            numbers = [f" {k}" for k in range(1, len(times) + 1)] if len(times) > 1 else [""]
            found.update((one + number, t) for number, t in zip(numbers, times, strict=True))
        else:
            problems.append(_problem(f"there is no {one} in the nominal flight"))
    if problems:
        raise ConfigError(problems)
    return found


def _times_of(name: str, events: Iterable[Mapping[str, Any]]) -> list[float]:
    return [event["t_s"] for event in events if event["key"] == name or event.get("milestone") == name]


def _every(step: float, end: float) -> list[float]:
    """Multiples of a step from 0 to the end of a flight, without the rounding of a sum."""
    return [round(k * step, 9) for k in range(int(np.ceil(end / step)))]


def _seconds(time: float) -> str:
    return f"{time:g} s"


def _not_known(part: str, allowed: Sequence[str]) -> str:
    near = nearest(part, allowed)
    hint = f"; did you mean {near!r}?" if near else ""
    return f"no {part!r}{hint} (a time in s, 'every 10 s', or an event: {', '.join(allowed)})"


def _problem(words: str) -> Problem:
    return Problem("--at", 0, 0, "", words)
