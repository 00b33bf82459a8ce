"""The records of one flight, built from a validated scenario.

``CASE`` is the truth, ``TABLES`` the large arrays that all cases share, ``ONBOARD`` the belief.  Truth and
belief are filled from the same nominal configuration and are independent from then on.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from edl6dof.config.dtype import duplicate
from edl6dof.environment.areoid import areoid_file, areoid_map, lay_areoid
from edl6dof.environment.atmosphere import air_inputs
from edl6dof.environment.atmosphere_table import ATMOSPHERE_TABLE, AirInputs, build_table
from edl6dof.environment.height_map import HEIGHT_MAP, MapFile
from edl6dof.environment.terrain import GROUND, GroundInputs, ground_arrays, ground_inputs
from edl6dof.fsw.diagnosis.flow_evidence import NONE
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH
from edl6dof.fsw.onboard import FSW
from edl6dof.records import record
from edl6dof.scenario.initial import InitialState
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.onboard import believe
from edl6dof.scenario.schema import Scenario, start_of, vertical_axes
from edl6dof.scenario.truth import build_case
from edl6dof.sensors.registry import SENSORS
from edl6dof.spatial.elementary import cos, sin
from edl6dof.spatial.frames import attitude_from_wind_angles, ned_attitude, ned_to_fixed
from edl6dof.spatial.quaternion import from_euler_321, multiply
from edl6dof.vehicle.aerodynamics.body import BODY_TABLE
from edl6dof.vehicle.aerodynamics.body_table import BodyInputs, body_inputs, build_body_table
from edl6dof.vehicle.aerodynamics.capsule_table import AERO_TABLE, AeroInputs, aero_inputs, build_aero_table
from edl6dof.vehicle.plant import ATTITUDE, NOT_BEGUN, PEAKS, POSITION, PROPELLANT, RATE, STATE, VELOCITY

TABLES = record(
    ("atmosphere", ATMOSPHERE_TABLE),
    ("aero", AERO_TABLE),
    ("body", BODY_TABLE),
    ("terrain", GROUND),
    ("areoid", HEIGHT_MAP),  # of the areoid above the ellipsoid
)


class TableInputs(NamedTuple):
    """Inputs of the tables of a scenario; ``aero`` for a capsule only, ``body`` for any other shape."""

    air: AirInputs
    aero: AeroInputs | None
    body: BodyInputs | None
    ground: GroundInputs
    areoid: MapFile | None


def table_inputs(scenario: Scenario) -> TableInputs:
    """Inputs of the tables, with the present content of the files.

    Raises:
        ValueError: a file is not named or is no table.
        OSError: a file cannot be read.
    """
    aero, ratio = scenario.vehicle.aero, scenario.planet.gas.shock_layer_heat_capacity_ratio
    sheds = scenario.vehicle.showing("capsule") is not None
    return TableInputs(
        air_inputs(scenario.atmosphere, scenario.planet, scenario.place),
        aero_inputs(aero.capsule, ratio) if aero.model == "capsule" else None,
        body_inputs(aero.body, ratio, sheds) if aero.model == "body" else None,
        ground_inputs(scenario.terrain, scenario.planet),
        areoid_file(scenario.planet),
    )


def build_tables(scenario: Scenario) -> np.ndarray:
    """The tables, shape (1,); scenarios of the same inputs share them, and they are read-only.

    Raises:
        ValueError, OSError: as :func:`table_inputs`.
    """
    return _tables(table_inputs(scenario))


@lru_cache(maxsize=4)
def _tables(inputs: TableInputs) -> np.ndarray:
    tables = np.zeros(1, TABLES)
    tables["atmosphere"] = build_table(inputs.air)
    tables["terrain"] = ground_arrays(inputs.ground)
    tables["areoid"] = areoid_map(inputs.areoid)
    if inputs.aero is not None:
        tables["aero"] = build_aero_table(inputs.aero)
    if inputs.body is not None:
        tables["body"] = build_body_table(inputs.body)
    return tables


#: Sections of a scenario that the belief of the flight computer depends on.
BELIEVED = frozenset(
    ("planet", "atmosphere", "terrain", "vehicle", "initial", "dynamics")
    + ("sensors", "flight_software", "mission")
)


def build_onboard(scenario: Scenario) -> np.ndarray:
    """Build the belief of the flight computer, shape (1,); scenarios with the same belief share the plan.

    Raises:
        ValueError, OSError: as :func:`table_inputs`.
    """
    believed = scenario.model_copy(update=dict.fromkeys(Scenario.model_fields.keys() - BELIEVED))
    return duplicate(_onboard(believed, table_inputs(scenario)))


@lru_cache(maxsize=4)
def _onboard(believed: Scenario, inputs: TableInputs) -> np.ndarray:
    return believe(believed, _tables(inputs))


class Records(NamedTuple):
    """Records that one flight reads, each shape (1,): truth, large tables that flights share, belief."""

    case: np.ndarray
    tables: np.ndarray
    onboard: np.ndarray


def build_records(loaded: LoadedScenario) -> Records:
    """Build truth, tables and belief of a scenario; scenarios of the same inputs share the tables.

    Raises:
        ValueError, OSError: as :func:`table_inputs`.
    """
    tables = build_tables(loaded.truth)
    return Records(build_case(loaded.truth, tables), tables, build_onboard(loaded.scenario))


def initial_plant(scenario: Scenario, case: np.ndarray) -> np.ndarray:
    """The state of the plant at t = 0, shape (1,)."""
    plant = duplicate(_new_plant())
    record = plant[0]
    initial, planet, (lat, lon) = scenario.initial, scenario.planet, scenario.initial.place
    axes, start = vertical_axes(scenario), np.array(start_of(scenario))
    r, v_relative = start[:3], start[3:]
    place = (sin(lat), cos(lat), sin(lon), cos(lon))
    lay_areoid(
        areoid_map(areoid_file(planet)), place, lat, lon, r_F=tuple(r), plane=record["inputs"]["areoid"]
    )
    spin = planet.rotation_rate_rad_s
    y = record["y"]
    y[POSITION : POSITION + 3] = r
    y[VELOCITY : VELOCITY + 3] = v_relative + np.array([-spin * r[1], spin * r[0], 0.0])
    y[ATTITUDE : ATTITUDE + 4] = _initial_attitude(initial, lat, lon, axes, tuple(v_relative))
    y[RATE : RATE + 3] = np.radians(initial.rate_deg_s)
    record["bank"] = record["bank_command"] = initial.wind_angles[0]
    record["alpha"] = initial.wind_angles[1]
    loads = [tank.mass_kg for tank in scenario.vehicle.tanks]
    y[PROPELLANT : PROPELLANT + len(loads)] = loads
    return plant


@cache
def _new_plant() -> np.ndarray:
    """State of every plant at t = 0: all parts attached, no event past."""
    plant = np.zeros(1, STATE)
    record = plant[0]
    record["attached"][:] = 1
    record["due"][:] = 1e99
    record["done"][:] = np.nan
    record["wing_start"] = 1e99
    record["phase_seen"][:] = record["fault_since"][:] = NOT_BEGUN
    record["line_stretch_time"] = np.nan
    record["touchdown_time"] = record["exhausted_time"] = np.nan
    return plant


def _initial_attitude(initial: InitialState, lat: float, lon: float, axes: tuple, v_relative: tuple) -> tuple:
    """``q_I2B`` at t = 0, when I and F coincide."""
    if initial.yaw_pitch_roll_deg is not None:
        q_F2N = ned_attitude(sin(lat), cos(lat), sin(lon), cos(lon))
        return multiply(q_F2N, from_euler_321(*np.radians(initial.yaw_pitch_roll_deg)))
    # the attitude of a vehicle at rest is given relative to a velocity along the azimuth
    level = (cos(initial.azimuth), sin(initial.azimuth), 0.0)
    along = v_relative if initial.speed > 0.0 else ned_to_fixed(*axes, level)
    up = ned_to_fixed(*axes, (0.0, 0.0, -1.0))
    return attitude_from_wind_angles(along, up, *initial.wind_angles)


def initial_fsw(onboard: np.ndarray, layout: np.dtype = FSW) -> np.ndarray:
    """Flight-software memory at t = 0, shape (1,)."""
    fsw = duplicate(_new_fsw(layout))
    fsw["vehicle"]["mass"] = onboard["vehicle"]["entry_mass"]
    return fsw


@cache
def _new_fsw(layout: np.dtype) -> np.ndarray:
    """Memory of every flight computer at t = 0."""
    fsw = np.zeros(1, layout)
    fsw["health"]["thruster"] = 1
    for name in INSTRUMENT_HEALTH.names or ():
        fsw["navigation"]["health"][name] = 1
    fsw["diagnosis"]["leak"]["branch"] = fsw["diagnosis"]["hypotheses"]["meter"] = NONE
    for name in ("site_t", "image_t", "scan_t", "spot_t"):
        fsw["hazard"][name] = np.nan
    fsw["mission"]["entered"] = np.nan
    fsw["mission"]["entered"][0, 0] = 0.0
    return fsw


def initial_peaks() -> np.ndarray:
    """The largest loads at t = 0, shape (1,)."""
    return np.zeros(1, PEAKS)


def initial_sensors(layout: np.dtype = SENSORS) -> np.ndarray:
    """The sensors at t = 0, shape (1,)."""
    return np.zeros(1, layout)
