"""Where a planet's pole and prime meridian point in the International Celestial Reference Frame.

Source: Archinal et al. 2011, Report of the IAU Working Group on Cartographic Coordinates and Rotational
Elements: 2009.
"""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from edl6dof.environment.planet import OrientationParams

CENTURY_D = 36525.0
J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
TT_MINUS_TAI_S = 32.184

#: First day of each new TAI - UTC, s (IERS Bulletin C); before the first, leap seconds are not kept here.
LEAP_SECONDS: tuple[tuple[datetime, int], ...] = tuple(
    (datetime(year, month, 1, tzinfo=UTC), seconds)
    for seconds, (year, month) in enumerate(
        (
            (1972, 1), (1972, 7), (1973, 1), (1974, 1), (1975, 1), (1976, 1), (1977, 1), (1978, 1), (1979,
            1), (1980, 1), (1981, 7),
            (1982, 7), (1983, 7), (1985, 7), (1988, 1), (1990, 1), (1991, 1), (1992, 7), (1993, 7), (1994,
            7), (1996, 1), (1997, 7),
            (1999, 1), (2006, 1), (2009, 1), (2012, 7), (2015, 7), (2017, 1),
        ),
        start=10,
    )
)  # fmt: skip


def days_since_j2000(utc: datetime) -> float:
    """Days of dynamical time since J2000 (2000-01-01 12:00 TDB); TDB is taken as TT, which differs by 2 ms at
    most.

    Raises:
        ValueError: the date lies before leap seconds.
    """
    steps = [seconds for first, seconds in LEAP_SECONDS if first <= utc]
    if not steps:
        raise ValueError(f"{utc.isoformat()} lies before 1972, when leap seconds begin")
    return ((utc - J2000).total_seconds() + steps[-1] + TT_MINUS_TAI_S) / 86400.0


def icrf_to_fixed(orientation: OrientationParams, utc: datetime) -> np.ndarray:
    """Matrix, shape (3, 3), that turns ICRF components into those of the planet-fixed frame at a date.

    Raises:
        ValueError: the date lies before leap seconds.
    """
    o, days = orientation, days_since_j2000(utc)
    centuries = days / CENTURY_D
    ascension = np.radians(o.pole_ra_deg + o.pole_ra_rate_deg_century * centuries)
    declination = np.radians(o.pole_dec_deg + o.pole_dec_rate_deg_century * centuries)
    spin = np.radians(o.prime_meridian_deg + o.prime_meridian_rate_deg_day * days)
    return _about_z(spin) @ _about_x(0.5 * np.pi - declination) @ _about_z(0.5 * np.pi + ascension)


def _about_z(angle: float) -> np.ndarray:
    """Components in axes turned by ``angle`` (rad) about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _about_x(angle: float) -> np.ndarray:
    """Components in axes turned by ``angle`` (rad) about x."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
