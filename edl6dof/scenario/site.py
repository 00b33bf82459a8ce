"""Where the landing site is."""

from __future__ import annotations

from math import radians

import numpy as np

from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.frames import fill_local_frame


def fill_site(frame: np.void, scenario: Scenario) -> None:
    """Fill the ``LOCAL_FRAME`` record of the landing site."""
    terrain, planet = scenario.terrain, scenario.planet
    latitude, longitude = radians(terrain.site_latitude_deg), radians(terrain.site_longitude_deg)
    altitude = scenario.site_areoid_m + terrain.site_elevation_m
    fill_local_frame(frame, planet.equatorial_radius_m, planet.flattening, latitude, longitude, altitude)
