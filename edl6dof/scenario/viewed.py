"""The scenario of a result, read to be shown: no plugin is loaded for it.

What only a plugin brings (its section, and the choice of its law or controller) is left out; vehicle, planet,
ground, phases and the controllers of the package are what pictures and exports need.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.document.source import parse_document
from edl6dof.config.introspect import Slot, literal_names, root_slot
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario

#: Models of the air and wind in the place of those that only a plugin has: they need no table.
_STAND_INS = {"atmosphere": "us76", "wind": "none"}


def viewed_scenario(text: str, file: str) -> LoadedScenario:
    """Read the scenario of a resolved file, as far as the package itself knows it.

    Args:
        text: its content.
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
    """Return plain data without the keys that the models do not declare, and the names that no choice has."""
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
    """Return whether a value is a name that is none of the choices, a list of names with such a one, or a
    mapping that has to choose and cannot.
    """
    if isinstance(value, list) and (item_slot := slot.child(0)) is not None and literal_names(item_slot):
        return any(_is_foreign(item, item_slot) for item in value)
    if isinstance(value, dict):
        return any(
            info.is_required() and key in value and _is_foreign(value[key], child)
            for model in slot.models
            for key, info in model.model_fields.items()
            if (child := slot.child(key)) is not None
        )
    names = literal_names(slot)
    return isinstance(value, str) and bool(names) and value not in names and str not in slot.options
