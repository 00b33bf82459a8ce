"""Where the sun stands over a landing site, and the light that the ground is drawn in."""

from __future__ import annotations

from math import asin, atan, cos, pi, radians, sin, sqrt
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.environment.calendar import (
    CalendarParams,
    days_since_j2000,
    local_true_solar_time,
    solar_longitude,
    utc,
)

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

#: Where light comes from when nobody knows: low in the west-south-west, so that relief throws light and dark;
#: east north up.
ANYWHERE = np.array([-0.72, -0.42, 0.55]) / np.linalg.norm([-0.72, -0.42, 0.55])
#: Sine of the elevation below which the sun lights no picture.
_LOWEST = sin(radians(8.0))


def sun_direction(scenario: Scenario) -> np.ndarray | None:
    """Unit vector (east, north, up) from the landing site to the sun at t = 0; ``None`` where the scenario
    does not tell the moment, or the planet's calendar.
    """
    moment, climate = scenario.initial.epoch_utc, scenario.planet.climate
    if not moment or climate is None:
        return None
    place = scenario.terrain
    latitude, longitude = radians(place.site_latitude_deg), radians(place.site_longitude_deg)
    return towards_sun(climate.calendar, days_since_j2000(utc(moment)), latitude, longitude)


def towards_sun(calendar: CalendarParams, days: float, latitude: float, longitude: float) -> np.ndarray:
    """Unit vector (east, north, up) to the sun ``days`` after J2000, seen from a place (rad).

    The tilt of the axis is that of the first term of the equation of time, tan^2(tilt/2).  Source: Meeus,
    Astronomical Algorithms (1998), chapters 13 and 28.
    """
    tilt = 2.0 * atan(sqrt(radians(calendar.obliquity_deg[0])))
    declination = asin(sin(tilt) * sin(solar_longitude(calendar, days)))
    hour = (local_true_solar_time(calendar, days, longitude) - 12.0) * pi / 12.0
    level = cos(declination) * cos(hour)
    return np.array(
        [
            -cos(declination) * sin(hour),
            sin(declination) * cos(latitude) - level * sin(latitude),
            sin(declination) * sin(latitude) + level * cos(latitude),
        ]
    )


def light(sun: np.ndarray | None) -> np.ndarray:
    """Direction that the light of a picture comes from: the sun's where it is known and up."""
    return ANYWHERE if sun is None or sun[2] < _LOWEST else sun
