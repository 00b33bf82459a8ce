"""Climate of a site: the ground and the air that a planet's climate gives a place at a moment."""

from __future__ import annotations

from math import tau
from typing import NamedTuple

from edl6dof.config.errors import Inconsistent
from edl6dof.environment.areoid import areoid_file
from edl6dof.environment.atmosphere_models import SeasonalParams
from edl6dof.environment.climate import (
    days_since_j2000,
    local_true_solar_time,
    solar_longitude,
    surface_pressure,
    utc,
)
from edl6dof.environment.hydrostatic import ClimateInputs
from edl6dof.environment.planet import PlanetParams
from edl6dof.spatial.elementary import cos


class Place(NamedTuple):
    """A place on the ground, and a moment."""

    epoch_utc: str  # date and time; empty when it is not known
    latitude: float  # geodetic, rad
    longitude: float  # rad
    elevation: float  # m above the areoid


def climate_inputs(params: SeasonalParams, planet: PlanetParams, place: Place) -> ClimateInputs:
    """Gather the inputs of the climate of a place at a moment.

    Raises:
        Inconsistent: the planet has no climate, or the moment is missing or no date.
    """
    days, problems = 0.0, {}
    climate = planet.climate
    if climate is None:
        problems["atmosphere.model"] = (
            f"must not be 'seasonal' here: {planet.name} has no planet.climate (calendar, surface_pressure)"
        )
    try:
        days = days_since_j2000(utc(place.epoch_utc))
    except ValueError:
        problems["initial.epoch_utc"] = (
            "must be the date and time of t = 0, such as 2021-05-14T23:08:55, with atmosphere.model seasonal "
            f"(got {place.epoch_utc!r})"
        )
    if climate is None or problems:
        raise Inconsistent(problems)
    season = solar_longitude(climate.calendar, days)
    hour = local_true_solar_time(climate.calendar, days, place.longitude)
    pressure = surface_pressure(climate.surface_pressure, season, place.elevation)
    warmest = params.warmest_hour
    return ClimateInputs(
        *(planet, place.latitude, place.longitude, place.elevation, pressure, areoid_file(planet)),
        lapse_rate=params.lapse_rate_k_m,
        near_ground=params.diurnal_amplitude_k * cos(tau * (hour - warmest) / 24.0),
        depth=params.diurnal_depth_m,
    )
