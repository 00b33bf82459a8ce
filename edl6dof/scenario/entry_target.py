"""Aim point of entry guidance: where the parachute must open for the lander to come down at the site.

The descent under the parachute is predicted before the flight: a point mass in the believed air and the
expected wind, over flat ground at rest (the Coriolis acceleration, 0.01 m/s2, carries it 30 m), hangs from a
canopy whose axis lies along the flow.  The sequencer of the flight computer runs its mission from the phase
that deploys a parachute, as long as no phase steers; delays of events, some 10 ms, are left out except that
of the mortar.  Source: equations of motion with drag alone, Knacke, Parachute Recovery Systems Design Manual
(1991), section 5.2; the classical Runge-Kutta method.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.wind_models import table_wind
from edl6dof.fsw.guidance.entry.air_data import ExpectedWindParams
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.reference import fill_reference, last_controlled
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.mission import G_NONE, SEQUENCE, enter, sequence
from edl6dof.fsw.navigation.derived import NAV, model_atmosphere
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.interface.effectors import DEPLOY, JETTISON
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.scenario.planned_entry import plan_entry
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import atan2, cos, sin
from edl6dof.spatial.frames import geodetic, great_circle, ned_to_fixed
from edl6dof.vehicle.parachutes.parachute import drag_efficiency, inflation, nominal_area
from edl6dof.vehicle.vehicle import VehicleParams

#: Step, s, and how many of them at most.
STEP, STEPS = 0.1, 36000
#: Rows of the state: place, m, and velocity relative to the ground, m/s.
NORTH, EAST, ALTITUDE, V_NORTH, V_EAST, V_UP = range(6)

#: Inputs, memory and outputs of the sequencer.
SCRATCH = record(
    ("nav", NAV),
    ("vehicle", VEHICLE_STATE),
    ("guide", GUIDE),
    ("sequence", SEQUENCE),
    ("request", "u1", (MAX_EVENTS,)),
)


def plan(onboard: np.ndarray, scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """Write the aim point into ``onboard[0]["site"]``, and the reference trajectory that leads there.

    If the mission deploys no parachute, or one without a pack, the aim point is the landing site.

    Args:
        onboard: onboard record array of length one, everything but the aim point and the reference filled.
        scenario: the nominal scenario; one of its phases flies entry guidance.
        tables: tables of the nominal scenario, shape (1,), for the winds.

    Returns:
        rows of the planned entry, ``PLANNED``.
    """
    site = onboard[0]["site"]
    planned = plan_entry(onboard, scenario)
    phase = _deploying_phase(scenario)
    if phase is not None:
        end, azimuth = planned[-1], _azimuth_at_site(scenario, site)
        level = end["speed"] * cos(end["path_angle"])
        velocity = level * cos(azimuth), level * sin(azimuth), end["speed"] * sin(end["path_angle"])
        north, east = drift(onboard, scenario, tables, phase, (end["altitude"], *velocity))
        site["aim_latitude"], site["aim_longitude"] = _displaced(onboard[0], -north, -east)
        planned = plan_entry(onboard, scenario, float(onboard[0]["reference"]["shift"]))
    end = last_controlled(planned, onboard[0]["guidance"]["entry"])
    fill_reference(planned, onboard[0]["reference"], end)
    return planned


def drift(
    onboard: np.ndarray,
    scenario: Scenario,
    tables: np.ndarray,
    phase: int,
    arrival: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Expected displacement north and east (m) of the descent under the parachute.

    Args:
        onboard: as for :func:`plan`.
        scenario: the nominal scenario.
        tables: tables of the nominal scenario, shape (1,).
        phase: index of the mission phase that deploys.
        arrival: altitude (m) and velocity towards north, east and up (m/s) at deployment.
    """
    wind = wind_of(scenario.flight_software.guidance.entry.expected_wind)
    vehicle = np.zeros(1, dtype_of(VehicleParams))
    fill(vehicle[0], scenario.vehicle)
    y = np.array((0.0, 0.0, *arrival))
    expected_drift(
        onboard[0],
        parachutes=vehicle[0]["parachutes"],
        winds=tables[0]["atmosphere"],
        wind=wind,
        areoid=scenario.site_areoid_m,
        phase=phase,
        y=y,
        scratch=np.zeros(1, SCRATCH)[0],
    )
    return float(y[0]), float(y[1])


def _deploying_phase(scenario: Scenario) -> int | None:
    """Index of the first mission phase that deploys a packed parachute."""
    packed = {chute.name for chute in scenario.vehicle.parachutes if chute.pack is not None}
    deploys = (
        any(event.action == "deploy" and event.component in packed for event in phase.events)
        for phase in scenario.mission.phases
    )
    return next((index for index, does in enumerate(deploys) if does), None)


def _azimuth_at_site(scenario: Scenario, site: np.void) -> float:
    """Azimuth (rad) in which the great circle from the initial state arrives at the site."""
    _, back = great_circle((float(site["latitude"]), float(site["longitude"])), scenario.initial.place)
    return back + pi


def _displaced(onboard: np.void, north: float, east: float) -> tuple[float, float]:
    """Latitude and longitude (rad) of the point ``north`` and ``east`` (m) of the landing site."""
    frame, planet = onboard["site"]["frame"], onboard["planet"]
    axes = (frame["sin_lat"], frame["cos_lat"], frame["sin_lon"], frame["cos_lon"])
    r_F = frame["origin_F"] + np.array(ned_to_fixed(*axes, (north, east, 0.0)))
    sin_lat, cos_lat, sin_lon, cos_lon, _ = geodetic(
        float(planet["equatorial_radius"]), float(planet["flattening"]), tuple(r_F)
    )
    return atan2(sin_lat, cos_lat), atan2(sin_lon, cos_lon)


class Wind(NamedTuple):
    """The expected wind: factor on the wind of the table, and north and east wind (m/s) added."""

    table_factor: float
    north: float
    east: float


def wind_of(params: ExpectedWindParams) -> Wind:
    """The expected wind that parameters describe."""
    return Wind(params.table_factor, params.north_m_s, params.east_m_s)


@kernel
def wind_at(wind, table, height):
    """Expected wind towards north and east (m/s) at a ``height`` (m) above the areoid, from the ``table`` of
    the believed air.
    """
    east, north = table_wind(wind, table, height)
    return wind.table_factor * north + wind.north, wind.table_factor * east + wind.east


class Hanging(NamedTuple):
    """Body under the parachute: index of the parachute, time of taut lines (s of flight), and mass (kg)."""

    chute: int
    line_stretch: float
    mass: float


@kernel
def expected_drift(onboard, parachutes, winds, wind, areoid, phase, y, scratch):
    """Propagate ``y`` from the deployment of the parachute to the start of steering or to the ground.

    Args:
        onboard: ``ONBOARD`` record, its air, site, vehicle and mission filled.
        parachutes: records of the nominal parachutes.
        winds: ``ATMOSPHERE_TABLE`` of the believed air.
        wind: :class:`Wind`.
        areoid: height of the areoid at the site above the ellipsoid, m.
        phase: index of the mission phase that deploys.
        y: state, shape (6,), updated: north, east and altitude (m), and their rates (m/s).
        scratch: ``SCRATCH`` record, zero.
    """
    mission, configuration = onboard.mission, onboard.vehicle.configuration
    gone, hanging = 0, Hanging(0, np.inf, configuration[0].mass)
    scene = (onboard, parachutes, winds, wind, areoid)
    enter(phase, 0.0, scratch.sequence)
    for k in range(STEPS):
        if mission.phases[scratch.sequence.phase].guidance != G_NONE or y[ALTITUDE] <= onboard.site.altitude:
            return
        _look(onboard, y, k * STEP, scratch.nav)
        scratch.request[:] = 0
        sequence(
            mission,
            scratch.nav,
            scratch.vehicle,
            scratch.guide,
            memory=scratch.sequence,
            request=scratch.request,
        )
        for number in range(mission.n_events):
            event = mission.events[number]
            if scratch.request[number] == 0:
                continue
            if event.action == JETTISON:
                gone |= 1 << event.component
                hanging = Hanging(hanging.chute, hanging.line_stretch, configuration[gone].mass)
            elif event.action == DEPLOY:
                pack = parachutes[event.component]
                taut = k * STEP + event.delay + pack.line_length / pack.mortar_speed
                hanging = Hanging(event.component, taut, hanging.mass)
        _advance(scene, hanging, k * STEP, y)


@kernel
def _look(onboard, y, t, nav):
    """Write the quantities that triggers read to ``nav``, from the state ``y`` at time ``t`` (s)."""
    density, sound, _ = model_atmosphere(onboard.atmosphere, y[ALTITUDE])
    nav.t = t
    nav.speed = sqrt(y[V_NORTH] * y[V_NORTH] + y[V_EAST] * y[V_EAST] + y[V_UP] * y[V_UP])
    nav.mach = nav.speed / sound
    nav.dynamic_pressure = 0.5 * density * nav.speed * nav.speed
    nav.altitude = y[ALTITUDE]
    nav.height = y[ALTITUDE] - onboard.site.altitude
    nav.v_N[2] = -y[V_UP]


@kernel
def _advance(scene, hanging, t, y):
    """Propagate the state ``y`` by one step from ``t`` (s): Runge-Kutta of fourth order."""
    a = _rates(scene, hanging, t, y)
    b = _rates(scene, hanging, t + 0.5 * STEP, _moved(y, 0.5 * STEP, a))
    c = _rates(scene, hanging, t + 0.5 * STEP, _moved(y, 0.5 * STEP, b))
    d = _rates(scene, hanging, t + STEP, _moved(y, STEP, c))
    for i in range(len(y)):
        y[i] += STEP / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i])


@kernel
def _moved(y, step, rates):
    """The state after a step (s) at these rates."""
    moved = np.empty(len(y))
    for i in range(len(y)):
        moved[i] = y[i] + step * rates[i]
    return moved


@kernel
def _rates(scene, hanging, t, y):
    """Rates of the state at time ``t`` (s), shape (6,): m/s, then m/s2.

    Args:
        scene: ``onboard``, ``parachutes``, ``winds``, ``wind`` and ``areoid`` of :func:`expected_drift`.
        hanging: :class:`Hanging`.
        t: flight time, s.
        y: state, shape (6,).
    """
    onboard, parachutes, winds, wind, areoid = scene
    planet, chute = onboard.planet, parachutes[hanging.chute]
    density, sound, _ = model_atmosphere(onboard.atmosphere, y[ALTITUDE])
    north, east = wind_at(wind, winds, y[ALTITUDE] - areoid)
    v_north, v_east = y[V_NORTH] - north, y[V_EAST] - east
    speed = sqrt(v_north * v_north + v_east * v_east + y[V_UP] * y[V_UP])
    mach = speed / sound
    area, _ = believed_aero(onboard.vehicle, mach, speed)
    canopy = nominal_area(chute) * chute.drag_coefficient * chute.drag_factor * drag_efficiency(chute, mach)
    area += canopy * inflation(chute, t - hanging.line_stretch)
    per_speed = 0.5 * density * speed * area / hanging.mass
    radius = planet.equatorial_radius + y[ALTITUDE]
    rates = np.empty(6)
    for i in range(V_NORTH):
        rates[i] = y[V_NORTH + i]
    rates[V_NORTH] = -per_speed * v_north
    rates[V_EAST] = -per_speed * v_east
    rates[V_UP] = -per_speed * y[V_UP] - planet.mu / (radius * radius)
    return rates
