"""The truth of one flight: its record, and which sections of a scenario fill which of its fields."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from edl6dof.config.dtype import dtype_of, duplicate, fill
from edl6dof.config.model_paths import changed_fields
from edl6dof.environment.atmosphere import ATMOSPHERE, fill_atmosphere
from edl6dof.environment.layout import extended
from edl6dof.environment.planet import PLANET, fill_planet
from edl6dof.environment.terrain import TERRAIN, fill_terrain
from edl6dof.environment.wind import WIND, fill_wind
from edl6dof.interface.capacities import MAX_EVENTS, MAX_PARACHUTES, MAX_SURFACES
from edl6dof.interface.events import EVENT_TABLE
from edl6dof.interface.thrusters import BRANCHES
from edl6dof.records import FLAG, offset
from edl6dof.scenario.events import event_number, fill_events
from edl6dof.scenario.initial import InitialState
from edl6dof.scenario.schema import LimitParams, Scenario, SimulationParams
from edl6dof.scenario.site import fill_site
from edl6dof.sensors.registry import SENSOR_UNITS, draw_sensor_units, fill_sensor_params
from edl6dof.spatial.frames import (
    LOCAL_FRAME,
)
from edl6dof.vehicle.faults.fault import FAULTS, fill_faults
from edl6dof.vehicle.mass import BODY, fill_lander
from edl6dof.vehicle.motion.point_mass import DYNAMICS, PointMassParams
from edl6dof.vehicle.parachutes.parachute import SUSPENSION
from edl6dof.vehicle.propulsion.branches import fill_branches
from edl6dof.vehicle.propulsion.tanks import FEEDS, fill_feeds
from edl6dof.vehicle.vehicle import VehicleParams, carriers, fill_suspension

CASE = np.dtype(
    [
        ("planet", PLANET),
        ("atmosphere", ATMOSPHERE),
        ("wind", WIND),
        ("terrain", TERRAIN),
        ("site", LOCAL_FRAME),
        ("vehicle", dtype_of(VehicleParams)),
        ("lander", BODY),
        ("feeds", FEEDS),
        ("branches", BRANCHES),
        ("suspension", SUSPENSION, (MAX_PARACHUTES,)),
        ("carrier", "i8", (MAX_SURFACES,)),  # part that each surface goes with; -1: it stays
        ("events", EVENT_TABLE),
        ("dynamics", "i8"),
        ("ends_with", FLAG, (MAX_EVENTS,)),  # events with which the flight ends
        ("point_mass", dtype_of(PointMassParams)),
        ("initial", extended(InitialState, altitude="f8")),
        ("simulation", dtype_of(SimulationParams)),
        ("limits", dtype_of(LimitParams)),
        ("sensors", SENSOR_UNITS),
        ("faults", FAULTS),
    ],
    align=True,
)


class CasePart(NamedTuple):
    """Fields of a case, by dotted paths, that follow from some sections of a scenario, and what fills them
    when they are zero: called with the case, the scenario and the tables.
    """

    fields: tuple[str, ...]
    sections: frozenset[str]
    fill: Callable[[np.void, Scenario, np.void], None]


def build_case(
    scenario: Scenario, tables: np.ndarray, like: tuple[Scenario, np.ndarray] | None = None
) -> np.ndarray:
    """The truth of one flight, shape (1,).

    Args:
        scenario: the true one.
        tables: of :func:`build_tables`.
        like: a scenario of the same tables and its case, from which the fields of sections that both share
            are copied.
    """
    if like is None:
        cases, changed = np.zeros(1, CASE), set(Scenario.model_fields)
    else:
        cases, changed = duplicate(like[1]), changed_fields(scenario, like[0])
    for part in CASE_PARTS:
        if not part.sections.isdisjoint(changed):
            _clear(cases, part.fields)
            part.fill(cases[0], scenario, tables[0])
    return cases


def _clear(cases: np.ndarray, fields: tuple[str, ...]) -> None:
    content = cases.view(np.uint8)
    for path in fields:
        layout, start = CASE, 0
        for name in path.split("."):
            start, layout = start + offset(layout, name), layout[name]
        content[start : start + layout.itemsize] = 0


def _fill_section(name: str, case: np.void, s: Scenario, tables: np.void) -> None:
    fill(case[name], getattr(s, name))


def _fill_initial(case: np.void, s: Scenario, tables: np.void) -> None:
    fill(case["initial"], s.initial)
    case["initial"]["altitude"] = s.initial_altitude_m


def _fill_atmosphere(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_atmosphere(case["atmosphere"], s.atmosphere, tables["atmosphere"], s.seed, s.profile)


def _fill_wind(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_wind(case["wind"], s.wind, tables["atmosphere"], s.seed, s.profile)


def _fill_sensors(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_sensor_params(case["sensors"], s.sensors_in_flight)


def _draw_sensors(case: np.void, s: Scenario, tables: np.void) -> None:
    draw_sensor_units(case["sensors"], s.sensors_in_flight, s.seed, s.profile)
    case["sensors"]["unit"]["star_tracker"]["until"] = event_number(s.mission, s.sensors.star_tracker.until)


def _fill_ground(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_terrain(case["terrain"], s.terrain, tables["terrain"], s.planet, s.seed, s.profile)
    fill_site(case["site"], s)


def _fill_vehicle(case: np.void, s: Scenario, tables: np.void) -> None:
    fill(case["vehicle"], s.vehicle)
    jets, engines, tanks = s.vehicle.rcs.thrusters, s.vehicle.engines, s.vehicle.tanks
    fill_lander(case["lander"], s.vehicle.mass, tuple(s.vehicle.parts), tuple(tanks))
    fill_feeds(case["feeds"]["engines"], [engine.draws_from for engine in engines], tanks)
    fill_feeds(case["feeds"]["thrusters"], [jet.draws_from for jet in jets], tanks)
    fill_branches(case["branches"], s.vehicle.rcs.laid_branches, jets)
    fill_suspension(case["suspension"], s.vehicle)
    case["carrier"][: len(s.vehicle.surfaces)] = carriers(s.vehicle)


def _fill_goal(case: np.void, s: Scenario, tables: np.void) -> None:
    fill(case["limits"], s.limits)
    case["dynamics"] = DYNAMICS.index(s.dynamics)
    last = s.mission.last_events
    case["ends_with"][: len(s.mission.events)] = [name in last for name in s.mission.events]
    if s.mission.goal == "time":
        case["limits"]["skip_out"] = np.inf  # a flight that need not land may climb


def _fill_events(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_events(case["events"], s.mission, s.vehicle)


def _fill_faults(case: np.void, s: Scenario, tables: np.void) -> None:
    fill_faults(case["faults"], s.faults, s.components, s.phase_names)


CASE_PARTS = (
    *(
        CasePart((name,), frozenset({name}), partial(_fill_section, name))
        for name in ("point_mass", "simulation")
    ),
    CasePart(("planet",), frozenset({"planet"}), lambda case, s, _: fill_planet(case["planet"], s.planet)),
    CasePart(("initial",), frozenset({"initial", "planet"}), _fill_initial),
    CasePart(("atmosphere",), frozenset({"atmosphere", "seed", "profile"}), _fill_atmosphere),
    CasePart(("wind",), frozenset({"wind", "seed", "profile"}), _fill_wind),
    CasePart(("sensors.params",), frozenset({"sensors", "dynamics"}), _fill_sensors),
    CasePart(
        ("sensors.unit",), frozenset({"sensors", "dynamics", "seed", "profile", "mission"}), _draw_sensors
    ),
    CasePart(("terrain", "site"), frozenset({"terrain", "planet", "seed", "profile"}), _fill_ground),
    CasePart(
        ("vehicle", "lander", "feeds", "branches", "suspension", "carrier"),
        frozenset({"vehicle"}),
        _fill_vehicle,
    ),
    CasePart(("events",), frozenset({"mission", "vehicle"}), _fill_events),
    CasePart(("faults",), frozenset({"faults", "vehicle", "sensors", "mission"}), _fill_faults),
    CasePart(("limits", "dynamics", "ends_with"), frozenset({"limits", "dynamics", "mission"}), _fill_goal),
)
