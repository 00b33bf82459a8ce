"""The scenario of a result, read to be shown: no plugin is loaded for it.

What only a plugin brings (its section, and the choice of its law or controller) is left out; vehicle, planet,
ground, phases and the controllers of the package are what pictures and exports need.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import Params
from edl6dof.config.document.source import parse_document
from edl6dof.environment.atmosphere import AtmosphereParams
from edl6dof.environment.atmospheres.registry import ATMOSPHERES
from edl6dof.environment.wind import WindParams
from edl6dof.environment.winds.registry import WINDS
from edl6dof.fsw.control.registry import CONTROLLERS
from edl6dof.fsw.estimation.registry import ESTIMATORS, EstimationParams
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.guidance.entry.reversal.registry import REVERSALS
from edl6dof.fsw.guidance.entry.steering import ReversalParams
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.onboard import ControlParams, EntryGuidanceParams, PoweredGuidanceParams
from edl6dof.scenario.loading import LoadedScenario, check_document
from edl6dof.sensors.registry import SENSOR_FAMILY, SensorParams
from edl6dof.vehicle.parachutes.models.registry import PARACHUTE_MODELS
from edl6dof.vehicle.parachutes.parachute import ParachuteParams
from edl6dof.vehicle.propulsion.engine import EngineParams
from edl6dof.vehicle.propulsion.engine_models.registry import ENGINE_MODELS

_GUIDANCE = ("flight_software", "guidance")
#: Sections, or lists of them, that plugins may add to, and the keys there that choose a member of a family.
_PLACES: tuple[tuple[tuple[str, ...], type[Params], dict[str, tuple[str, ...]]], ...] = (
    (("atmosphere",), AtmosphereParams, {"model": ATMOSPHERES.names}),
    (("wind",), WindParams, {"model": WINDS.names}),
    (("sensors",), SensorParams, {}),
    (("vehicle", "engines"), EngineParams, {"model": ENGINE_MODELS.names}),
    (("vehicle", "parachutes"), ParachuteParams, {"model": PARACHUTE_MODELS.names}),
    ((*_GUIDANCE, "entry"), EntryGuidanceParams, {"law": ENTRY_LAWS.names}),
    ((*_GUIDANCE, "entry", "reversal"), ReversalParams, {"logic": REVERSALS.names}),
    ((*_GUIDANCE, "powered"), PoweredGuidanceParams, {"law": POWERED_LAWS.names}),
    (("flight_software", "control"), ControlParams, {}),
    (("flight_software", "estimation"), EstimationParams, {"estimator": ESTIMATORS.names}),
)
#: What stands for a model of the air or wind that only a plugin has: it needs no table.
_STAND_INS = {"atmosphere": "us76", "wind": "none"}


def viewed_scenario(text: str, file: str) -> LoadedScenario:
    """The scenario of a resolved file, as far as the package itself knows it.

    Args:
        text: its content.
        file: the name shown in messages.

    Raises:
        ConfigError: every problem, with line and key.
    """
    document = parse_document(text, file)
    if document.data.pop("plugins", None):
        _leave_out_plugins(document.data)
    return check_document(document)


def _leave_out_plugins(data: dict[str, Any]) -> None:
    """Take out of plain data what the package does not know; a phase with a controller of a plugin has
    none.
    """
    for path, model, choices in _PLACES:
        place = _section(data, path[:-1]).get(path[-1])
        sections = place if isinstance(place, list) else [place]
        for section in (one for one in sections if isinstance(one, dict)):
            for key in list(section):
                if key not in model.model_fields or section[key] not in choices.get(key, [section[key]]):
                    del section[key]
    for name, stand_in in _STAND_INS.items():
        _section(data, (name,)).setdefault("model", stand_in)
    sensors = _section(data, ("sensors",))
    if not set(sensors.get("carried", ())) <= set(SENSOR_FAMILY.names):
        del sensors["carried"]
    for phase in _section(data, ("mission",)).get("phases", ()):
        if phase["control"] not in CONTROLLERS.names:
            phase["control"] = "off"


def _section(data: dict[str, Any], path: tuple[str, ...]) -> dict[str, Any]:
    """A section of a resolved scenario, which has them all; an empty one stands for what is none, and
    validation says so.
    """
    section: Any = data
    for key in path:
        section = section.get(key) if isinstance(section, dict) else None
    return section if isinstance(section, dict) else {}
