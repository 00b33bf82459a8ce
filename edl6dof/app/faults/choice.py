"""What is to fail, and when: the lists of the command line against what the scenario has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from edl6dof.campaign.faults import (
    KINDS,
    OF_INSTRUMENTS,
    OF_THRUSTERS,
    may_fail,
    phases_of,
    sensor_phases_of,
)
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.wording import nearest
from edl6dof.scenario.schema import LoadedScenario, Scenario
from edl6dof.vehicle.faults.component import Component

#: What fails, by kind of fault and kind of component.
Failing = dict[str, dict[Component, list[str]]]


@dataclass(frozen=True)
class FaultOptions:
    """Options of ``edl6dof faults``; lists as texts with commas, empty for the usual ones."""

    scenario: str
    sensors: bool
    kinds: str
    phases: str
    thrusters: str
    after_s: float
    sets: tuple[str, ...]
    out: Path | None
    force: bool
    as_json: bool
    workers: int | None


def choose(options: FaultOptions, loaded: LoadedScenario) -> tuple[Failing, dict[str, list[str]]]:
    """What is to fail, and the phases in which it fails, by kind of fault."""
    scenario = loaded.scenario
    if not (math.isfinite(options.after_s) and options.after_s >= 0.0):
        raise _refusal("--after", f"must be a time in s, 0 or more (got {options.after_s:g})")
    if not (usual := phases_of(scenario)):
        words = "there is no phase in which thrusters may fire"
        raise ConfigError([Problem(options.scenario, 0, 0, "mission.phases", words)])
    failing = _instruments(options, scenario) if options.sensors else _vehicle(options, scenario)
    asked = _chosen("--phases", options.phases, scenario.phase_names, [])
    if options.sensors:
        return failing, {kind: asked or sensor_phases_of(scenario, kind) for kind in failing}
    return failing, dict.fromkeys(failing, asked or usual)


def _vehicle(options: FaultOptions, scenario: Scenario) -> Failing:
    """Thrusters, or what other kinds of fault are about."""
    asked = ",".join(OF_THRUSTERS) if options.kinds == "all" else options.kinds
    failing: Failing = {}
    for kind in _chosen("--kinds", asked, KINDS, ["stuck_off"]):
        ((what, names),) = may_fail(scenario, kind).items()
        if not names:
            raise _nothing(options, kind, [what])
        only = options.thrusters if what == "thruster" else ""
        failing[kind] = {what: _chosen("--thrusters", only, names, names)}
    return failing


def _instruments(options: FaultOptions, scenario: Scenario) -> Failing:
    """Every instrument that is carried; all kinds, as far as there is one that could fail so."""
    if options.thrusters:
        raise _refusal("--thrusters", "instruments fail with --sensors, and no thruster")
    if scenario.navigation_filter == "given":
        words = (
            "navigation takes the word of ideal instruments: carry real ones (--set sensors.carried=[...]) "
            "and choose a filter (--set flight_software.navigation.filter=error_state)"
        )
        raise _refusal("--sensors", words)
    asked = "" if options.kinds == "all" else options.kinds
    failing = {
        kind: may_fail(scenario, kind) for kind in _chosen("--kinds", asked, OF_INSTRUMENTS, OF_INSTRUMENTS)
    }
    for kind, components in failing.items():
        if asked and not any(components.values()):
            raise _nothing(options, kind, list(components))
    return {kind: components for kind, components in failing.items() if any(components.values())}


def _nothing(options: FaultOptions, kind: str, components: Sequence[str]) -> ConfigError:
    words = f"there is no {' or '.join(components).replace('_', ' ')} that could fail"
    return ConfigError([Problem(options.scenario, 0, 0, f"--kinds {kind}", words)])


def _refusal(option: str, words: str) -> ConfigError:
    return ConfigError([Problem(option, 0, 0, "", words)])


def _chosen(option: str, text: str, allowed: Sequence[str], usual: Sequence[str]) -> list[str]:
    """Names in a text with commas, in the order of ``allowed``."""
    names = [name.strip() for name in text.split(",") if name.strip()]
    problems = []
    for name in names:
        if name not in allowed:
            near = nearest(name, list(allowed))
            hint = f"; did you mean {near!r}?" if near else ""
            problems.append(Problem(option, 0, 0, "", f"no {name!r}{hint} (there are: {', '.join(allowed)})"))
    if problems:
        raise ConfigError(problems)
    return [name for name in allowed if name in names] or list(usual)
