"""The entry point from which a mission reaches another landing site.

Altitude, speed, flight-path angle and azimuth of the entry state stay; its place moves.  The entry flown is
the planned one (:mod:`~edl6dof.scenario.planned_entry`), with the bank profile of the scenario as it is, so
that guidance keeps its full authority on both sides; a mission without entry guidance flies in its initial
attitude.  The first entry point lies as far from the new site as the old one from the old site, in the same
direction relative to the azimuth.  Then the point moves along and across the track by what the planned end
misses: on a sphere that does not rotate this one step is exact, so it stands for the Jacobian of Newton's
method, and the rotation, the flattening and the air leave a few per cent for the next step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, hypot, pi, radians
from typing import NamedTuple

from edl6dof.config.errors import refusal
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.places import start_of
from edl6dof.scenario.planned_entry import fly_shifted
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import Scenario
from edl6dof.spatial.elementary import asin, atan2, cos, sin

#: Accepted distance (m) between the planned end and the wanted one, and most entries flown for it.
CLOSE_M, MOST_ENTRIES = 100.0, 12


class Place(NamedTuple):
    """Latitude and east longitude, rad."""

    latitude: float
    longitude: float


@dataclass(frozen=True)
class Aim:
    """An entry point that reaches a site."""

    entry_deg: tuple[float, float]  #: geodetic latitude and east longitude of the entry state
    beyond_m: float  #: what the planned end is beyond the wanted one
    aside_m: float  #: what it is right of it
    entries: int  #: planned entries flown

    @property
    def reached(self) -> bool:
        """Whether the planned entry ends where it should."""
        return hypot(self.beyond_m, self.aside_m) <= CLOSE_M

    @property
    def overrides(self) -> list[str]:
        """The entry point as overrides of a scenario."""
        latitude, longitude = self.entry_deg
        return [f"initial.latitude_deg={latitude:.6f}", f"initial.longitude_deg={longitude:.6f}"]


def aim_entry(name: str, overrides: Sequence[str], site: Sequence[str]) -> Aim:
    """Find the entry point from which a scenario reaches another site as it reaches its own.

    Args:
        name: of the scenario, or its file.
        overrides: changes of the scenario at its own site.
        site: further overrides, for the new site and its date.
    """
    old = load_scenario(name, overrides).scenario
    new = load_scenario(name, [*overrides, *site]).scenario
    radius = old.planet.equatorial_radius_m
    wanted = planned_end(old)
    distance, bearing = course(_entry_of(old), _site_of(old))
    target = _site_of(new)
    entry = start_before(target, distance, bearing)
    for count in range(1, MOST_ENTRIES + 1):
        found = Aim((degrees(entry.latitude), degrees(entry.longitude)), 0.0, 0.0, count)
        end = planned_end(load_scenario(name, [*overrides, *site, *found.overrides]).scenario)
        beyond, aside = end[0] - wanted[0], end[1] - wanted[1]
        found = Aim(found.entry_deg, beyond, aside, count)
        if found.reached:
            break
        _, ahead = course(entry, target)
        entry = moved(moved(entry, ahead, -beyond / radius), ahead + 0.5 * pi, -aside / radius)
    return found


def start_before(end: Place, distance: float, bearing: float) -> Place:
    """The place from which a great circle leaves with an initial bearing (rad) and reaches ``end`` after an
    angular distance (rad).

    Raises:
        ConfigError: no great circle of this bearing and length reaches the latitude of ``end``.
    """
    up, ahead = cos(distance), sin(distance) * cos(bearing)  # sin(end) = up sin(start) + ahead cos(start)
    highest = hypot(up, ahead)
    if abs(sin(end.latitude)) > highest:
        reason = f"lies beyond {degrees(asin(highest)):.1f} deg, the highest latitude that an entry of this "
        raise refusal("--site", f"{reason}azimuth and range reaches; set initial.azimuth_deg")
    latitude = asin(sin(end.latitude) / highest) - atan2(ahead, up)
    turn = atan2(
        sin(bearing) * sin(distance) * cos(latitude), cos(distance) - sin(latitude) * sin(end.latitude)
    )
    return Place(latitude, end.longitude - turn)


def planned_end(scenario: Scenario) -> tuple[float, float]:
    """Distance (m) of the end of the planned entry beyond the aim point and right of it."""
    end = fly_shifted(build_onboard(scenario)[0], start_of(scenario), 0.0)[-1]
    return float(end["beyond"]), float(end["aside"])


def course(start: Place, end: Place) -> tuple[float, float]:
    """Angular distance and initial bearing (rad) of the great circle from ``start`` to ``end``."""
    turn = end.longitude - start.longitude
    north = cos(start.latitude) * sin(end.latitude) - sin(start.latitude) * cos(end.latitude) * cos(turn)
    east = cos(end.latitude) * sin(turn)
    along = sin(start.latitude) * sin(end.latitude) + cos(start.latitude) * cos(end.latitude) * cos(turn)
    return atan2(hypot(north, east), along), atan2(east, north)


def moved(start: Place, bearing: float, distance: float) -> Place:
    """The place at an angular distance (rad) along a bearing (rad); a negative distance lies behind."""
    latitude = asin(sin(start.latitude) * cos(distance) + cos(start.latitude) * sin(distance) * cos(bearing))
    turn = atan2(
        sin(bearing) * sin(distance) * cos(start.latitude),
        cos(distance) - sin(start.latitude) * sin(latitude),
    )
    return Place(latitude, start.longitude + turn)


def _entry_of(scenario: Scenario) -> Place:
    initial = scenario.initial
    return Place(radians(initial.latitude_deg), radians(initial.longitude_deg))


def _site_of(scenario: Scenario) -> Place:
    terrain = scenario.terrain
    return Place(radians(terrain.site_latitude_deg), radians(terrain.site_longitude_deg))
