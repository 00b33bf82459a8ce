"""Rows of studies: draws that do not depend on the number of runs; quantiles between their bounds, and none
that the flights cannot bound.
"""

from math import inf, isnan, nan

import numpy as np
import pytest

from edl6dof.studies.frame import Finding
from edl6dof.studies.samples import Spread, draw, quantile_grid, with_quantile

FAR = Finding("miss", "km", nan, 150.0, "<=", note="of all")


def test_every_quantile_stands_between_its_bounds_and_the_refused_ones_are_named():
    values = np.arange(1.0, 101.0)
    grid = quantile_grid("miss", "law", {"etpc": values, "npc": np.where(values > 90.0, inf, values)})
    assert grid.heads == ("law", "n", "50 %", "50 % from", "50 % to", "95 %", "95 % from", "95 % to")
    assert grid.title == "miss, bounds at 95 %; n = 100 too small: 99 % needs 368"
    name, flights, middle, low, high, *tail = grid.rows[0]
    assert (name, flights, tail) == ("etpc", 100.0, [96.0, 90.0, 100.0]) and low < middle < high
    assert grid.rows[1][5:] == (inf, 90.0, inf)


def test_a_sample_with_too_few_flights_has_no_numbers_beside_one_that_has_enough():
    grid = quantile_grid(
        "miss", "way", {"lidar": np.arange(80.0), "camera": np.append([1.0], np.full(79, nan))}
    )
    assert all(map(isnan, grid.rows[1][2:])) and not any(map(isnan, grid.rows[0][1:]))
    assert quantile_grid("miss", "way", {"lidar": np.arange(3.0)}).rows == (("lidar", 3.0),)


def test_a_finding_gets_its_bounds_or_neither_number_nor_result():
    told = with_quantile(FAR, np.arange(1.0, 201.0), 0.95)
    assert (told.computed, told.holds, told.note) == (191.0, False, "of all, 184 .. 197 at 95 %")
    refused = with_quantile(FAR, np.arange(1.0, 201.0), 0.99)
    assert isnan(refused.computed) and refused.holds is None and refused.ok
    assert refused.note == "of all, n = 200 too small: needs 368"


def test_draws_have_the_wanted_spread_and_a_longer_series_begins_like_a_shorter_one():
    spreads = (Spread("a.b", 10.0, 3.0), Spread("c", -1.0, 0.0))
    many = draw(spreads, 4000, 1)
    assert draw(spreads, 3, 1) == many[:3]
    first = np.array([row["a.b"] for row in many])
    assert (first.mean(), first.std()) == (pytest.approx(10.0, abs=0.05), pytest.approx(1.0, abs=0.04))
    assert {row["c"] for row in many} == {-1.0}
