"""The truth of one flight: its record, and the scenario written into it."""

from __future__ import annotations

import numpy as np

from edl6dof.config.dtype import dtype_of, extended, fill
from edl6dof.environment.atmosphere import ATMOSPHERE, fill_atmosphere
from edl6dof.environment.planet import PLANET, fill_planet
from edl6dof.environment.terrain import TERRAIN, fill_terrain
from edl6dof.environment.wind import WIND, fill_wind
from edl6dof.interface.capacities import MAX_EVENTS, MAX_PARACHUTES, MAX_SURFACES
from edl6dof.interface.effectors import BRANCHES, EVENT_TABLE
from edl6dof.records import FLAG, record
from edl6dof.scenario.initial import InitialState
from edl6dof.scenario.mission_events import event_number, fill_events
from edl6dof.scenario.schema import LimitParams, Scenario, SimulationParams, fill_site
from edl6dof.sensors.registry import SENSOR_UNITS, draw_sensor_units, fill_sensor_params
from edl6dof.spatial.frames import LOCAL_FRAME
from edl6dof.vehicle.faults.fault import FAULTS, fill_faults
from edl6dof.vehicle.mass import BODY, fill_lander
from edl6dof.vehicle.motion.point_mass import DYNAMICS, PointMassParams
from edl6dof.vehicle.parachutes.parachute import SUSPENSION
from edl6dof.vehicle.propulsion.feed_system import FEEDS, fill_feeds
from edl6dof.vehicle.propulsion.rcs import fill_branches
from edl6dof.vehicle.vehicle import VehicleParams, carriers, fill_suspension

CASE = record(
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
)


def build_case(scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """Build the truth of one flight, shape (1,).

    Args:
        scenario: the true scenario.
        tables: result of :func:`build_tables`.
    """
    cases = np.zeros(1, CASE)
    case, s, table = cases[0], scenario, tables[0]
    seed = (s.seed, s.profile)
    fill_planet(case["planet"], s.planet)
    fill_atmosphere(case["atmosphere"], s.atmosphere, table["atmosphere"], *seed)
    fill_wind(case["wind"], s.wind, table["atmosphere"], *seed)
    fill_terrain(case["terrain"], s.terrain, table["terrain"], s.planet, *seed)
    fill_site(case["site"], s)
    _fill_vehicle(case, s)
    fill_events(case["events"], s.mission, s.vehicle)
    fill(case["point_mass"], s.point_mass)
    fill(case["initial"], s.initial)
    case["initial"]["altitude"] = s.initial_altitude_m
    fill(case["simulation"], s.simulation)
    fill_sensor_params(case["sensors"], s.sensors_in_flight)
    draw_sensor_units(case["sensors"], s.sensors_in_flight, *seed)
    case["sensors"]["unit"]["star_tracker"]["until"] = event_number(s.mission, s.sensors.star_tracker.until)
    fill_faults(case["faults"], s.faults, s.components, s.phase_names, seed)
    _fill_goal(case, s)
    return cases


def _fill_vehicle(case: np.void, s: Scenario) -> None:
    fill(case["vehicle"], s.vehicle)
    jets, engines, tanks = s.vehicle.rcs.thrusters, s.vehicle.engines, s.vehicle.tanks
    fill_lander(case["lander"], s.vehicle.mass, tuple(s.vehicle.parts), tuple(tanks))
    fill_feeds(case["feeds"]["engines"], [engine.draws_from for engine in engines], tanks)
    fill_feeds(case["feeds"]["thrusters"], [jet.draws_from for jet in jets], tanks)
    fill_branches(case["branches"], s.vehicle.rcs.laid_branches, jets)
    fill_suspension(case["suspension"], s.vehicle)
    case["carrier"][: len(s.vehicle.surfaces)] = carriers(s.vehicle)


def _fill_goal(case: np.void, s: Scenario) -> None:
    fill(case["limits"], s.limits)
    case["dynamics"] = DYNAMICS.index(s.dynamics)
    last = s.mission.last_events
    case["ends_with"][: len(s.mission.events)] = [name in last for name in s.mission.events]
    if s.mission.goal == "time":
        case["limits"]["skip_out"] = np.inf  # a flight that need not land may climb
