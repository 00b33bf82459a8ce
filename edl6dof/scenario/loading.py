"""Reading and checking of scenario files, to fly them or only to show them.

The scenario of a result is shown without its plugins: their sections and choices are left out, since pictures
and exports need vehicle, planet, ground, phases and the controllers of the package only.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from edl6dof.config.document.document import Document
from edl6dof.config.document.overrides import apply_overrides, with_values
from edl6dof.config.document.source import parse_document, read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.model_paths import Slot, literal_names, root_slot
from edl6dof.config.refused import steps
from edl6dof.config.validate import judged
from edl6dof.interchange.daveml_vehicle import expand_daveml
from edl6dof.plugins import require
from edl6dof.scenario.checks import file_problems, section_problems, with_whole_paths
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.plugin_trial import try_out
from edl6dof.scenario.schema import Scenario

#: Sections whose true values may differ from the belief of the flight computer: world, vehicle and faults.
TRUE_SECTIONS = (
    *("planet", "atmosphere", "wind", "terrain", "vehicle", "initial"),
    *("point_mass", "sensors", "faults", "seed", "profile"),
)
#: Parameters in these sections that have no effect on a flight.
_LABELS = re.compile(
    r"(planet|vehicle)\.(name|appearance\..+)|vehicle\.daveml|vehicle\.daveml_inputs.*|vehicle\.rcs\.(thrusters|branches)\.[^.]+\.name|terrain\.ellipse_\w+"
)


@cache
def truth_problem(path: str) -> str:
    """Reason why ``truth`` cannot contain a dotted path; empty if it can, or if there is no such path."""
    section = path.strip().partition(".")[0]
    if section not in Scenario.model_fields:
        return ""
    if section not in TRUE_SECTIONS:
        return (
            f"{section} is no part of the true world or vehicle: set it itself; truth may change "
            f"{', '.join(TRUE_SECTIONS)}"
        )
    return "has no effect on the truth of a flight" if _LABELS.fullmatch(path.strip()) else ""


def check_document(document: Document) -> LoadedScenario:
    """Validate a document, and its truth if that differs.

    Raises:
        ConfigError: with every problem found.
    """
    return _sound(*_judged_document(document))


def _sound(loaded: LoadedScenario, problems: list[Problem]) -> LoadedScenario:
    if problems:
        raise ConfigError(problems)
    return loaded


def _judged_document(document: Document) -> tuple[LoadedScenario, list[Problem]]:
    require(document)
    try_out()
    scenario, problems = _judged(document)
    given = document.data.get("truth")
    changes = given if isinstance(given, dict) else {}
    wrong = {path: words for path in changes if (words := truth_problem(path))}
    problems += [document.problem(("truth", path), words) for path, words in wrong.items()]
    true = scenario
    if changes and not wrong:
        try:
            changed = with_values(document, changes, Scenario, lambda path: document.mark(("truth", path)))
        except ConfigError as error:
            problems += error.problems
        else:
            true, more = _judged(changed)
            problems += more
    return LoadedScenario(scenario, true, document), problems


def _judged(document: Document) -> tuple[Scenario, list[Problem]]:
    """The scenario of a document, and the problems of its values, their combination and its tables."""
    scenario, problems = judged(Scenario, document)
    found = {**section_problems(scenario), **file_problems(scenario)}
    return scenario, [*problems, *(document.problem(steps(path), words) for path, words in found.items())]


#: Sections of a scenario file for many flights, calibration and validation, which a single flight does not
#: read.
CAMPAIGN_SECTIONS = ("campaign", "sweep", "fault_matrix")
CALIBRATION, FLOWN = "calibration", "flown"


def load_scenario(name_or_path: str | Path, overrides: Iterable[str] = ()) -> LoadedScenario:
    """Read, override and validate a scenario file, or a shipped scenario by name.

    Raises:
        ConfigError: with every problem found.
    """
    return load_document(read_document(resolve_scenario(str(name_or_path))), overrides)


def load_document(document: Document, overrides: Iterable[str] = ()) -> LoadedScenario:
    """Override and validate a document, without its sections about campaigns.

    Raises:
        ConfigError: with every problem found.
    """
    return _sound(*judged_scenario(document, overrides))


def judged_scenario(
    document: Document, overrides: Iterable[str] = ()
) -> tuple[LoadedScenario, list[Problem]]:
    """Load a document as :func:`load_document`, and list its problems.

    If there are problems, the scenario is only for further checks (:mod:`edl6dof.config.refused`).

    Raises:
        ConfigError: a plugin cannot be used, without which its names and parameters are not known.
    """
    overrides = list(overrides)
    late = [text for text in overrides if text.partition("=")[0].strip().partition(".")[0] == "plugins"]
    problems = [
        Problem(f"--set {text}", 0, 0, "plugins", "must be named in the scenario file") for text in late
    ]
    for name in (*CAMPAIGN_SECTIONS, CALIBRATION, FLOWN):
        document.data.pop(name, None)
        document.forget((name,))
    document, more = _overridden(_expanded(document), [text for text in overrides if text not in late])
    loaded, found = _judged_document(_expanded(document))
    return loaded, [*problems, *more, *found]


def _overridden(document: Document, overrides: list[str]) -> tuple[Document, list[Problem]]:
    """The document with the overrides that can be applied, and the problems of the others."""
    try:
        return apply_overrides(document, overrides, Scenario), []
    except ConfigError as error:
        problems = list(error.problems)
    refused = {problem.file for problem in problems}
    kept = [text for text in overrides if f"--set {text}" not in refused]
    if kept == overrides:
        return document, problems
    changed, more = _overridden(document, kept)
    return changed, [*problems, *more]


def _expanded(document: Document) -> Document:
    """The document with the data of the files that it names, and with absolute paths."""
    try:
        document = expand_daveml(document)
    except ConfigError as error:
        document.refused |= {("vehicle", "mass"): error.problems, ("vehicle", "aero"): ()}
    return with_whole_paths(document)


#: Models of air and wind that replace those of plugins: they need no table.
_STAND_INS = {"atmosphere": "us76", "wind": "none"}


def viewed_scenario(text: str, file: str) -> LoadedScenario:
    """Read the scenario of a resolved file without what only plugins declare.

    Args:
        text: content of the file.
        file: the name shown in messages.

    Raises:
        ConfigError: every problem, with line and key.
    """
    document = parse_document(text, file)
    if document.data.pop("plugins", None):
        document.data = _known(document.data, root_slot(Scenario))
        for name, stand_in in _STAND_INS.items():
            if isinstance(section := document.data.get(name), dict):
                section.setdefault("model", stand_in)
    return check_document(document)


def _known(value: Any, slot: Slot) -> Any:
    """Plain data without keys that the models do not declare, and without names that they do not offer."""
    if isinstance(value, dict):
        inside = {key: (item, slot.child(key)) for key, item in value.items()}
        return {
            key: _known(item, child)
            for key, (item, child) in inside.items()
            if child is not None and not _is_foreign(item, child)
        }
    if isinstance(value, list) and (item_slot := slot.child(0)) is not None:
        return [_known(item, item_slot) for item in value if not _is_foreign(item, item_slot)]
    return value


def _is_foreign(value: Any, slot: Slot) -> bool:
    """True for an unknown name, a list with one, or a mapping whose required choice is unknown."""
    if isinstance(value, list) and (item_slot := slot.child(0)) is not None and literal_names(item_slot):
        return any(_is_foreign(item, item_slot) for item in value)
    if isinstance(value, dict):
        declared = [field for model in slot.models for field in model.model_fields.items()]
        needed = [key for key, info in declared if info.is_required() and key in value]
        return any(_is_foreign(value[key], child) for key in needed if (child := slot.child(key)) is not None)
    names = literal_names(slot)
    return isinstance(value, str) and bool(names) and value not in names and str not in slot.options
