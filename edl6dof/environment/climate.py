"""Climate of a planet: season and hour of a moment from the planet's mean motion, and the pressure of its air
at the ground by season and elevation.

The pressure is the mean over the day; tides move it by 1 to 5 %, dust storms by more.  UTC is taken 69.184 s
behind terrestrial time, as since 2017: a few seconds wrong before.
Source: calendar: Allison and McEwen, Planetary and Space Science 48 (2000) 215-235, as revised for Mars24
(NASA GISS, 2015).  Pressure: Withers, Space Science Reviews 170 (2012) 837-860, "Empirical estimates of
Martian surface pressure in support of the landing of Mars Science Laboratory", whose coefficients are in the
planet file.
"""

from __future__ import annotations

from datetime import UTC, datetime
from math import degrees, radians, tau

from edl6dof.config.base import REQUIRED, Params, Vec3, param, section
from edl6dof.spatial.arrays import total
from edl6dof.spatial.elementary import cos, exp, sin

_J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)  # as terrestrial time
_TERRESTRIAL_LESS_UTC = 69.184  # s
_DAY = 86400.0  # s
_JULIAN_YEAR = 365.25  # days
_HOURS_PER_DEGREE = 24.0 / 360.0


class CalendarParams(Params):
    """Motion of a planet about the sun and itself; days of 86,400 s since J2000 (terrestrial time)."""

    mean_anomaly_deg: float = param(REQUIRED, "mean anomaly at J2000", record=False)
    mean_anomaly_rate_deg_day: float = param(REQUIRED, "growth of the mean anomaly", record=False, gt=0.0)
    mean_sun_deg: float = param(REQUIRED, "right ascension of the fictitious mean sun at J2000", record=False)
    mean_sun_rate_deg_day: float = param(REQUIRED, "growth of this right ascension", record=False, gt=0.0)
    centre_deg: list[float] = param(
        REQUIRED,
        "equation of the centre: amplitudes of the sines of 1, 2, ... times the mean anomaly",
        record=False,
        min_length=1,
        max_length=10,
    )
    centre_growth_deg_day: float = param(0.0, "growth of the first amplitude of centre_deg", record=False)
    perturbations: list[Vec3] = param(
        None,
        "perturbations by other planets: amplitude (deg), period (Julian years), phase (deg) of cosines",
        record=False,
        factory=list,
        max_length=50,
    )
    obliquity_deg: list[float] = param(
        REQUIRED,
        "equation of time by the tilt of the axis: amplitudes of the sines of 2, 4, ... times the solar "
        "longitude",
        record=False,
        min_length=1,
        max_length=10,
    )
    solar_day_days: float = param(REQUIRED, "mean solar day", record=False, gt=0.0, le=1000.0)
    midnight_days: float = param(
        REQUIRED, "a mean midnight at the prime meridian, since J2000", record=False, ge=-1e5, le=1e5
    )


def utc(text: str) -> datetime:
    """Parse a date and time; without a zone it is UTC.

    Raises:
        ValueError: the text is no date and time.
    """
    moment = datetime.fromisoformat(text)
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def days_since_j2000(moment: datetime) -> float:
    """Days of terrestrial time from J2000 to a moment."""
    return ((moment - _J2000).total_seconds() + _TERRESTRIAL_LESS_UTC) / _DAY


def _equation_of_centre(calendar: CalendarParams, days: float) -> float:
    """Difference (deg) of true less mean anomaly."""
    anomaly = radians(calendar.mean_anomaly_deg + calendar.mean_anomaly_rate_deg_day * days)
    found = calendar.centre_growth_deg_day * days * sin(anomaly)
    found += total(a * sin(k * anomaly) for k, a in enumerate(calendar.centre_deg, 1))
    return found + total(
        amplitude * cos(tau * days / (_JULIAN_YEAR * period) + radians(phase))
        for amplitude, period, phase in calendar.perturbations
    )


def solar_longitude(calendar: CalendarParams, days: float) -> float:
    """Planetocentric longitude of the sun (rad, 0 .. 2 pi) ``days`` after J2000; 0 at northern spring."""
    mean_sun = calendar.mean_sun_deg + calendar.mean_sun_rate_deg_day * days
    return radians(mean_sun + _equation_of_centre(calendar, days)) % tau


def equation_of_time(calendar: CalendarParams, days: float) -> float:
    """Difference (h) of true less mean solar time, ``days`` after J2000."""
    season = solar_longitude(calendar, days)
    tilt = total(a * sin(2 * k * season) for k, a in enumerate(calendar.obliquity_deg, 1))
    return (tilt - _equation_of_centre(calendar, days)) * _HOURS_PER_DEGREE


def local_true_solar_time(calendar: CalendarParams, days: float, longitude: float) -> float:
    """Local true solar time (h, 0 .. 24) at an east longitude (rad), ``days`` after J2000."""
    prime_meridian = 24.0 * (days - calendar.midnight_days) / calendar.solar_day_days
    return (prime_meridian + degrees(longitude) * _HOURS_PER_DEGREE + equation_of_time(calendar, days)) % 24.0


class SurfacePressureParams(Params):
    """Pressure at the ground: exponential in the elevation, two harmonics of the season."""

    pressure_pa: float = param(
        REQUIRED,
        "pressure at elevation_m, mean over the year",
        record=False,
        gt=0.0,
        usual=(0.5, 1e7, "Pluto to Venus"),
    )
    elevation_m: float = param(REQUIRED, "elevation above the areoid of pressure_pa", record=False)
    scale_height_m: float = param(
        REQUIRED,
        "rise of elevation over which the pressure falls by e",
        record=False,
        gt=100.0,
        le=1e6,
        usual=(3000, 80000, "Venus to Saturn"),
    )
    season: tuple[float, float, float, float] = param(
        (0.0, 0.0, 0.0, 0.0),
        "relative change with the season: factors of sine and cosine of the solar longitude, and of twice it",
        record=False,
    )


class ClimateParams(Params):
    """Calendar and surface pressure of a planet that has seasons."""

    calendar: CalendarParams = section("season and hour of a moment", record=False)
    surface_pressure: SurfacePressureParams = section("pressure at the ground", record=False)


def surface_pressure(law: SurfacePressureParams, season: float, elevation: float) -> float:
    """Pressure (Pa) at the ground at an ``elevation`` (m) above the areoid and a solar longitude (rad)."""
    a, b, c, d = law.season
    change = a * sin(season) + b * cos(season) + c * sin(2.0 * season) + d * cos(2.0 * season)
    return law.pressure_pa * exp((law.elevation_m - elevation) / law.scale_height_m) * (1.0 + change)
