"""JSON schemas of scenario, vehicle and planet files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel

from edl6dof.calibration.problem import CalibrationFile
from edl6dof.campaign.design.sections import CampaignFile
from edl6dof.config.document.document import EXTENDS
from edl6dof.config.json_schema import json_schema
from edl6dof.environment.planet import PlanetParams
from edl6dof.missions.flown import FlownFile
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.vehicle import VehicleParams

#: Sections of a scenario file that a single flight does not read.
OTHER_SECTIONS: tuple[type[BaseModel], ...] = (CampaignFile, CalibrationFile, FlownFile)


def scenario_schema() -> dict[str, Any]:
    """Describe scenario files, also those that extend another, with their campaign and other sections."""
    schema = json_schema(Scenario)
    words = "name or path of a scenario of which this file changes some values"
    schema["properties"][EXTENDS] = {"type": "string", "description": words}
    for section in map(json_schema, OTHER_SECTIONS):
        schema["properties"].update(section["properties"])
        schema["$defs"].update(section.get("$defs", {}))
    schema["anyOf"] = [{"required": schema.pop("required")}, {"required": [EXTENDS]}]
    _ask_for_nothing_in_sections(schema)
    return schema


def _ask_for_nothing_in_sections(schema: dict[str, Any]) -> None:
    """Require no keys in sections, because a file that extends another contains only its changes."""
    definitions, met, waiting = schema["$defs"], set[str](), [schema]
    while waiting:
        for field in waiting.pop().get("properties", {}).values():
            for option in (field, *field.get("anyOf", ())):
                name = option.get("$ref", "").rsplit("/", 1)[-1]
                if name in definitions and name not in met:
                    met.add(name)
                    for asks in ("required", "anyOf"):  # anyOf: one of several that are required
                        definitions[name].pop(asks, None)
                    waiting.append(definitions[name])


#: Schemas by what they are of.
SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {
    "scenario": scenario_schema,
    "vehicle": lambda: json_schema(VehicleParams, {}),
    "planet": lambda: json_schema(PlanetParams, {}),
}
