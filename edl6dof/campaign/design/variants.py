"""Scenarios that differ from a loaded one in a few values: each a validated override of it.

Numbers are put into the plain data that was read from the files, and the sections that they stand in are
validated again; the others are shared, and so are the tables and plans that follow from the same inputs.  The
result is the same, bit for bit, as loading the scenario with the same ``--set`` texts.  A change that is no
number may bring another structure with it: the whole document is checked.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from edl6dof.campaign.design.case import Case
from edl6dof.config.document.overrides import make_room, with_values
from edl6dof.config.document.source import Document, Mark
from edl6dof.config.document.yamltree import Path
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.validate import refuse, revalidated
from edl6dof.scenario.records import Records, build_records
from edl6dof.scenario.schema import LoadedScenario, Scenario, check_document


@dataclass(frozen=True)
class Variant:
    """One case ready to fly."""

    loaded: LoadedScenario
    parts: Records


def scenario_of(loaded: LoadedScenario, case: Case) -> LoadedScenario:
    """The scenario of a case, checked like a file.

    Raises:
        ConfigError: a path does not exist, or its value is not allowed.
    """
    return check_document(with_values(loaded.document, case.changes(loaded.scenario.truth), Scenario))


class Variants:
    """Makes the cases of one scenario; may be used by several threads at once."""

    def __init__(self, loaded: LoadedScenario):
        self.base = loaded
        self._template = loaded.document.copy()
        self._places: dict[str, Path] = {}

    def build(self, case: Case) -> Variant:
        """Scenario, truth and records of a case.

        Raises:
            ConfigError: a path does not exist, or its value is not allowed.
        """
        truth = case.changes(self.base.scenario.truth)["truth"]
        if all(_is_plain(path, value) for path, value in (*case.told.items(), *truth.items())):
            self._look_up((*case.told, *truth))
            document = Document(self._template.data, {(): Mark("")})
            scenario, document = self._changed(self.base.scenario, document, case.told)
            scenario = scenario.model_copy(update={"truth": truth})
            true, _ = self._changed(scenario, document, truth)
            loaded = LoadedScenario(scenario, true, self.base.document)
        else:
            loaded = scenario_of(self.base, case)
        return Variant(loaded, build_records(loaded))

    def _look_up(self, paths: Iterable[str]) -> None:
        """Find the places of paths not met before; the template gets the default containers on the way."""
        problems = []
        for path in paths:
            if path not in self._places:
                try:
                    self._places[path] = make_room(self._template, path, Scenario)
                except ValueError as error:
                    problems.append(Problem("", 0, 0, path, str(error)))
        if problems:
            raise ConfigError(problems)

    def _changed(
        self, scenario: Scenario, document: Document, changes: Mapping[str, Any]
    ) -> tuple[Scenario, Document]:
        """A scenario and its document with numbers put at dotted paths."""
        if not changes:
            return scenario, document
        changed = Document(_with_values(document.data, changes, self._places), document.marks)
        names = dict.fromkeys(str(self._places[path][0]) for path in changes)
        scenario = revalidated(scenario, changed, names)
        refuse(changed, scenario.section_problems())
        return scenario, changed


def _is_plain(path: str, value: Any) -> bool:
    """Whether a change is a number, numbers, or the list of faults: it leaves the document as it is built."""
    if isinstance(value, list | tuple):
        return path == "faults" or all(_is_plain(path, item) for item in value)
    return isinstance(value, int | float)


def _with_values(
    data: dict[str, Any], changes: Mapping[str, Any], places: Mapping[str, Path]
) -> dict[str, Any]:
    """Nested plain data with values changed; only the containers on the way are copied."""
    copies: dict[Path, Any] = {(): copy.copy(data)}
    for path, value in changes.items():
        keys = places[path]
        for depth in range(1, len(keys)):
            if keys[:depth] not in copies:
                parent = copies[keys[: depth - 1]]
                parent[keys[depth - 1]] = copies[keys[:depth]] = copy.copy(parent[keys[depth - 1]])
        copies[keys[:-1]][keys[-1]] = value
        copies.pop(keys, None)
    return copies[()]
