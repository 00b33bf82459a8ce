"""The vehicle file: all parameters of the true vehicle."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict

from edl6dof.config.base import REQUIRED, Hardware, Title, group, param, section
from edl6dof.vehicle.aerodynamics import AeroParams
from edl6dof.vehicle.engine import EngineParams
from edl6dof.vehicle.landing_gear import LandingGearParams
from edl6dof.vehicle.mass import MassParams
from edl6dof.vehicle.parachute import ParachuteParams
from edl6dof.vehicle.rcs import RcsParams
from edl6dof.vehicle.staging import StagingParams
from edl6dof.vehicle.trim_wing import TrimWingParams


def _or_daveml(schema: dict[str, Any]) -> None:
    """Editors: ``mass`` and ``aero`` may be left to the DAVE-ML files (the program reads those before it
    validates).
    """
    own = [name for name in schema["required"] if name not in ("mass", "aero")]
    schema["anyOf"] = [{"required": ["mass", "aero"]}, {"required": ["daveml"]}]
    schema["required"] = own


class VehicleParams(Hardware):
    """An entry vehicle and everything that leaves it."""

    model_config = ConfigDict(json_schema_extra=_or_daveml)

    name: Title = param(REQUIRED, "name of the vehicle", record=False)
    daveml: list[str] = param(
        None,
        "DAVE-ML files that give mass and aero; what the YAML states itself goes before them",
        record=False,
        factory=list,
    )
    nose_radius_m: float = param(
        0.85, "effective nose radius for heating", status="estimate", source="D/4", gt=0.0
    )
    mass: MassParams = section("mass properties")
    aero: AeroParams = section("aerodynamics")
    trim_wing: TrimWingParams = group(TrimWingParams, "trim wing")
    rcs: RcsParams = group(RcsParams, "reaction-control thrusters")
    engine: EngineParams = group(EngineParams, "main landing engine")
    parachute: ParachuteParams = group(ParachuteParams, "parachute")
    staging: StagingParams = group(StagingParams, "separations")
    landing_gear: LandingGearParams = group(LandingGearParams, "landing legs")
