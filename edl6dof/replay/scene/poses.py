"""Poses in the landing-site frame L (east, north, up; m), the true ground around it, and the sun over it."""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, atan, cos, pi, radians, sin, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from edl6dof.config.base import stated
from edl6dof.environment.climate import (
    CalendarParams,
    days_since_j2000,
    local_true_solar_time,
    solar_longitude,
    utc,
)
from edl6dof.replay.history import PARTS, History, vector
from edl6dof.replay.scene.outline import outline
from edl6dof.scenario.terrain_preview import TerrainPreview
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    from edl6dof.scenario.schema import Scenario

#: Direction of the light without a date: low in the west-south-west, so that relief shows; east, north, up.
ANYWHERE = np.array([-0.72, -0.42, 0.55]) / np.linalg.norm([-0.72, -0.42, 0.55])
#: Sine of the elevation below which the sun lights no picture.
_LOWEST = sin(radians(8.0))
#: Longest stroke (m) of a leg that is drawn.
_LONGEST_STROKE = 0.4


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
        self.sun = sun_direction(scenario)  #: unit vector towards it; None if unknown
        self.light = light(self.sun)  #: where the light of the pictures comes from
        self.radius, self.flattening = planet.equatorial_radius_m, planet.flattening
        self.spin = planet.rotation_rate_rad_s
        self._e2 = self.flattening * (2.0 - self.flattening)
        prime = self.radius / sqrt(1.0 - self._e2 * sin(lat) ** 2)
        #: of L, in F
        self.origin = (prime + self.altitude) * np.array(up) - [0.0, 0.0, self._e2 * prime * sin(lat)]
        self.relief = TerrainPreview(terrain, planet, scenario.seed, scenario.profile)

    def attitude(self, t: np.ndarray, q_I2B: np.ndarray) -> np.ndarray:
        """Return rotations from components in B to components in L; F and I coincide at t = 0."""
        to_F = turns.about_z(-self.spin * np.asarray(t))
        return turns.multiply(turns.from_axes(self.axes), turns.multiply(to_F, q_I2B))

    def in_F(self, place: np.ndarray) -> np.ndarray:
        """Return the planet-fixed position (m) of points in L."""
        return self.origin + place @ self.axes

    def surface(self, east: np.ndarray, north: np.ndarray, altitude: np.ndarray | float) -> np.ndarray:
        """Return the up coordinate (m in L) of places at ``altitude`` (m) above the ellipsoid; beyond the
        limb, that of the place nearest to the ellipsoid.
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
        """Return elevation (m above the areoid) and up coordinate in L (m) of the simulated ground."""
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
        """Places in L (m), shape (..., 3), of geodetic latitude and longitude (rad) and altitude (m)."""
        prime = self.radius / np.sqrt(1.0 - self._e2 * np.sin(latitude) ** 2)
        level = (prime + altitude) * np.cos(latitude)
        upward = ((1.0 - self._e2) * prime + altitude) * np.sin(latitude)
        in_F = np.stack([level * np.cos(longitude), level * np.sin(longitude), upward], axis=-1)
        placed: np.ndarray = (in_F - self.origin) @ self.axes.T
        return placed

    def rocks(self, east: float, north: float, side: float, smallest: float) -> np.ndarray:
        """Return the rocks of at least ``smallest`` (m) in a square of ``side`` (m) about a place: east and
        north in L and diameter (m), shape (n, 3).
        """
        here = self._geodetic(np.array([east]), np.array([north]))
        found = self.relief.rocks(float(here[0][0]), float(here[1][0]), side, smallest)
        latitude, longitude, diameter = found.T
        return np.column_stack([self._placed(latitude, longitude, self.altitude)[:, :2], diameter])

    def _geodetic(self, east: np.ndarray, north: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Latitude and longitude (rad) of places in L at the altitude of its origin, to less than 1e-9 rad.

        Source: Bowring, Survey Review 23(181) (1976).
        """
        level = np.stack([east, north, self.surface(east, north, self.altitude)], axis=-1)
        x, y, z = np.moveaxis(self.in_F(level), -1, 0)
        polar, e2 = (1.0 - self.flattening) * self.radius, self._e2
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
    level, east = cos(declination) * cos(hour), -cos(declination) * sin(hour)
    north = sin(declination) * cos(latitude) - level * sin(latitude)
    return np.array([east, north, sin(declination) * sin(latitude) + level * cos(latitude)])


def light(sun: np.ndarray | None) -> np.ndarray:
    """Return the direction of the light: that of the sun if it is known and above the horizon."""
    return ANYWHERE if sun is None or sun[2] < _LOWEST else sun


class OpenParachute(NamedTuple):
    """Number of a parachute in the vehicle file, its first row, and the row after its last."""

    number: int
    first: int
    end: int


class Motion:
    """Poses of one flight, at the rows of its history."""

    def __init__(self, flight: History) -> None:
        self.site = Site(flight.scenario)
        self.vehicle = flight.scenario.vehicle
        self.shape = outline(self.vehicle)  #: what the vehicle looks like
        self.t, self.height = flight.t, flight["truth.height_m"]
        #: of the centre of mass, and of what leaves the vehicle, m
        self.centre, self.canopy, self.heat_shield, self.backshell = (
            vector(flight.columns, f"truth.{part}", "east north up", "_m") for part in PARTS
        )
        #: B to L
        self.rotation = self.site.attitude(self.t, vector(flight.columns, "truth.q_I2B", "w x y z"))
        in_B = vector(flight.columns, "truth.centre", "x y z", "_m")
        self.nose = self.centre - turns.rotate(self.rotation, in_B)  #: origin of B
        known = flight.scenario.mission.events
        events = [(float(one["t_s"]), known[one["key"]]) for one in flight.events if one["key"] in known]
        self._deployed = [(t, event.component) for t, event in events if event.action == "deploy"]

    @property
    def last(self) -> np.ndarray:
        """Last position of the centre of mass, m in L."""
        return self.centre[-1]

    def released(self, place: np.ndarray) -> int | None:
        """Return the row of the release of a discarded part, whose places (m in L) are finite from then."""
        rows = np.flatnonzero(np.isfinite(place[:, 0]))
        return int(rows[0]) if len(rows) else None

    def strokes(self, pads: np.ndarray) -> np.ndarray:
        """Return how far (m) the ground pushes each of ``pads`` (m in B) up at the last row, at least 0."""
        turn = self.rotation[-1]
        place = self.nose[-1] + turns.rotate(turn, pads)
        below = self.site.ground(place[:, 0], place[:, 1])[1] - place[:, 2]
        upright = max(-turns.rotate(turn, np.array([1.0, 0.0, 0.0]))[2], 0.5)
        return np.clip(below / upright, 0.0, _LONGEST_STROKE)

    def parachutes(self) -> list[OpenParachute]:
        """Return the parachutes in order: each from its deployment, the last until the end."""
        out = self.released(self.canopy)
        if out is None or not self.vehicle.parachutes:
            return []
        chutes = {chute.name: number for number, chute in enumerate(self.vehicle.parachutes)}
        opened = [(t, chutes[name]) for t, name in sorted(self._deployed) if name in chutes]
        found = [(max(int(np.searchsorted(self.t, t)), out), number) for t, number in opened]
        found = found or [(out, len(chutes) - 1)]
        ends = [first for first, _ in found[1:]] + [len(self.t)]
        return [
            OpenParachute(number, first, end)
            for (first, number), end in zip(found, ends, strict=True)
            if first < end
        ]

    def parachute(self, flown: OpenParachute) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return rows, confluence points, quaternions and scales of a canopy: x from the confluence to the
        canopy.

        After release the backshell hangs under the last canopy, whose own position is no longer computed: it
        is drawn above.
        """
        chute = self.vehicle.parachutes[flown.number]
        length, middle = chute.line_length_m, np.array(chute.confluence_m)
        alone = self.released(self.backshell) if flown.end == len(self.t) else None
        own = np.arange(flown.first, flown.end)
        held = own[np.isfinite(self.canopy[own, 0])]
        after = np.arange(alone, len(self.t)) if alone is not None and len(held) else np.empty(0, int)
        rows = np.union1d(held, after)
        confluence = self.nose[rows] + turns.rotate(self.rotation[rows], middle)
        line = self.canopy[rows] - confluence
        free = ~np.isfinite(line[:, 0])
        if free.any():
            place, turn = self.discarded(self.backshell, stated(self.vehicle.showing("backshell")).centre_m)
            confluence[free] = place[rows[free]] + turns.rotate(turn, middle)
            hang = np.array([0.0, 0.0, length])
            last = line[~free][-1] if (~free).any() else hang
            fade = np.exp(-(self.t[rows[free]] - self.t[rows[free][0]]) / 4.0)[:, None]
            line[free] = last * fade + hang * (1.0 - fade)
        reach = np.linalg.norm(line, axis=-1)
        line /= np.where(reach > 1e-6, reach, 1.0)[:, None]
        spread = self._spread(flown.number, rows, reach)
        ground = self.site.ground(confluence[free, 0], confluence[free, 1])[1]
        fallen = np.flatnonzero(free)[confluence[free, 2] - ground < 3.0]
        if len(fallen):
            spread[fallen] *= np.exp(-(self.t[rows[fallen]] - self.t[rows[fallen]].min()) / 3.0) * 0.8 + 0.2
        scale = np.stack([reach / length, spread, spread], axis=-1)
        return rows, confluence, turns.from_x_to(line), scale

    def _spread(self, number: int, rows: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Width of a canopy relative to the inflated one, from its drag area after line stretch."""
        chute = self.vehicle.parachutes[number]
        taut = np.flatnonzero(reach >= 0.97 * chute.line_length_m)
        start = self.t[rows[taut[0]]] if len(taut) else np.inf
        grown = np.clip(chute.inflated(self.t[rows] - start), 0.0, 1.0)
        return 0.08 + 0.92 * np.sqrt(grown)

    def discarded(self, place: np.ndarray, own_centre: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the origin of a discarded part's B axes at each row, and its attitude at release."""
        turn = self.rotation[self.released(place) or 0]
        return place - turns.rotate(turn, np.asarray(own_centre)), turn
