"""The sensors that a scenario may name in ``sensors.carried``; each writes its own part of the sensed record.

A member's kernel ``measure(params, unit, case, tables, plant, outputs, memory, sensed)`` runs in every base
cycle.  ``params``, ``unit`` and ``memory`` are its own: ``unit`` has the errors of the sensor in this case,
drawn by the member's ``plan(params, rng, unit)`` from the generator that belongs to sensor and case.  Noise
in flight comes from :mod:`edl6dof.spatial.random_numbers`, with a key that ``plan`` draws.  A sensor that is
named after another one may overwrite its measurements: a list ``[perfect, imu, star_tracker]`` takes the
attitude from the star tracker and the rest from the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from edl6dof.config.base import Capacity, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.profiles import SENSOR_STREAM
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Family
from edl6dof.sensors import (
    flow_meters,
    ground_tracking,
    imu,
    inertial_unit,
    landing_camera,
    landmark_camera,
    lidar,
    navigation_error,
    perfect,
    pressure_ports,
    radar,
    star_tracker,
    stereo,
    switches,
)
from edl6dof.spatial.random_numbers import Stream
from edl6dof.vehicle.faults.component import Component

SENSOR_FAMILY = Family(
    "sensor",
    (
        *(perfect.MEMBER, imu.MEMBER, inertial_unit.MEMBER, star_tracker.MEMBER, ground_tracking.MEMBER),
        *(switches.MEMBER, radar.MEMBER, pressure_ports.MEMBER, flow_meters.MEMBER, navigation_error.MEMBER),
        *(landing_camera.MEMBER, lidar.MEMBER, stereo.MEMBER, landmark_camera.MEMBER),
    ),
)

#: Sensors that a vehicle may carry.
MAX_SENSORS = 12
#: Sensors that make images: they have no ideal counterpart.
IMAGERS: tuple[Component, ...] = ("landing_camera", "lidar", "stereo")
#: Sensors of the set ``perfect``, and those of ``carried`` that it keeps.
PERFECT_SET, ON_TOP = ("perfect", "imu"), ("navigation_error", *IMAGERS)

if TYPE_CHECKING:
    SensorName = str
else:  # which sensors there are, plugins included, is known only when it runs
    SensorName = Literal[SENSOR_FAMILY.names]

_Sections: Any = SENSOR_FAMILY.params_model("SensorSections", None, "", "Parameters of the sensors.")


class SensorParams(_Sections):
    """Sensors of the flight computer."""

    set: Literal["carried", "perfect"] = param(
        "carried",
        "carried: the sensors named below; perfect: ideal ones, as for every point mass, and of the sensors "
        "named only navigation_error, landing_camera, lidar and stereo",
        record=False,
    )
    carried: Annotated[list[SensorName], Capacity(MAX_SENSORS)] = param(
        None,
        "sensors that fly; a later one overwrites the measurements of an earlier one",
        factory=lambda: list(PERFECT_SET),
        min_length=1,
        max_length=MAX_SENSORS,
    )

    @property
    def flown(self) -> list[str]:
        """Names of the sensors that fly."""
        if self.set == "carried":
            return self.carried
        return [*PERFECT_SET, *(name for name in self.carried if name in ON_TOP)]


#: The sensors of a case: their parameters and their errors.
SENSOR_UNITS = record(("params", dtype_of(SensorParams)), ("unit", SENSOR_FAMILY.tables))

#: Record that crosses to the flight software, and the memories of the sensors.
SENSORS = record(("sensed", SENSED), *((member.name, member.memory) for member in SENSOR_FAMILY.members))

measure = SENSOR_FAMILY.role(
    "measure",
    *("params", "unit", "case", "tables", "plant", "outputs", "memory", "sensed"),
    own=("params", "unit", "memory"),
)


def fill_sensor_params(record: np.void, params: SensorParams) -> None:
    """Write checked parameters into a ``SENSOR_UNITS`` record of zeros."""
    fill(record["params"], params)
    flown = _flown(params)
    record["params"]["n_carried"] = len(flown)
    record["params"]["carried"] = 0
    record["params"]["carried"][: len(flown)] = flown


def draw_sensor_units(record: np.void, params: SensorParams, seed: int, case: int) -> None:
    """Draw the errors of the sensors that fly, which belong to (seed, case), into an empty record."""
    for index in _flown(params):
        member = SENSOR_FAMILY.members[index]
        if member.plan is not None:
            rng = Stream(seed, case, SENSOR_STREAM + index)
            member.plan(getattr(params, member.name), rng, record["unit"][member.name])


def _flown(params: SensorParams) -> list[int]:
    return [SENSOR_FAMILY.names.index(name) for name in params.flown]


@kernel
def sense(measure, case, tables, plant, outputs, sensors):
    """Write the measurements of the carried sensors into ``sensors.sensed``."""
    params, unit, sensed = case.sensors.params, case.sensors.unit, sensors.sensed
    sensed.t = plant.t
    for k in range(params.n_carried):
        measure(
            params.carried[k], params, unit, case, tables, plant=plant, outputs=outputs, memory=sensors,
            sensed=sensed,
        )  # fmt: skip


def sensor_problems(params: SensorParams, needed: tuple[str, ...]) -> dict[str, str]:
    """Problems of a choice of sensors by dotted path; ``needed``: fields of the sensed record that the flight
    software cannot do without.
    """
    twice = sorted({name for name in params.carried if params.carried.count(name) > 1})
    written = {field for name in params.flown for field in SENSOR_FAMILY.member(name).writes}
    missing = [field for field in needed if field not in written]
    if twice:
        return {"sensors.carried": f"names {', '.join(twice)} twice"}
    if missing:
        able = [member.name for member in SENSOR_FAMILY.members if set(missing) & set(member.writes)]
        return {"sensors.carried": f"measures no {', '.join(missing)}: carry {' or '.join(able)} too"}
    return {}


def instrument_names(params: SensorParams, branches: Sequence[str]) -> dict[Component, list[str]]:
    """Names of the instruments that fly and may fail, by kind; flow meters are named as ``branches``."""
    names: dict[Component, list[str]] = {}
    if "inertial_unit" in params.flown:
        unit = params.inertial_unit
        names["gyro"] = [one.name for one in unit.gyros.axes]
        names["accelerometer"] = [one.name for one in unit.accelerometers.axes]
        names["inertial_unit"] = ["inertial_unit"]
    if "radar" in params.flown:
        names["beam"] = [one.name for one in params.radar.beams]
        names["radar"] = list(params.radar.radars)
    if "star_tracker" in params.flown:
        names["star_tracker"] = [one.name for one in params.star_tracker.heads]
    if "flow_meters" in params.flown:
        names["flow_meter"] = list(branches)
    names |= {name: [name] for name in (*IMAGERS, "landmark_camera") if name in params.flown}
    return names
