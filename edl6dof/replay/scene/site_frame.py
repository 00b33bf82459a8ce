"""The landing-site frame L (east, north, up; m), the true ground around it, and the sun over it."""

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
from edl6dof.scenario.relief import Relief
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario


#: Where light comes from when nobody knows: low in the west-south-west, so that relief throws light and dark;
#: east north up.
ANYWHERE = np.array([-0.72, -0.42, 0.55]) / np.linalg.norm([-0.72, -0.42, 0.55])
#: Sine of the elevation below which the sun lights no picture.
_LOWEST = sin(radians(8.0))


class Site:
    """The landing-site frame L and the shape of the ground around it."""

    def __init__(self, scenario: Scenario) -> None:
        terrain, planet = scenario.terrain, scenario.planet
        lat, lon = radians(terrain.site_latitude_deg), radians(terrain.site_longitude_deg)
        east = (-sin(lon), cos(lon), 0.0)
        north = (-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat))
        up = (cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat))
        self.axes = np.array([east, north, up])  #: turns components in F into components in L
        self.altitude = scenario.site_areoid_m + terrain.site_elevation_m  #: of its origin, m
        self.appearance = planet.appearance
        self.sun = sun_direction(scenario)  #: towards it, unit vector; None where nobody knows
        self.light = light(self.sun)  #: where the light of the pictures comes from
        self.radius, self.flattening = planet.equatorial_radius_m, planet.flattening
        self.spin = planet.rotation_rate_rad_s
        e2 = self.flattening * (2.0 - self.flattening)
        prime = self.radius / sqrt(1.0 - e2 * sin(lat) ** 2)
        # : of L, in F
        self.origin = (prime + self.altitude) * np.array(up) - [0.0, 0.0, e2 * prime * sin(lat)]
        self.relief = Relief(terrain, planet, scenario.seed, scenario.profile)

    def attitude(self, t: np.ndarray, q_I2B: np.ndarray) -> np.ndarray:
        """Return rotations from components in B to components in L.

        F and I coincide at t = 0.
        """
        to_F = turns.about_z(-self.spin * np.asarray(t))
        return turns.multiply(turns.from_axes(self.axes), turns.multiply(to_F, q_I2B))

    def in_F(self, place: np.ndarray) -> np.ndarray:
        """Return the planet-fixed position (m) of points in L."""
        return self.origin + place @ self.axes

    def surface(self, east: np.ndarray, north: np.ndarray, altitude: np.ndarray | float) -> np.ndarray:
        """Return the up coordinate (m) of the point at ``altitude`` above the ellipsoid; of the limb beyond
        it.
        """
        a = self.radius + np.asarray(altitude)
        squash = (a / (a - self.flattening * self.radius)) ** 2  # equation x^2 + y^2 + squash z^2 = a^2
        place = self.origin + np.stack([east, north], axis=-1) @ self.axes[:2]
        up = self.axes[2]
        k2 = up[0] ** 2 + up[1] ** 2 + squash * up[2] ** 2
        k1 = place[..., 0] * up[0] + place[..., 1] * up[1] + squash * place[..., 2] * up[2]
        k0 = place[..., 0] ** 2 + place[..., 1] ** 2 + squash * place[..., 2] ** 2 - a**2
        return (np.sqrt(np.maximum(k1**2 - k2 * k0, 0.0)) - k1) / k2

    def ground(self, east: np.ndarray, north: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the elevation (m above the areoid) of the simulation's own ground, and its up coordinate in
        L (m).
        """
        east, north = np.broadcast_arrays(np.asarray(east, float), np.asarray(north, float))
        elevation, altitude = self.relief.heights(*self._geodetic(east, north))
        return elevation, self.surface(east, north, altitude)

    def around(
        self, centre: np.ndarray, east: np.ndarray, north: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return elevation (m above the areoid) and place in L (m), shape (..., 3), of the ground at arcs (m)
        east and north of ``centre`` (in L), as far as the other side of the planet.
        """
        here = self._geodetic(np.array(centre[0], float), np.array(centre[1], float))
        arc, heading = np.hypot(east, north) / self.radius, np.arctan2(east, north)
        upward = np.sin(here[0]) * np.cos(arc) + np.cos(here[0]) * np.sin(arc) * np.cos(heading)
        latitude = np.arcsin(np.clip(upward, -1.0, 1.0))
        longitude = here[1] + np.arctan2(
            np.sin(heading) * np.sin(arc) * np.cos(here[0]), np.cos(arc) - np.sin(here[0]) * upward
        )
        elevation, altitude = self.relief.heights(latitude, np.remainder(longitude + pi, 2.0 * pi) - pi)
        return elevation, self._placed(latitude, longitude, altitude)

    def _placed(
        self, latitude: np.ndarray, longitude: np.ndarray, altitude: np.ndarray | float
    ) -> np.ndarray:
        """Geodetic places (rad, m) in L."""
        e2 = self.flattening * (2.0 - self.flattening)
        prime = self.radius / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
        level = (prime + altitude) * np.cos(latitude)
        upward = ((1.0 - e2) * prime + altitude) * np.sin(latitude)
        in_F = np.stack([level * np.cos(longitude), level * np.sin(longitude), upward], axis=-1)
        placed: np.ndarray = (in_F - self.origin) @ self.axes.T
        return placed

    def rocks(self, east: float, north: float, side: float, smallest: float) -> np.ndarray:
        """Return the rocks of at least ``smallest`` (m) in a square of ``side`` (m) about a place: east and
        north in L and diameter (m), shape (n, 3).
        """
        here = self._geodetic(np.array([east]), np.array([north]))
        latitude, longitude, diameter = self.relief.rocks(
            float(here[0][0]), float(here[1][0]), side, smallest
        ).T
        return np.column_stack([self._placed(latitude, longitude, self.altitude)[:, :2], diameter])

    def _geodetic(self, east: np.ndarray, north: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Latitude and longitude (rad) of places in L at the altitude of its origin, to less than 1e-9 rad.

        Source: Bowring, Survey Review 23(181) (1976).
        """
        level = np.stack([east, north, self.surface(east, north, self.altitude)], axis=-1)
        x, y, z = np.moveaxis(self.in_F(level), -1, 0)
        polar = (1.0 - self.flattening) * self.radius
        e2 = self.flattening * (2.0 - self.flattening)
        across = np.hypot(x, y)
        reduced = np.arctan2(self.radius * z, polar * across)
        upward = z + e2 / (1.0 - e2) * polar * np.sin(reduced) ** 3
        return np.arctan2(upward, across - e2 * self.radius * np.cos(reduced) ** 3), np.arctan2(y, x)


def sun_direction(scenario: Scenario) -> np.ndarray | None:
    """Return the unit vector (east, north, up) from the landing site to the sun at t = 0; ``None`` if the
    scenario has no date or the planet no calendar.
    """
    moment, climate = scenario.initial.epoch_utc, scenario.planet.climate
    if not moment or climate is None:
        return None
    place = scenario.terrain
    latitude, longitude = radians(place.site_latitude_deg), radians(place.site_longitude_deg)
    return towards_sun(climate.calendar, days_since_j2000(utc(moment)), latitude, longitude)


def towards_sun(calendar: CalendarParams, days: float, latitude: float, longitude: float) -> np.ndarray:
    """Return the unit vector (east, north, up) to the sun ``days`` after J2000, from a place (rad).

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
    """Return the direction of the light: that of the sun if it is known and above the horizon."""
    return ANYWHERE if sun is None or sun[2] < _LOWEST else sun
