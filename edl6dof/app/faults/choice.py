"""What is to fail, and when: the lists of the command line against what the scenario has."""

from __future__ import annotations

import math
from collections.abc import Sequence

from edl6dof.app.faults.command import Wanted
from edl6dof.app.faults.moments import moments_at
from edl6dof.campaign.design.sections import FaultGroup, FaultMatrixParams, FaultMoment
from edl6dof.campaign.fault_kinds import (
    KINDS,
    OF_INSTRUMENTS,
    OF_THRUSTERS,
    may_fail,
    phases_of,
    usual_phases_of,
)
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.wording import nearest
from edl6dof.scenario.loading import LoadedScenario
from edl6dof.vehicle.faults.component import Component

#: Time from the start of a phase to the fault where none is given, s.
AFTER_S = 1.0


def matrix_of(wanted: Wanted, loaded: LoadedScenario) -> FaultMatrixParams:
    """What fails, and when.

    Raises:
        ConfigError: everything that is wrong with what is wanted.
    """
    choice = _Choice(wanted, loaded)
    failing = choice.failing()
    moments = choice.moments(list(dict.fromkeys(kind for kind, _, _ in failing)))
    if choice.problems:
        raise ConfigError(choice.problems)
    groups = [
        FaultGroup(kind=kind, component=component, names=names, moments=moments[kind])
        for kind, component, names in failing
    ]
    return FaultMatrixParams(groups=groups, together=choice.together)


class _Choice:
    """Looks up what is wanted in a scenario, and collects what is wrong with it."""

    def __init__(self, wanted: Wanted, loaded: LoadedScenario):
        self.wanted, self.loaded, self.scenario = wanted, loaded, loaded.scenario
        self.together = 2 if wanted.pairs else 1
        self.problems: list[Problem] = []

    def failing(self) -> list[tuple[str, Component, list[str]]]:
        """Kinds of fault, each with a kind of component and the names of those that fail so."""
        there = {kind: may_fail(self.scenario, kind) for kind in self._kinds()}
        every = dict.fromkeys(
            name for components in there.values() for names in components.values() for name in names
        )
        only = self._listed("--components", self.wanted.components, list(every)) or list(every)
        found = []
        for kind, components in there.items():
            chosen = {what: [one for one in names if one in only] for what, names in components.items()}
            enough = [(kind, what, names) for what, names in chosen.items() if len(names) >= self.together]
            if not enough and (not self.wanted.sensors or self.wanted.kinds not in ("", "all")):
                self._refuse(f"--kinds {kind}", self._nothing(list(components)))
            found += enough
        if not found and not self.problems:
            self._refuse("--components", self._nothing(["instrument"]))
        return found

    def _nothing(self, components: Sequence[str]) -> str:
        what = " or ".join(components).replace("_", " ")
        return f"there are not two of {what} to fail together" * self.wanted.pairs or (
            f"there is no {what} that could fail"
        )

    def _kinds(self) -> list[str]:
        wanted = self.wanted
        if not wanted.sensors:
            asked = ",".join(OF_THRUSTERS) if wanted.kinds == "all" else wanted.kinds
            return self._listed("--kinds", asked or OF_THRUSTERS[0], KINDS)
        if self.scenario.navigation_filter == "given":
            self._refuse(
                "--sensors",
                "navigation takes the word of ideal instruments: carry real ones (--set "
                "sensors.carried=[...]) and choose a filter (--set "
                "flight_software.navigation.filter=error_state)",
            )
        asked = "" if wanted.kinds == "all" else wanted.kinds
        return self._listed("--kinds", asked or ",".join(OF_INSTRUMENTS), OF_INSTRUMENTS)

    def moments(self, kinds: Sequence[str]) -> dict[str, list[FaultMoment]]:
        """When what fails by each kind of fault does."""
        wanted = self.wanted
        if wanted.at is None:
            return self._in_phases(kinds)
        if wanted.phases or wanted.after_s is not None:
            self._refuse("--at", "names the moments itself; leave out --phases and --after")
        try:
            return dict.fromkeys(kinds, moments_at(wanted.at, self.loaded))
        except ConfigError as error:
            self.problems += error.problems
            return {}

    def _in_phases(self, kinds: Sequence[str]) -> dict[str, list[FaultMoment]]:
        after_s = AFTER_S if self.wanted.after_s is None else self.wanted.after_s
        if not (math.isfinite(after_s) and after_s >= 0.0):
            self._refuse("--after", f"must be a time in s, 0 or more (got {after_s:g})")
            after_s = 0.0
        asked = self._listed("--phases", self.wanted.phases, self.scenario.phase_names)
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
