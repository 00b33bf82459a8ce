"""Season and hour against printed values."""

from datetime import UTC, datetime, timedelta
from math import degrees, pi, radians

import pytest

import edl6dof
from edl6dof.environment.climate import (
    days_since_j2000,
    equation_of_time,
    local_true_solar_time,
    solar_longitude,
    utc,
)

CALENDAR = edl6dof.load("tianwen1").scenario.planet.climate.calendar


def test_the_printed_example_to_its_last_digits():
    """Mars24, worked example A; its UTC is 5 s further behind terrestrial time than that of today."""
    days = days_since_j2000(utc("2000-01-06T00:00:00") - timedelta(seconds=5.0))
    assert degrees(solar_longitude(CALENDAR, days)) == pytest.approx(277.18758, abs=2e-5)
    assert 15.0 * equation_of_time(CALENDAR, days) == pytest.approx(-5.18774, abs=2e-5)
    assert local_true_solar_time(CALENDAR, days, 0.0) == pytest.approx(23 + 38 / 60 + 54 / 3600, abs=3e-4)


#: UTC, east longitude, solar longitude and local true solar time (both deg and h, printed).
LANDINGS = {
    "Spirit, Mars24 example B": ("2004-01-03T13:46:31", 175.298, 327.32416, 0.0),
    "Phoenix": ("2008-05-25T23:38:00", 234.25, 76.7, 16.55),
    "MSL": ("2012-08-06T05:17:57", 137.44, 150.7, 15.6),
}


@pytest.mark.parametrize("name", LANDINGS)
def test_landings(name):
    moment, longitude, season, hour = LANDINGS[name]
    days = days_since_j2000(utc(moment))
    assert degrees(solar_longitude(CALENDAR, days)) == pytest.approx(season, abs=0.05)
    assert local_true_solar_time(CALENDAR, days, radians(longitude)) == pytest.approx(hour, abs=0.06)


def test_a_year_a_day_and_a_turn_come_round():
    start = days_since_j2000(datetime(2021, 5, 14, tzinfo=UTC))
    year = solar_longitude(CALENDAR, start + 686.9726)
    assert year == pytest.approx(solar_longitude(CALENDAR, start), abs=1e-3)
    here = local_true_solar_time(CALENDAR, start, 1.0)
    assert local_true_solar_time(CALENDAR, start, 1.0 - 2.0 * pi) == pytest.approx(here, abs=1e-9)
    later = local_true_solar_time(CALENDAR, start + CALENDAR.solar_day_days / 4.0, 1.0)
    assert (later - here) % 24.0 == pytest.approx(6.0, abs=0.01)
    assert local_true_solar_time(CALENDAR, start, 1.0 + pi / 2) == pytest.approx((here + 6.0) % 24.0)


def test_zones_of_a_date():
    assert utc("2021-05-14T23:08:55") == utc("2021-05-15T07:08:55+08:00") == utc("2021-05-14T23:08:55Z")
    with pytest.raises(ValueError):
        utc("landing day")
