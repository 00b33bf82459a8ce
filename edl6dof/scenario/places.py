"""Landing site and initial state of a scenario, in planet-fixed axes."""

from __future__ import annotations

from math import radians

import numpy as np

from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import atan2, cos, hypot, sin
from edl6dof.spatial.frames import fill_local_frame, from_geodetic, ned_to_fixed

#: Position (m) and velocity relative to the planet (m/s), in F.
Start = tuple[float, float, float, float, float, float]


def start_of(scenario: Scenario) -> Start:
    """Position and velocity of the initial state of a scenario."""
    initial, planet = scenario.initial, scenario.planet
    lat, lon = radians(initial.latitude_deg), radians(initial.longitude_deg)
    r = from_geodetic(planet.equatorial_radius_m, planet.flattening, lat, lon, scenario.initial_altitude_m)
    sin_vertical, cos_vertical, sin_lon, cos_lon = vertical_axes(scenario)
    v = ned_to_fixed(sin_vertical, cos_vertical, sin_lon, cos_lon, initial.velocity_ned)
    return *r, *v


def vertical_axes(scenario: Scenario) -> tuple[float, float, float, float]:
    """Sines and cosines of latitude and longitude of the vertical that initial velocity refers to."""
    initial, planet = scenario.initial, scenario.planet
    lat, lon = radians(initial.latitude_deg), radians(initial.longitude_deg)
    vertical = lat
    if initial.vertical == "geocentric":
        x, y, z = from_geodetic(
            planet.equatorial_radius_m, planet.flattening, lat, lon, scenario.initial_altitude_m
        )
        vertical = atan2(z, hypot(x, y))
    return sin(vertical), cos(vertical), sin(lon), cos(lon)


def fill_site(frame: np.void, scenario: Scenario) -> None:
    """Fill the ``LOCAL_FRAME`` record of the landing site."""
    terrain, planet = scenario.terrain, scenario.planet
    latitude, longitude = radians(terrain.site_latitude_deg), radians(terrain.site_longitude_deg)
    altitude = scenario.site_areoid_m + terrain.site_elevation_m
    fill_local_frame(frame, planet.equatorial_radius_m, planet.flattening, latitude, longitude, altitude)
