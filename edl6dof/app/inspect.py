"""``edl6dof check`` and ``schema``."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from typing import Any

from edl6dof.app.exit_status import BAD_INPUT
from edl6dof.config.document.locate import shown
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.errors import ConfigError, refusal
from edl6dof.config.json_schema import json_schema
from edl6dof.scenario.loading import CALIBRATION, CAMPAIGN_SECTIONS, load_document
from edl6dof.scenario.schema import Scenario


def run_check(files: Sequence[str], sets: Sequence[str]) -> int:
    """Validate each file; every problem of every file is printed."""
    bad = False
    for name in files:
        try:
            document = read_document(resolve_scenario(name))
            if any(document.data.get(section) is not None for section in CAMPAIGN_SECTIONS):
                from edl6dof.campaign.design.plan import plan_of

                loaded = plan_of(document, tuple(sets)).loaded
            elif document.data.get(CALIBRATION) is not None:
                from edl6dof.calibration.problem import calibration_of

                loaded = calibration_of(document, tuple(sets)).loaded
            else:
                loaded = load_document(document, sets)
        except ConfigError as error:
            print(error, file=sys.stderr)
            bad = True
        else:
            for warning in loaded.warnings:
                print(f"warning: {warning}", file=sys.stderr)
            print(f"{name}: ok ({', '.join(shown(file) for file in loaded.document.files)})")
    return BAD_INPUT if bad else 0


def run_schema(of: str) -> int:
    """Print the JSON schema of a kind of files."""
    if of not in SCHEMAS:
        raise refusal("--of", f"must be one of {', '.join(SCHEMAS)} (got {of!r})")
    print(json.dumps(SCHEMAS[of](), indent=1))
    return 0


def vehicle_schema() -> dict[str, Any]:
    """Schema of vehicle files."""
    from edl6dof.vehicle.vehicle import VehicleParams

    return json_schema(VehicleParams, {})


def planet_schema() -> dict[str, Any]:
    """Schema of planet files."""
    from edl6dof.environment.planet import PlanetParams

    return json_schema(PlanetParams, {})


def scenario_schema() -> dict[str, Any]:
    """Schema of scenario files, of those that extend another one, and of their campaign, sweep and
    calibration sections.
    """
    from edl6dof.calibration.section import CalibrationFile
    from edl6dof.campaign.design.sections import CampaignFile
    from edl6dof.config.document.extends import EXTENDS

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
    "vehicle": vehicle_schema,
    "planet": planet_schema,
}
