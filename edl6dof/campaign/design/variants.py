"""Scenarios that differ from a loaded one in a few values: each a validated override of it.

Numbers are put into the validated scenario: every model on the way to one is validated again, and so is what
must fit together between the sections; the other models are shared, and so are the tables and plans that
follow from the same inputs.  The result is the same, bit for bit, as loading the scenario with the same
``--set`` texts.  A change that is no number may bring another structure with it: the whole document is
checked, as it is to find words for a number that is refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from edl6dof.campaign.design.case import Case
from edl6dof.config.document.overrides import with_values
from edl6dof.config.document.source import Document, Mark
from edl6dof.config.errors import Inconsistent
from edl6dof.config.model_paths import Keys, overridden, walk
from edl6dof.scenario.cross_checks import section_problems
from edl6dof.scenario.loading import LoadedScenario, check_document, truth_problem
from edl6dof.scenario.records import Built, Records, build_records
from edl6dof.scenario.schema import Scenario


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
        self.nominal = Built(loaded, build_records(loaded))
        self._keys: dict[str, Keys] = {}

    def build(self, case: Case) -> Variant:
        """Scenario, truth and records of a case.

        Raises:
            ConfigError: a path does not exist, or its value is not allowed.
        """
        loaded = self._overridden(case) or self._checked(case)
        return Variant(loaded, build_records(loaded, self.nominal))

    def _overridden(self, case: Case) -> LoadedScenario | None:
        """A case whose changes are numbers; ``None`` for any other, and for one that is not allowed."""
        truth = case.changes(self.base.scenario.truth)["truth"]
        plain = all(_is_plain(path, value) for path, value in (*case.told.items(), *truth.items()))
        if not plain or any(map(truth_problem, truth)):
            return None
        try:
            told = {**self._by_keys(case.told), ("truth",): truth}
            scenario = _changed(self.base.scenario, told)
            return LoadedScenario(scenario, _changed(scenario, self._by_keys(truth)), self.base.document)
        except (ValueError, LookupError, AttributeError):
            return None

    def _by_keys(self, changes: Mapping[str, Any]) -> dict[Keys, Any]:
        """Changes by the keys that their dotted paths mean.

        Raises:
            ValueError, LookupError, AttributeError: there is no such path.
        """
        for path in changes:
            if path not in self._keys:
                self._keys[path] = walk(self.base.truth, path)[0]
        return {self._keys[path]: value for path, value in changes.items()}

    def _checked(self, case: Case) -> LoadedScenario:
        """Any case, or what is wrong with it, in words without places: a row is the same on every machine."""
        document = Document(self.base.document.data, {(): Mark("")}, files=self.base.document.files)
        return scenario_of(replace(self.base, document=document), case)


def _changed(scenario: Scenario, values: Mapping[Keys, Any]) -> Scenario:
    """A scenario with other values, validated.

    Raises:
        ValueError, LookupError: they are not allowed.
    """
    changed = overridden(scenario, values)
    if problems := section_problems(changed, like=scenario):
        raise Inconsistent(problems)
    return changed


def _is_plain(path: str, value: Any) -> bool:
    """Whether a change is a number, numbers, or the list of faults: it leaves the document as it is built."""
    if isinstance(value, list | tuple):
        return path == "faults" or all(_is_plain(path, item) for item in value)
    return isinstance(value, int | float)
