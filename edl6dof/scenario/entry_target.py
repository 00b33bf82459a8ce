"""Aim point of entry guidance: where the parachute must open for the lander to come down at the site."""

from __future__ import annotations

from math import pi, radians

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.entry.reference import fill_reference
from edl6dof.scenario.expected_descent import SCRATCH, expected_drift, wind_of
from edl6dof.scenario.planned_entry import plan_entry
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import atan2, cos, sin
from edl6dof.spatial.frames import geodetic, great_circle, ned_to_fixed
from edl6dof.vehicle.vehicle import VehicleParams


def plan(onboard: np.ndarray, scenario: Scenario, tables: np.ndarray) -> np.ndarray:
    """Write the aim point into ``onboard[0]["site"]``, and the reference trajectory that leads there.

    Where the mission deploys no parachute, or only notes it, the aim point is the landing site.

    Args:
        onboard: onboard record array of length one, everything else filled.
        scenario: the nominal one; a phase of it flies entry guidance.
        tables: those of the nominal one, shape (1,), for the winds.

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
    fill_reference(planned, onboard[0]["reference"])
    return planned


def drift(
    onboard: np.ndarray,
    scenario: Scenario,
    tables: np.ndarray,
    phase: int,
    arrival: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Way north and east (m) that the descent under the parachute is expected to take.

    Args:
        onboard: as of :func:`plan`.
        scenario: the nominal one.
        tables: those of the nominal one, shape (1,).
        phase: index of the mission phase that deploys.
        arrival: altitude (m) and velocity towards north, east and up (m/s) at which it does.
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
    """Index of the first mission phase that deploys a parachute which is more than noted."""
    packed = {chute.name for chute in scenario.vehicle.parachutes if chute.pack is not None}
    deploys = (
        any(event.action == "deploy" and event.component in packed for event in phase.events)
        for phase in scenario.mission.phases
    )
    return next((index for index, does in enumerate(deploys) if does), None)


def _azimuth_at_site(scenario: Scenario, site: np.void) -> float:
    """Azimuth (rad) in which the great circle from the initial state arrives at the site."""
    lat, lon = radians(scenario.initial.latitude_deg), radians(scenario.initial.longitude_deg)
    _, back = great_circle((float(site["latitude"]), float(site["longitude"])), (lat, lon))
    return back + pi


def _displaced(onboard: np.void, north: float, east: float) -> tuple[float, float]:
    """Latitude and longitude (rad) of the point so far (m) from the landing site."""
    frame, planet = onboard["site"]["frame"], onboard["planet"]
    axes = (frame["sin_lat"], frame["cos_lat"], frame["sin_lon"], frame["cos_lon"])
    r_F = frame["origin_F"] + np.array(ned_to_fixed(*axes, (north, east, 0.0)))
    sin_lat, cos_lat, sin_lon, cos_lon, _ = geodetic(
        float(planet["equatorial_radius"]), float(planet["flattening"]), tuple(r_F)
    )
    return atan2(sin_lat, cos_lat), atan2(sin_lon, cos_lon)
