"""Wind: the table against its file, the simple models, the discrete gust and the statistics of the random
gust.
"""

from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

import edl6dof
from edl6dof.environment.atmosphere import AtmosphereParams, air_inputs
from edl6dof.environment.atmosphere_table import build_table
from edl6dof.environment.wind import (
    WIND,
    GustParams,
    WindParams,
    fill_wind,
    gust_altitudes,
    gust_coordinate,
    wind,
)

DATA = Path(edl6dof.__file__).parent / "data" / "atmosphere"


def shared(**given) -> np.void:
    scenario = edl6dof.load("tianwen1").scenario
    params = AtmosphereParams(**{"table": scenario.atmosphere.table, **given})
    return build_table(air_inputs(params, scenario.planet))[0]


def build(seed: int = 0, case: int = 0, **given) -> np.void:
    record = np.zeros(1, WIND)[0]
    fill_wind(record, WindParams(**given), shared(), seed, case)
    return record


def test_table_reproduces_its_file_and_holds_its_ends():
    w, table = build(scale=2.0), shared()
    rows = np.genfromtxt(DATA / "marsgram2010_jezero_feb2021_winds.csv", delimiter=",", skip_header=1)
    for h, _, _, east, north, _ in rows:
        assert wind(w, table, h * 1e3) == pytest.approx((2 * east, 2 * north, 0.0), rel=1e-12, abs=1e-9)
    assert wind(w, table, -4000.0) == pytest.approx(wind(w, table, 0.0), rel=1e-12)
    assert wind(w, table, 300e3) == pytest.approx(wind(w, table, 200e3), rel=1e-12)


def test_table_is_smooth():
    w, table = build(), shared()
    for node in np.arange(-500.0, 60e3, 500.0):
        east = [wind(w, table, node + k * 1e-2)[0] for k in (-2, -1, 1, 2)]
        assert (east[1] - east[0]) / 1e-2 == pytest.approx((east[3] - east[2]) / 1e-2, abs=1e-5)


def test_constant_shear_none():
    table = shared()
    foot = 0.3048
    assert wind(build(model="constant", constant={"east_m_s": 20 * foot, "north_m_s": -1.0}), table, 5e3) == (
        20 * foot,
        -1.0,
        0.0,
    )
    # NESC check case 8: wind of 0.003 h - 20 ft/s.
    shear = build(model="shear", shear={"east_m_s": -20 * foot, "east_shear": 0.003})
    assert wind(shear, table, 30000 * foot)[0] == pytest.approx(70 * foot, rel=1e-12)
    both = build(model="shear", shear={"north_m_s": 4.0, "north_shear": -0.002, "east_shear": 0.001})
    assert wind(both, table, 5000.0)[:2] == pytest.approx((5.0, -6.0), rel=1e-12)
    assert wind(build(model="none"), table, 5e3) == (0.0, 0.0, 0.0)


def test_discrete_gust_is_one_minus_cosine():
    gust = {
        "enabled": True,
        "amplitude_m_s": 20.0,
        "altitude_m": 5e3,
        "half_length_m": 150.0,
        "azimuth_deg": 90.0,
    }
    w, table = build(model="none", discrete_gust=gust), shared()
    assert wind(w, table, 5e3) == pytest.approx((20.0, 0.0, 0.0), abs=1e-12)
    assert wind(w, table, 5075.0)[0] == pytest.approx(10.0, rel=1e-12)
    assert wind(w, table, 5150.0) == wind(w, table, 4850.0) == (0.0, 0.0, 0.0)
    slope = (wind(w, table, 5075.0 + 0.1)[0] - wind(w, table, 5075.0 - 0.1)[0]) / 0.2
    assert slope == pytest.approx(-0.5 * 20 * pi / 150, rel=1e-5)


#: Bottom (m), scale length (m) and its growth, as by default.
SCALES = (-8000.0, 300.0, 0.085)


def test_gust_coordinate_counts_scale_lengths():
    for h in (-3000.0, 500.0, 20e3):
        rate = (gust_coordinate(h + 1.0, *SCALES) - gust_coordinate(h - 1.0, *SCALES)) / 2.0
        assert 1.0 / rate == pytest.approx(300.0 + 0.085 * max(h, 0.0), rel=1e-5)
    rows = gust_altitudes(GustParams())
    again = [gust_coordinate(h, *SCALES) for h in rows]
    assert np.allclose(again, np.linspace(0.0, again[-1], len(rows)), atol=1e-9)
    assert np.diff(again)[0] < 0.2  # at least five rows per scale length


def test_disabled_gust_is_zero_and_bit_identical():
    table = shared()
    w = build(9, 9)
    assert not any(np.any(w[name]) for name in ("gust_east", "gust_north", "gust_up"))
    assert wind(w, table, 3210.0) == wind(build(), table, 3210.0)


def test_gust_statistics_and_determinism():
    """Sigma at 0, 10 and 20 km, correlation 1/e over one scale length near the ground, independent
    components.
    """
    table = shared()
    params = WindParams(model="none", gust={"enabled": True})
    w = np.zeros(1, WIND)[0]
    count = 1500
    heights = (0.0, -300.0, 10e3, 20e3)
    seen = np.empty((count, 4, 3))
    for case in range(count):
        fill_wind(w, params, table, 11, case)
        seen[case] = [wind(w, table, h) for h in heights]
    tolerance = 4 / sqrt(2 * count) + 0.04  # between rows the cubic loses up to 4 % of the sigma
    assert seen[:, (0, 2, 3), 0].std(axis=0) == pytest.approx((3.0, 5.5, 8.0), rel=tolerance)
    assert seen[:, (0, 2, 3), 1].std(axis=0) == pytest.approx((3.0, 5.5, 8.0), rel=tolerance)
    assert seen[:, (0, 2, 3), 2].std(axis=0) == pytest.approx((1.5, 2.75, 4.0), rel=tolerance)
    assert np.corrcoef(seen[:, 0, 0], seen[:, 1, 0])[0, 1] == pytest.approx(
        exp(-1.0), abs=4 * 0.87 / sqrt(count) + 0.03
    )
    assert abs(np.corrcoef(seen[:, 0, 0], seen[:, 0, 1])[0, 1]) < 4 / sqrt(count)
    again = build(11, count - 1, model="none", gust={"enabled": True})
    assert again["gust_up"].tobytes() == w["gust_up"].tobytes()


def test_gust_outside_its_rows_holds_and_nan_does_not_crash():
    w, table = build(1, 1, model="none", gust={"enabled": True}), shared()
    assert wind(w, table, 500e3) == pytest.approx(wind(w, table, 200e3), rel=1e-9)
    assert wind(w, table, -9e3) == wind(w, table, -8e3)
    assert len(wind(w, table, np.nan)) == 3


def test_gust_fills_the_air_of_a_planet_whose_air_reaches_higher():
    """Titan's: the gust still changes over a scale length at 600 km, where the usual one holds its end."""
    high = build(1, 1, model="none", gust={"enabled": True, "top_m": 1.3e6})
    usual, table = build(1, 1, model="none", gust={"enabled": True}), shared()
    changes = [abs(wind(w, table, 650e3)[0] - wind(w, table, 550e3)[0]) for w in (high, usual)]
    assert changes[0] > 0.1 and changes[1] == 0.0


def test_wrong_inputs_are_refused():
    with pytest.raises(ValueError, match="no winds"):
        fill_wind(np.zeros(1, WIND)[0], WindParams(), shared(model="us76", table=""))
    with pytest.raises(ValidationError, match="rise"):
        GustParams(altitudes_m=(0.0, 5.0, 4.0))
