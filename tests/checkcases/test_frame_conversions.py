"""The check case ``frames`` passes, and fails for each of these planted errors:

* latitude taken as geocentric (the vertical points to the centre),
* sideslip with the wrong sign in the attitude,
* great-circle azimuth counted from east.
"""

from __future__ import annotations

from math import hypot, pi

import pytest

from edl6dof.spatial import frames as kernels
from edl6dof.verify.cases import frames

geodetic, attitude, great_circle = kernels.geodetic, kernels.attitude_from_wind_angles, kernels.great_circle


def geocentric(radius, flattening, r):
    _, _, sin_lon, cos_lon, altitude = geodetic(radius, flattening, r)
    length = hypot(*r)
    return r[2] / length, hypot(r[0], r[1]) / length, sin_lon, cos_lon, altitude


def from_east(*points):
    arc, azimuth = great_circle(*points)
    return arc, 0.5 * pi - azimuth


def test_passes():
    assert frames.run().passed


@pytest.mark.parametrize(
    ("kernel", "wrong", "quantity"),
    [
        ("geodetic", geocentric, "latitude, longitude"),
        pytest.param(
            "attitude_from_wind_angles",
            lambda v, up, bank, alpha, beta: attitude(v, up, bank, alpha, -beta),
            "attitude from wind angles",
            marks=pytest.mark.long,
        ),
        pytest.param("great_circle", from_east, "great-circle azimuth", marks=pytest.mark.long),
    ],
)
def test_planted_error_is_caught(monkeypatch, kernel, wrong, quantity):
    monkeypatch.setattr(kernels, kernel, wrong)
    assert [result.quantity for result in frames.run().results if not result.passed] == [quantity]
