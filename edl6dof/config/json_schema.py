"""JSON schemas of parameter files for editors (VS Code reads draft 7)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from edl6dof.config.document.source import INCLUDES
from edl6dof.config.document.yamltree import BOOLEAN_WORDS
from edl6dof.config.units import split_unit

DRAFT = "http://json-schema.org/draft-07/schema#"


def json_schema(model: type[BaseModel], includes: Mapping[str, str] = INCLUDES) -> dict[str, Any]:
    """Return the schema of a scenario file; the include keys also accept the name of a file."""
    schema = _draft7(model.model_json_schema())
    for key, kind in includes.items():
        if (own := schema.get("properties", {}).get(key)) is not None:
            by_name = {"type": "string", "description": f"name or path of a file of {kind}"}
            schema["properties"][key] = {"description": own.get("description", ""), "anyOf": [by_name, own]}
    definitions = schema.get("$defs", {})
    for part in (schema, *definitions.values()):
        for name, field in part.get("properties", {}).items():
            if item := _named_item(field, definitions):
                definitions[item]["required"] = ["name"]
                part["properties"][name] = {
                    "description": field.get("description", ""),
                    "anyOf": [field, _BY_NAME],
                }
    return {"$schema": DRAFT, "title": schema.pop("title", model.__name__), **schema}


#: A file that extends another may change the items of a list by their names and give only the changes;
#: ``edl6dof check`` reports what a whole item lacks.
_BY_NAME = {"type": "object", "description": "changes to items of what this file extends, by their names"}


def _named_item(field: Mapping[str, Any], definitions: Mapping[str, Any]) -> str:
    """Return the definition of the items of a property that is a list of named items; else empty."""
    items = field.get("items")
    item = items.get("$ref", "").rsplit("/", 1)[-1] if isinstance(items, dict) else ""
    return item if "name" in definitions.get(item, {}).get("properties", {}) else ""


def _draft7(node: Any) -> Any:
    if isinstance(node, list):
        return [_draft7(item) for item in node]
    if not isinstance(node, dict):
        return node
    changed = {key: _draft7(value) for key, value in node.items()}
    if isinstance(changed.get("prefixItems"), list):
        changed["items"] = changed.pop("prefixItems")
        changed["additionalItems"] = False
    words = changed.get("enum", ())
    # editors that read YAML 1.1 take some words for truth values: ``off`` for false
    truths = [BOOLEAN_WORDS[one] for one in words if one in BOOLEAN_WORDS] if isinstance(words, list) else []
    if truths:
        changed["enum"] = [*words, *dict.fromkeys(truths)]
        changed.pop("type", None)
    if isinstance(changed.get("properties"), dict):
        changed["properties"] = {name: _described(name, item) for name, item in changed["properties"].items()}
    return changed


#: Keywords of a declaration that are no keywords of a schema.
_OWN_WORDS = ("record", "status", "source", "printed")


def _described(name: str, field: dict[str, Any]) -> dict[str, Any]:
    """Return a property without keywords of this program, with unit, status and source described."""
    plain = {key: value for key, value in field.items() if key not in _OWN_WORDS}
    unit = split_unit(name)[1].label
    claim = ", ".join(part for part in (field.get("status"), field.get("source")) if part)
    words = [field.get("description", ""), f"[{unit}]" if unit else "", f"({claim})" if claim else ""]
    description = " ".join(word for word in words if word)
    return {**plain, "description": description} if description else plain
