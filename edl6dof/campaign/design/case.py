"""One case of a campaign, study or fault matrix: its changes of the scenario, and the records that fly.

Numbers are put into the validated scenario: every model that contains one is validated again, and so is what
must fit together between sections.  The other models are shared, and so are tables and plans with the same
inputs.  The result has the same bits as a scenario loaded with the same ``--set`` texts.  A change that is no
number can change the structure of the document.  The whole document is then checked, and also where a number
is refused, for the message.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property
from math import isclose
from os.path import commonprefix
from typing import Any, Literal, get_args

from edl6dof.config.document.document import Document
from edl6dof.config.document.overrides import with_values
from edl6dof.config.document.source import Mark
from edl6dof.config.errors import Inconsistent
from edl6dof.config.model_paths import Keys, overridden, value_at, walk
from edl6dof.scenario.checks import section_problems
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document, truth_problem
from edl6dof.scenario.records import Records, build_records
from edl6dof.scenario.schema import Scenario

#: A change of the truth alone, of the flight computer's belief alone, or of both.
Of = Literal["truth", "belief", "both"]

#: Prefixes of the columns that hold what was changed.
TRUTH, BELIEF = "truth.", "belief."

#: Columns of the matrix and row of a case in a design of Sobol indices; names of the two matrices.
MATRIX, ROW = "matrix", "row"
A, B = "A", "B"


@dataclass(frozen=True)
class Case:
    """Changes of one flight, by dotted path.

    Attributes:
        index: number of the case; rows are in the order of these numbers.
        truth: values that the flight computer does not know.
        belief: values that the flight computer knows; they also hold in the truth unless ``truth`` has
            another value.
        profile: number of the random profiles (density, gusts) of the scenario's seed; ``None`` for the
            scenario's own.
        label: columns that are copied into the row, such as the name of the law or the failed thruster.
    """

    index: int
    truth: Mapping[str, Any] = field(default_factory=dict)
    belief: Mapping[str, Any] = field(default_factory=dict)
    profile: int | None = None
    label: Mapping[str, Any] = field(default_factory=dict)

    @property
    def overrides(self) -> dict[str, Any]:
        """Changes of the scenario itself."""
        return dict(self.belief) if self.profile is None else {**self.belief, "profile": self.profile}

    def changes(self, truth: Mapping[str, Any]) -> dict[str, Any]:
        """The values by dotted path that turn a scenario with this ``truth`` section into the case."""
        return {**self.overrides, "truth": {**truth, **self.truth}}


def group_of(column: str, campaign: Mapping[str, Any]) -> str:
    """Return the name of the group of a dispersed quantity.

    The quantities of one path with a wildcard form a group, and so do quantities drawn with a correlation.
    Groups are independent of each other.  Any other quantity is a group of one, named by its path.

    Args:
        column: column of the results, such as ``truth.wind.scale``; the group name keeps the prefix of
            belief.
        campaign: the campaign section as plain data.
    """
    mark = BELIEF if column.startswith(BELIEF) else ""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    for together in campaign.get("correlated", ()):
        if path in together["paths"]:
            return f"{mark}{commonprefix(together['paths'])}*"
    patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
    return mark + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)


class NotApplied(Exception):
    """A change of a case has not reached the scenario that flies."""


@dataclass(frozen=True)
class Variant:
    """One case ready to fly."""

    loaded: LoadedScenario
    parts: Records

    def applied(self, case: Case) -> dict[str, Any]:
        """Return the values of all changes of the case by column name, read from the records' scenario.

        A dispersion that is silently not applied is the classic failure of Monte Carlo tools; here it stops
        the case.

        Raises:
            NotApplied: the validated scenario has another value.
        """
        row = {TRUTH + path: _confirmed(self.loaded.truth, path, value) for path, value in case.truth.items()}
        for path, value in case.overrides.items():
            column = path if path == "profile" else BELIEF + path
            row[column] = _confirmed(self.loaded.scenario, path, value)
        return row


def _confirmed(scenario: Scenario, path: str, wanted: Any) -> Any:
    value = value_at(scenario, path)
    if not _same(value, wanted):
        raise NotApplied(f"{path} should be {wanted!r} and is {value!r}")
    return value


def _same(value: Any, wanted: Any) -> bool:
    if isinstance(wanted, list | tuple):
        return len(value) == len(wanted) and all(map(_same, value, wanted))
    if isinstance(wanted, float) or isinstance(value, float):
        # a model may bring a value to its normal form, such as a direction to length one
        return isclose(value, wanted, rel_tol=1e-3, abs_tol=1e-12)
    return not isinstance(wanted, bool | int | str) or value == wanted


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
        self._keys: dict[str, Keys] = {}

    @cached_property
    def nominal(self) -> Variant:
        """The scenario itself, ready to fly."""
        return Variant(self.base, build_records(self.base))

    def build(self, case: Case) -> Variant:
        """Scenario, truth and records of a case.

        Raises:
            ConfigError: a path does not exist, or a value is not allowed.
        """
        loaded = self._overridden(case) or self._checked(case)
        return Variant(loaded, build_records(loaded))

    def _overridden(self, case: Case) -> LoadedScenario | None:
        """Scenario of a case whose changes are allowed numbers; ``None`` for any other case."""
        truth = case.changes(self.base.scenario.truth)["truth"]
        plain = all(_is_plain(path, value) for path, value in (*case.overrides.items(), *truth.items()))
        if not plain or any(map(truth_problem, truth)):
            return None
        try:
            overrides = {**self._by_keys(case.overrides), ("truth",): truth}
            scenario = _changed(self.base.scenario, overrides)
            return LoadedScenario(scenario, _changed(scenario, self._by_keys(truth)), self.base.document)
        except (ValueError, LookupError, AttributeError):
            return None

    def _by_keys(self, changes: Mapping[str, Any]) -> dict[Keys, Any]:
        for path in changes:
            if path not in self._keys:
                self._keys[path] = walk(self.base.truth, path)[0]
        return {self._keys[path]: value for path, value in changes.items()}

    def _checked(self, case: Case) -> LoadedScenario:
        """Scenario of any case, the whole document checked.  Messages have no places in files, so that a row
        is the same on every machine.
        """
        document = Document(self.base.document.data, {(): Mark("")}, files=self.base.document.files)
        return scenario_of(LoadedScenario(self.base.scenario, self.base.truth, document), case)


def _changed(scenario: Scenario, values: Mapping[Keys, Any]) -> Scenario:
    changed = overridden(scenario, values)
    if problems := section_problems(changed):
        raise Inconsistent(problems)
    return changed


def _is_plain(path: str, value: Any) -> bool:
    """Return whether a change is numbers or the list of faults, which keep the structure of the document."""
    if isinstance(value, list | tuple):
        return path == "faults" or all(_is_plain(path, item) for item in value)
    return isinstance(value, int | float)
