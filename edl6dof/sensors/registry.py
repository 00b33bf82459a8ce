"""The sensors that a scenario may name in ``sensors.carried``; each writes its own part of the sensed record.

A sensor that is named after another one may write over what that one measured: a list ``[perfect, imu,
star_tracker]`` takes the attitude from the star tracker and the rest from the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from edl6dof.config.base import Capacity, param
from edl6dof.interface.sensed import SENSED
from edl6dof.jit import kernel
from edl6dof.registry import Family
from edl6dof.sensors import imu, perfect

SENSOR_FAMILY = Family("sensor", (perfect.MEMBER, imu.MEMBER))

#: Sensors that a vehicle may carry.
MAX_SENSORS = 8

if TYPE_CHECKING:
    SensorName = str
else:  # which sensors there are, plugins included, is known only when it runs
    SensorName = Literal[SENSOR_FAMILY.names]

_Sections: Any = SENSOR_FAMILY.params_model("SensorSections", None, "", "Parameters of the sensors.")


class SensorParams(_Sections):
    """What the flight computer measures with."""

    carried: Annotated[list[SensorName], Capacity(MAX_SENSORS)] = param(
        None,
        "sensors that fly; a later one writes over what an earlier one measured",
        factory=lambda: ["perfect", "imu"],
        min_length=1,
        max_length=MAX_SENSORS,
    )


#: What the sensors remember, and what crosses to the flight software.
SENSORS = np.dtype(
    [*((member.name, member.memory) for member in SENSOR_FAMILY.members), ("sensed", SENSED)], align=True
)

_measure = SENSOR_FAMILY.switch("measure", "params", "memory", "plant", "outputs", "sensed")


@kernel
def sense(params, plant, outputs, sensors):
    """Let the sensors that are carried write into ``sensors.sensed`` what they measure in the state ``plant``
    with its ``outputs``.
    """
    sensors.sensed.t = plant.t
    for k in range(params.n_carried):
        _measure(params.carried[k], params, sensors, plant, outputs, sensors.sensed)


def sensor_problems(params: SensorParams) -> dict[str, str]:
    """Dotted path to message of what is wrong with the choice of sensors."""
    twice = sorted({name for name in params.carried if params.carried.count(name) > 1})
    written = {field for name in params.carried for field in SENSOR_FAMILY.member(name).writes}
    missing = [field for field in SENSED.names or () if field not in written and field != "t"]
    if twice:
        return {"sensors.carried": f"names {', '.join(twice)} twice"}
    if missing:
        able = [member.name for member in SENSOR_FAMILY.members if set(missing) & set(member.writes)]
        return {"sensors.carried": f"measures no {', '.join(missing)}: carry {' or '.join(able)} too"}
    return {}
