"""JSON schemas of scenario, vehicle and planet files."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from edl6dof.calibration.section import CalibrationFile
from edl6dof.campaign.design.sections import CampaignFile
from edl6dof.config.document.extends import EXTENDS
from edl6dof.config.json_schema import json_schema
from edl6dof.environment.planet import PlanetParams
from edl6dof.scenario.schema import Scenario
from edl6dof.vehicle.vehicle import VehicleParams


def scenario_schema() -> dict[str, Any]:
    """Describe scenario files, those that extend another one, and their campaign, sweep and
    calibration sections.
    """
    schema = json_schema(Scenario)
    schema["properties"][EXTENDS] = {
        "type": "string",
        "description": ("name or path of a scenario of which this file changes some values"),
    }
    for section in (json_schema(CampaignFile), json_schema(CalibrationFile)):
        schema["properties"].update(section["properties"])
        schema["$defs"].update(section["$defs"])
    schema["anyOf"] = [{"required": schema.pop("required")}, {"required": [EXTENDS]}]
    _ask_for_nothing_in_sections(schema)
    return schema


def _ask_for_nothing_in_sections(schema: dict[str, Any]) -> None:
    """A file that extends another has of a section only what it changes; what is missing for good, ``check``
    says.
    """
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
