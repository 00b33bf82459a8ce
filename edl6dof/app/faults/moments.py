"""The text of ``--at``: ``60,129.5``, ``every 10 s``, ``bank_reversal,mortar``, or several of these."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.design.sections import FaultMoment
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.wording import nearest
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import fly
from edl6dof.telemetry.timeline import NO_MILESTONE, milestone

_OPTION = "--at"
_NUMBER = r"(\d+\.?\d*|\.\d+)(?: *s)?"
_TIME, _EVERY = re.compile(_NUMBER), re.compile(rf"every +{_NUMBER}")
#: More in one matrix are a slip of the pen.
_MOST = 2000
#: Events that no mission names.
_ALWAYS = ("bank_reversal", "trim_wing_open", "line_stretch", "touchdown")

#: What a part of the text asks for: times, an interval, or the name of an event.
_Wanted = float | tuple[float] | str


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
    return Problem(_OPTION, 0, 0, "", words)
