"""Scenarios that differ from a loaded one in a few values, without reading and checking the whole document
for each.

Numbers are put into copies of the validated models that hold them (:mod:`edl6dof.config.patch`).  Where that
does not do, they are put into the plain data that was read from the file, and the changed section is
validated again.  Records and tables are built anew only where a changed section enters them.  The result is
the same, bit for bit, as loading the scenario with the same ``--set`` texts; a change that is no number goes
that long way.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Iterable, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from threading import Lock
from typing import Annotated, Any

from pydantic import BaseModel, TypeAdapter, ValidationError

from edl6dof.campaign.design.case import Case
from edl6dof.config.document.overrides import apply_overrides, make_room
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.introspect import root_slot
from edl6dof.config.patch import LongWay, patched
from edl6dof.scenario import records
from edl6dof.scenario.records import Records
from edl6dof.scenario.schema import LoadedScenario, Scenario, check_document

#: Sections of the scenario that nothing of the flight computer follows from.
_NOT_BELIEVED = frozenset({"seed", "profile", "wind", "simulation", "limits", "faults", "truth", "published"})

Path = tuple[str | int, ...]

#: Sections of a scenario that are models or lists of models, and what validates them.
_SECTIONS: dict[str, TypeAdapter[Any]] = {
    name: TypeAdapter(Annotated[info.annotation, info])
    for name, info in Scenario.model_fields.items()
    if root_slot(Scenario).child(name).models or root_slot(Scenario).child(name).child(0) is not None
}


@dataclass(frozen=True)
class Variant:
    """One case ready to fly."""

    loaded: LoadedScenario
    parts: Records


class Variants:
    """Makes the cases of one scenario; may be used by several threads at once."""

    def __init__(self, loaded: LoadedScenario):
        self.base = loaded
        self._parts = records.build_records(loaded)
        self._believed = records.build_tables(loaded.scenario)
        self._base_truth = dict(loaded.scenario.truth)
        self._template = copy.deepcopy(loaded.document)
        self._paths: dict[str, Path] = {}
        self._lock = Lock()

    def build(self, case: Case) -> Variant:
        """Scenario, truth and records of a case.

        Raises:
            ConfigError: a path does not exist, or its value is not allowed.
        """
        told, hidden = case.told, case.truth
        truth_changes = {**self._base_truth, **hidden}
        if not all(_is_simple(path, value) for path, value in (*told.items(), *truth_changes.items())):
            loaded = check_document(
                apply_overrides(self.base.document, case.overrides(self._base_truth), Scenario)
            )
            return Variant(loaded, records.build_records(loaded))
        self._look_up((*told, *truth_changes))
        scenario = self._changed(self.base.scenario, [told]).model_copy(update={"truth": truth_changes})
        touched = _sections(told) | _sections(hidden)
        truth = scenario
        if truth_changes:
            start = self.base.truth.model_copy(update={"truth": truth_changes})
            truth = self._changed(start, [told, truth_changes], only=touched)
        loaded = LoadedScenario(scenario, truth, self.base.document)
        return Variant(loaded, self._records(loaded, touched, _sections(told)))

    def _look_up(self, paths: Iterable[str]) -> None:
        """Find the places of paths not met before; the document gets the default containers on the way."""
        problems = []
        with self._lock:
            for path in paths:
                if path not in self._paths:
                    try:
                        self._paths[path] = make_room(self._template, path, Scenario)
                    except ValueError as error:
                        problems.append(Problem("", 0, 0, path, str(error)))
        if problems:
            raise ConfigError(problems)

    def _changed(
        self, base: Scenario, layers: list[Mapping[str, Any]], only: Set[str] | None = None
    ) -> Scenario:
        """``base`` with the sections that ``layers`` of changes touch read again from the document with those
        changes.
        """
        by_section: dict[str, list[tuple[Path, Any]]] = {}
        for path, value in (change for layer in layers for change in layer.items()):
            name, *inside = self._paths[path]
            if only is None or name in only:
                by_section.setdefault(name, []).append((tuple(inside), value))
        sections = {
            name: self._section(name, getattr(base, name), changes) for name, changes in by_section.items()
        }
        changed = base.model_copy(update=sections)
        if by_section and (problems := changed.section_problems()):
            raise ConfigError(Problem("", 0, 0, path, message) for path, message in problems.items())
        return changed

    def _section(self, name: str, base: Any, changes: list[tuple[Path, Any]]) -> Any:
        if isinstance(base, BaseModel):
            with suppress(LongWay):
                return patched(base, changes)
        data = self._template.data.get(name)
        for keys, value in changes:
            data = _with_value(data, keys, value)
        if name not in _SECTIONS:
            return data
        try:
            return _SECTIONS[name].validate_json(json.dumps(data, allow_nan=False))
        except (ValidationError, ValueError) as error:
            raise ConfigError(_problems(name, error)) from None

    def _records(self, loaded: LoadedScenario, touched: Set[str], told: Set[str]) -> Records:
        case, tables, onboard = self._parts
        if not records.same_tables(loaded.truth, self.base.truth):
            tables = records.build_tables(loaded.truth)
        case = records.changed_case(case, loaded.truth, self.base.truth, tables, touched)
        if told - _NOT_BELIEVED:
            same = records.same_tables(loaded.scenario, self.base.scenario)
            onboard = records.build_onboard(
                loaded.scenario, self._believed if same else records.build_tables(loaded.scenario)
            )
        return Records(case, tables, onboard)


def _sections(paths: Iterable[str]) -> frozenset[str]:
    return frozenset(path.partition(".")[0] for path in paths)


def _is_simple(path: str, value: Any) -> bool:
    """Whether a change is a number or numbers inside a section, the number of the random profiles, or the
    list of faults.
    """
    if isinstance(value, list | tuple) and path != "faults":
        return all(_is_simple(path, item) for item in value)
    return path in ("profile", "faults") or isinstance(value, int | float) and _is_inside(path)


@cache
def _is_inside(path: str) -> bool:
    section, _, inside = path.partition(".")
    return section in _SECTIONS and inside != ""


def _with_value(data: Any, keys: Path, value: Any) -> Any:
    """A copy of nested plain data with one value changed; only the containers on the way are copied."""
    if not keys:
        return value
    changed = copy.copy(data)
    if isinstance(changed, dict) and keys[0] not in changed:
        changed[keys[0]] = _with_value(None, keys[1:], value)
    else:
        changed[keys[0]] = _with_value(changed[keys[0]], keys[1:], value)
    return changed


def _problems(section: str, error: Exception) -> list[Problem]:
    if not isinstance(error, ValidationError):
        return [Problem("", 0, 0, section, str(error))]
    found = error.errors(include_url=False)
    return [Problem("", 0, 0, ".".join(map(str, (section, *item["loc"]))), item["msg"]) for item in found]
