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
from edl6dof.config.validate import refuse, validate
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
    require(document)
    try_out()
    scenario = _checked(document)
    wrong = {path: words for path in scenario.truth if (words := truth_problem(path))}
    if wrong:
        raise ConfigError(document.problem(("truth", path), words) for path, words in wrong.items())
    if not scenario.truth:
        return LoadedScenario(scenario, scenario, document)
    true = with_values(document, scenario.truth, Scenario, lambda path: document.mark(("truth", path)))
    return LoadedScenario(scenario, _checked(true), document)


def _checked(document: Document) -> Scenario:
    """The scenario of a document: its values, how they fit together, and its tables."""
    scenario = validate(Scenario, document)
    refuse(document, {**section_problems(scenario), **file_problems(scenario)})
    return scenario


#: Sections of a scenario file for many flights and for calibration, which a single flight does not read.
CAMPAIGN_SECTIONS = ("campaign", "sweep", "fault_matrix")
CALIBRATION = "calibration"


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
    overrides = list(overrides)
    late = [text for text in overrides if text.partition("=")[0].strip().partition(".")[0] == "plugins"]
    if late:
        raise ConfigError(
            Problem(f"--set {text}", 0, 0, "plugins", "must be named in the scenario file") for text in late
        )
    for name in (*CAMPAIGN_SECTIONS, CALIBRATION):
        document.data.pop(name, None)
        document.forget((name,))
    document = with_whole_paths(expand_daveml(document))
    try:
        changed = apply_overrides(document, overrides, Scenario)
    except ConfigError as error:
        refused = {problem.file for problem in error.problems}
        kept = [text for text in overrides if f"--set {text}" not in refused]
        raise ConfigError((*error.problems, *_problems(document, kept))) from None
    return check_document(with_whole_paths(expand_daveml(changed)))


def _problems(document: Document, overrides: Iterable[str]) -> tuple[Problem, ...]:
    try:
        check_document(with_whole_paths(expand_daveml(apply_overrides(document, overrides, Scenario))))
    except ConfigError as error:
        return error.problems
    return ()


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
