"""The entry point from which a mission reaches another landing site.

Altitude, speed, flight-path angle and azimuth of the entry state stay; latitude and longitude change.  The
entry flown is the planned one (:mod:`~edl6dof.scenario.planned_entry`), with the bank profile of the scenario
as it is, so that guidance keeps its full authority on both sides; a mission without entry guidance flies in
its initial attitude.  The first entry point lies as far from the new site as the old one from the old site,
in the same direction relative to the azimuth.  Then the point moves along and across the track by what the
planned end misses: on a sphere that does not rotate this one step is exact, so it stands for the Jacobian of
Newton's method, and the rotation, the flattening and the air leave a few per cent for the next step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, hypot, pi, radians
from typing import NamedTuple

from edl6dof.config.errors import refusal
from edl6dof.environment.areoid import map_height
from edl6dof.environment.terrain import ground_arrays, ground_inputs
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.planned_entry import fly_shifted
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import Scenario, start_of
from edl6dof.spatial.elementary import asin, atan2, cos, sin
from edl6dof.spatial.frames import great_circle
from edl6dof.spatial.vector import clamp

#: Accepted distance (m) of the planned end from the wanted one, along and across: bank reversals, which come
#: at whole guidance cycles, leave some hundred metres across the track.
CLOSE_M, CLOSE_ASIDE_M = 100.0, 500.0
#: Largest number of entries flown.
MOST_ENTRIES = 12


class Place(NamedTuple):
    """Latitude and east longitude, rad."""

    latitude: float
    longitude: float


@dataclass(frozen=True)
class Aim:
    """An entry point that reaches a site."""

    entry_deg: tuple[float, float]  #: geodetic latitude and east longitude of the entry state
    #: distance (m) of the end of the planned entry beyond the aim point and right of it: old site, new site
    ends: tuple[tuple[float, float], tuple[float, float]]
    entries: int  #: planned entries flown to the new site

    @property
    def beyond_m(self) -> float:
        """Distance (m) of the planned end beyond the aim point, less that at the old site."""
        return self.ends[1][0] - self.ends[0][0]

    @property
    def aside_m(self) -> float:
        """Distance (m) of the planned end right of the aim point, less that at the old site."""
        return self.ends[1][1] - self.ends[0][1]

    @property
    def reached(self) -> bool:
        """True if the planned entry ends relative to the aim point as at the old site."""
        return abs(self.beyond_m) <= CLOSE_M and abs(self.aside_m) <= CLOSE_ASIDE_M

    @property
    def overrides(self) -> list[str]:
        """Overrides of the scenario for the entry point."""
        return entry_overrides(self.entry_deg)


def site_overrides(
    scenario: Scenario, site: tuple[float, float], elevation_m: float | None, epoch_utc: str | None
) -> list[str]:
    """Overrides that give a scenario another landing site and, where one is given, another date.

    Args:
        scenario: the scenario at its own site.
        site: geodetic latitude and east longitude, deg.
        elevation_m: elevation of the site above the areoid; None to take that of the relief map, or of the
            old site if there is no map.
        epoch_utc: date and time of the initial state; None to keep it.
    """
    if elevation_m is None:
        elevation_m = round(map_elevation(scenario, site), 1)
    overrides = [
        f"terrain.site_latitude_deg={site[0]}",
        f"terrain.site_longitude_deg={site[1]}",
        f"terrain.site_elevation_m={elevation_m}",
    ]
    return overrides if epoch_utc is None else [*overrides, f"initial.epoch_utc={epoch_utc}"]


def map_elevation(scenario: Scenario, site: tuple[float, float]) -> float:
    """Elevation (m above the areoid) of the relief map at geodetic latitude and east longitude (deg); that of
    the landing site for a terrain without a map.
    """
    terrain = scenario.terrain
    if terrain.model != "mola":
        return terrain.site_elevation_m
    relief_map = ground_arrays(ground_inputs(terrain, scenario.planet))["map"]
    return float(map_height(relief_map, radians(site[0]), radians(site[1]))[0])


def aim_entry(name: str, overrides: Sequence[str], site: Sequence[str]) -> Aim:
    """Find the entry point from which a scenario reaches another site as it reaches its own.

    Args:
        name: name of the scenario, or its file.
        overrides: changes of the scenario at its own site.
        site: further overrides, for the new site and its date.

    Raises:
        ConfigError: no entry of this azimuth and range reaches the latitude of the site.
    """
    old = load_scenario(name, overrides).scenario
    target = Place(*load_scenario(name, [*overrides, *site]).scenario.site_place)
    radius, own_end = old.planet.equatorial_radius_m, planned_end(old)
    entry = start_before(target, *great_circle(old.initial.place, old.site_place))
    for count in range(1, MOST_ENTRIES + 1):
        place = (round(degrees(entry.latitude), 6), round(degrees(entry.longitude), 6))
        new = load_scenario(name, [*overrides, *site, *entry_overrides(place)]).scenario
        found = Aim(place, (own_end, planned_end(new)), count)
        if found.reached:
            break
        _, ahead = great_circle(entry, target)
        entry = moved(entry, ahead, -found.beyond_m / radius)
        entry = moved(entry, ahead + 0.5 * pi, -found.aside_m / radius)
    return found


def entry_overrides(place: tuple[float, float]) -> list[str]:
    """Overrides for an entry point (latitude and longitude, deg)."""
    return [f"initial.latitude_deg={place[0]}", f"initial.longitude_deg={place[1]}"]


def start_before(end: Place, distance: float, bearing: float) -> Place:
    """The place from which a great circle leaves with an initial bearing (rad) and reaches ``end`` after an
    angular distance (rad).

    Raises:
        ConfigError: no great circle of this bearing and length reaches the latitude of ``end``.
    """
    up, ahead = cos(distance), sin(distance) * cos(bearing)  # sin(end) = up sin(start) + ahead cos(start)
    highest = hypot(up, ahead)
    latitude = asin(clamp(sin(end.latitude) / highest, -1.0, 1.0)) - atan2(ahead, up)
    if abs(sin(end.latitude)) > highest or abs(latitude) > 0.5 * pi:
        reason = "no entry of the azimuth and range of the scenario reaches the latitude "
        raise refusal("--site", f"{reason}{degrees(end.latitude):.1f} deg; set initial.azimuth_deg")
    turn = atan2(
        sin(bearing) * sin(distance) * cos(latitude), cos(distance) - sin(latitude) * sin(end.latitude)
    )
    return Place(latitude, end.longitude - turn)


def planned_end(scenario: Scenario) -> tuple[float, float]:
    """Distances (m) of the end of the planned entry beyond the aim point and right of it."""
    end = fly_shifted(build_onboard(scenario)[0], start_of(scenario), 0.0)[-1]
    return float(end["beyond"]), float(end["aside"])


def moved(start: Place, bearing: float, distance: float) -> Place:
    """The place at an angular distance (rad) along a bearing (rad); a negative distance lies behind."""
    latitude = asin(sin(start.latitude) * cos(distance) + cos(start.latitude) * sin(distance) * cos(bearing))
    turn = atan2(
        sin(bearing) * sin(distance) * cos(start.latitude),
        cos(distance) - sin(start.latitude) * sin(latitude),
    )
    return Place(latitude, start.longitude + turn)
