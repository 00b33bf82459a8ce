"""The records one flight is made of, built from a validated scenario.

``CASE`` is the truth, ``TABLES`` the large arrays all cases share, ``ONBOARD`` the belief.  Truth and belief
are filled from the same nominal configuration and never touch again.
"""

from __future__ import annotations

from collections.abc import Callable, Set
from functools import cache
from math import atan2, cos, radians, sin
from typing import NamedTuple

import numpy as np

from edl6dof.config.dtype import dtype_of, duplicate, fill, refill
from edl6dof.environment.atmosphere import ATMOSPHERE, fill_atmosphere, fill_atmosphere_table
from edl6dof.environment.atmosphere_table import ATMOSPHERE_TABLE
from edl6dof.environment.planet import PLANET, fill_planet
from edl6dof.environment.terrain import TERRAIN, TERRAIN_GRID, fill_terrain, fill_terrain_grid
from edl6dof.environment.wind import WIND, fill_wind
from edl6dof.fsw.diagnosis.probe import NOBODY
from edl6dof.fsw.onboard import FSW
from edl6dof.scenario.belief import build_onboard
from edl6dof.scenario.initial import InitialState
from edl6dof.scenario.schema import LimitParams, LoadedScenario, Scenario, SimulationParams
from edl6dof.scenario.site import fill_site
from edl6dof.sensors.perfect import SENSORS, SensorParams
from edl6dof.spatial.frames import (
    LOCAL_FRAME,
    attitude_from_wind_angles,
    from_geodetic,
    ned_attitude,
    ned_to_fixed,
)
from edl6dof.spatial.quaternion import from_euler_321, multiply
from edl6dof.vehicle.aerotable import AERO_TABLE, build_aero_table
from edl6dof.vehicle.faults import FAULTS, fill_faults
from edl6dof.vehicle.mass import BODY, fill_lander
from edl6dof.vehicle.plant import ATTITUDE, NOT_BEGUN, PEAKS, POSITION, PROPELLANT, RATE, STATE, VELOCITY
from edl6dof.vehicle.point_mass import DYNAMICS, PointMassParams
from edl6dof.vehicle.vehicle import VehicleParams

CASE = np.dtype(
    [
        ("planet", PLANET),
        ("atmosphere", ATMOSPHERE),
        ("wind", WIND),
        ("terrain", TERRAIN),
        ("site", LOCAL_FRAME),
        ("vehicle", dtype_of(VehicleParams)),
        ("lander", BODY),
        ("dynamics", "i8"),
        ("ends_at_deployment", "i8"),
        ("point_mass", dtype_of(PointMassParams)),
        ("initial", dtype_of(InitialState)),
        ("simulation", dtype_of(SimulationParams)),
        ("limits", dtype_of(LimitParams)),
        ("sensors", dtype_of(SensorParams)),
        ("faults", FAULTS),
    ],
    align=True,
)
TABLES = np.dtype(
    [("atmosphere", ATMOSPHERE_TABLE), ("aero", AERO_TABLE), ("terrain", TERRAIN_GRID)], align=True
)


#: Parameters that the tables do not depend on: they are applied in flight.
FLOWN = {
    "atmosphere": frozenset(["density_factor", "exponential"]),
    "capsule": frozenset(["axial_factor", "normal_factor", "moment_factor", "moment_bias", "damping_factor"]),
    "gas": frozenset(
        ["heat_capacity_ratio", "molecular_diameter_m", "molecular_mass_kg", "sutton_graves_constant"]
    ),
}


def same_tables(first: Scenario, second: Scenario) -> bool:
    """Whether two scenarios share their tables."""
    sections = (
        ("atmosphere", first.atmosphere, second.atmosphere),
        ("capsule", first.vehicle.aero.capsule, second.vehicle.aero.capsule),
        ("gas", first.planet.gas, second.planet.gas),
    )
    return (
        first.terrain.model == second.terrain.model
        and first.vehicle.aero.model == second.vehicle.aero.model
        and all(
            getattr(one, field) == getattr(other, field)
            for name, one, other in sections
            if one is not other
            for field in type(one).model_fields
            if field not in FLOWN[name]
        )
    )


def build_tables(scenario: Scenario) -> np.ndarray:
    """The shared tables, shape (1,)."""
    tables = np.zeros(1, TABLES)
    fill_atmosphere_table(tables[0]["atmosphere"], scenario.atmosphere, scenario.planet)
    if scenario.terrain.model == "mola":
        fill_terrain_grid(tables[0]["terrain"])
    if scenario.vehicle.aero.model == "capsule":
        tables[0]["aero"] = build_aero_table(
            scenario.vehicle.aero.capsule, scenario.planet.gas.shock_layer_heat_capacity_ratio
        )[0]
    return tables


class Part(NamedTuple):
    """One part of the case record: the sections of the scenario that it follows from, and what fills it in a
    zeroed record.
    """

    sections: frozenset[str]
    fill: Callable[[np.void, Scenario, np.void], None]


#: Field of the case record to what fills it.
PARTS: dict[str, Part] = {}


def _part(name: str, sections: str) -> Callable[[Callable[[np.void, Scenario, np.void], None]], None]:
    """Declare what fills the part ``name`` of the case record."""

    def declare(fill_part: Callable[[np.void, Scenario, np.void], None]) -> None:
        PARTS[name] = Part(frozenset(sections.split()), fill_part)

    return declare


#: Parts that are the sections of the same names and nothing more.
COPIED = ("vehicle", "point_mass", "initial", "simulation", "sensors")
for _name in COPIED:
    _part(_name, _name)(lambda case, s, _, name=_name: fill(case[name], getattr(s, name)))


@_part("planet", "planet")
def _planet(case: np.void, s: Scenario, _: np.void) -> None:
    fill_planet(case["planet"], s.planet)


@_part("atmosphere", "atmosphere seed profile")
def _atmosphere(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_atmosphere(case["atmosphere"], s.atmosphere, tables["atmosphere"], s.seed, s.profile)


@_part("wind", "wind atmosphere seed profile")
def _wind(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_wind(case["wind"], s.wind, tables["atmosphere"], s.seed, s.profile)


@_part("terrain", "terrain planet")
def _terrain(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_terrain(case["terrain"], s.terrain, tables["terrain"], s.planet.mean_radius_m)


@_part("site", "terrain planet")
def _site(case: np.void, s: Scenario, _: np.void) -> None:
    fill_site(case["site"], s)


@_part("lander", "vehicle")
def _lander(case: np.void, s: Scenario, _: np.void) -> None:
    fill_lander(case["lander"], s.vehicle.mass)


@_part("dynamics", "dynamics")
def _dynamics(case: np.void, s: Scenario, _: np.void) -> None:
    case["dynamics"] = DYNAMICS.index(s.dynamics)


@_part("ends_at_deployment", "mission")
def _ends_at_deployment(case: np.void, s: Scenario, _: np.void) -> None:
    case["ends_at_deployment"] = s.mission.goal == "deployment"


@_part("limits", "limits mission")
def _limits(case: np.void, s: Scenario, _: np.void) -> None:
    fill(case["limits"], s.limits)
    if s.mission.goal == "time":
        case["limits"]["skip_out"] = np.inf  # a flight that need not land may climb


@_part("faults", "faults vehicle mission")
def _faults(case: np.void, s: Scenario, _: np.void) -> None:
    fill_faults(case["faults"], s.faults, s.thruster_names, s.phase_names)


def build_case(scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """The truth of one flight, shape (1,)."""
    case = np.zeros(1, CASE)
    for part in PARTS.values():
        part.fill(case[0], scenario, tables[0])
    return case


def changed_case(
    case: np.ndarray, scenario: Scenario, before: Scenario, tables: np.ndarray, sections: Set[str]
) -> np.ndarray:
    """The truth of a scenario that differs in some sections only from the one ``before``, whose record is
    ``case``.

    Equal to ``build_case``, and quicker.
    """
    case = duplicate(case)
    for name, part in PARTS.items():
        if part.sections.isdisjoint(sections):
            continue
        if name in COPIED:
            refill(case[0][name], getattr(scenario, name), getattr(before, name))
        else:
            case[name] = np.zeros(1, CASE[name])
            part.fill(case[0], scenario, tables[0])
    return case


class Records(NamedTuple):
    """What one flight reads, each shape (1,): the truth, the large tables it shares with others, the
    belief.
    """

    case: np.ndarray
    tables: np.ndarray
    onboard: np.ndarray


def build_records(loaded: LoadedScenario) -> Records:
    """Truth, tables and belief of a scenario."""
    tables = build_tables(loaded.truth)
    believed = tables if loaded.truth is loaded.scenario else build_tables(loaded.scenario)
    return Records(build_case(loaded.truth, tables), tables, build_onboard(loaded.scenario, believed))


def initial_plant(scenario: Scenario, case: np.ndarray) -> np.ndarray:
    """The state of the plant at t = 0, shape (1,)."""
    plant = duplicate(_new_plant())
    record = plant[0]
    initial, planet = scenario.initial, scenario.planet
    lat, lon = radians(initial.latitude_deg), radians(initial.longitude_deg)
    r = np.array(from_geodetic(planet.equatorial_radius_m, planet.flattening, lat, lon, initial.altitude_m))
    vertical = lat if initial.vertical == "geodetic" else atan2(r[2], np.hypot(r[0], r[1]))
    axes = (sin(vertical), cos(vertical), sin(lon), cos(lon))
    v_relative = np.array(ned_to_fixed(*axes, initial.velocity_ned))
    spin = planet.rotation_rate_rad_s
    y = record["y"]
    y[POSITION : POSITION + 3] = r
    y[VELOCITY : VELOCITY + 3] = v_relative + np.array([-spin * r[1], spin * r[0], 0.0])
    y[ATTITUDE : ATTITUDE + 4] = _initial_attitude(initial, lat, lon, axes, tuple(v_relative))
    y[RATE : RATE + 3] = np.radians(initial.rate_deg_s)
    record["bank"] = record["bank_command"] = initial.wind_angles[0]
    record["alpha"] = initial.wind_angles[1]
    y[PROPELLANT] = scenario.vehicle.mass.propellant.mass_kg
    return plant


@cache
def _new_plant() -> np.ndarray:
    """What every plant begins with: nothing has left it, and nothing has happened."""
    plant = np.zeros(1, STATE)
    record = plant[0]
    record["attached"][:] = 1
    record["due"][:] = 1e99
    record["done"][:] = np.nan
    record["wing_start"] = 1e99
    record["phase_seen"][:] = record["fault_since"][:] = NOT_BEGUN
    record["line_stretch_time"] = 1e99
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


def initial_fsw(onboard: np.ndarray) -> np.ndarray:
    """Flight-software memory at t = 0, shape (1,)."""
    fsw = duplicate(_new_fsw())
    fsw["mass"] = onboard["vehicle"]["entry_mass"]
    return fsw


@cache
def _new_fsw() -> np.ndarray:
    """What every flight computer begins with."""
    fsw = np.zeros(1, FSW)
    fsw["healthy"] = 1
    fsw["diagnosis"]["probe"]["suspect"] = NOBODY
    fsw["entered"] = np.nan
    fsw["entered"][0, 0] = 0.0
    return fsw


def initial_peaks() -> np.ndarray:
    """The largest loads met so far at t = 0, shape (1,)."""
    return np.zeros(1, PEAKS)


def initial_sensors() -> np.ndarray:
    """The sensors at t = 0, shape (1,)."""
    return np.zeros(1, SENSORS)
