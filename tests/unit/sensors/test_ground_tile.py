"""Rays against a plane, a sphere, a step and rough ground."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq

from edl6dof.sensors.ray_ground import GROUND_TILE, TILE_NODES, clear_tile, trace_ray

CELL = 0.1
HALF = 0.5 * CELL * TILE_NODES
NODES = CELL * np.arange(TILE_NODES) - HALF
NORTH, EAST = np.meshgrid(NODES, NODES, indexing="ij")


def patch(heights):
    record = np.zeros(1, GROUND_TILE)[0]
    record["heights"] = heights
    record["north"] = record["east"] = -HALF
    record["cell"], record["top"] = CELL, record["heights"].max()
    return record


def rays(count, seed=3, spread=0.2, low=30.0, high=100.0):
    """Origins and unit directions of rays that fall into the patch."""
    rng = np.random.default_rng(seed)
    origins = np.column_stack([rng.uniform(-3, 3, (count, 2)), rng.uniform(low, high, count)])
    ways = np.column_stack([rng.uniform(-spread, spread, (count, 2)), -np.ones(count)])
    ways[: count // 10, 0] = ways[count // 10 : count // 5, 1] = ways[: count // 20, 1] = 0.0
    return origins, ways / np.linalg.norm(ways, axis=1, keepdims=True)


def hits(record, origins, ways, reach=1e3):
    return np.array(
        [trace_ray(record, tuple(o), tuple(w), reach) for o, w in zip(origins, ways, strict=True)]
    )


def test_plane_is_met_where_it_is_and_at_its_angle():
    normal = np.array([-0.1, 0.25, 1.0])
    origins, ways = rays(2000)
    found = hits(patch(0.1 * NORTH - 0.25 * EAST + 2.0), origins, ways)
    exact = (2.0 - origins @ normal) / (ways @ normal)
    assert np.allclose(found[:, 0], exact, rtol=0.0, atol=2e-6)  # single precision of the heights
    assert np.allclose(found[:, 1], -ways @ normal / np.linalg.norm(normal), rtol=0.0, atol=1e-5)


def test_sphere_is_met_within_the_error_of_the_lattice():
    radius = 8.0
    square = NORTH**2 + EAST**2
    origins, ways = rays(4000, spread=0.08, low=60.0)
    found = hits(patch(np.sqrt(np.maximum(radius**2 - square, 0.0))), origins, ways)[:, 0]
    along = np.sum(origins * ways, axis=1)
    inside = along**2 - (np.sum(origins**2, axis=1) - radius**2)
    exact = -along - np.sqrt(np.maximum(inside, 0.0))
    points = origins + exact[:, None] * ways
    flat = (inside > 0.0) & (np.hypot(points[:, 0], points[:, 1]) < 0.6 * radius)
    assert flat.sum() > 500
    # (cell^2 / 8) (f_xx + f_yy) in height, at 0.6 of the radius f'' <= 1 / (0.8^3 radius)
    sag = CELL**2 / 8.0 * 2.0 / (0.8**3 * radius)
    assert np.max(np.abs(found - exact)[flat]) < 1.2 * sag / np.cos(0.12)


def test_step_is_met_on_top_on_its_face_and_behind():
    record = patch(np.where(EAST >= -1e-9, 1.0, 0.0))  # the face: the cell from east -0.1 to 0
    eye = (0.03, -3.0, 11.0)
    for target, expected in (((0.03, 2.0, 1.0), None), ((0.03, -0.04, 0.6), None), ((0.03, -1.0, 0.0), None)):
        way = np.subtract(target, eye)
        length = np.linalg.norm(way)
        found = trace_ray(record, eye, tuple(way / length), 1e3)[0]
        assert found == pytest.approx(length, abs=1e-6), (target, expected)
    # from the other side the face hides the ground behind it
    eye, hidden = (0.03, 3.0, 4.0), (0.03, -0.3, 0.0)
    way = np.subtract(hidden, eye)
    length = np.linalg.norm(way)
    found = trace_ray(record, eye, tuple(way / length), 1e3)[0]
    assert found < length and eye[2] + found * way[2] / length == pytest.approx(1.0, abs=1e-6)


def test_rough_ground_is_met_first_where_a_fine_search_meets_it():
    rng = np.random.default_rng(5)
    heights = rng.uniform(0.0, 0.6, (TILE_NODES, TILE_NODES)).astype("f4")
    surface = RegularGridInterpolator((NODES, NODES), heights.astype(float))
    origins, ways = rays(150, seed=6, spread=0.5)
    found = hits(patch(heights), origins, ways)
    checked = 0
    for origin, way, (reach, _) in zip(origins, ways, found, strict=True):

        def gap(s, origin=origin, way=way):
            point = origin + np.atleast_1d(s)[:, None] * way
            return point[:, 2] - surface(point[:, :2])

        # from above the highest node down to the lowest, in steps far smaller than a cell
        steps = np.linspace((0.61 - origin[2]) / way[2], (0.0 - origin[2]) / way[2], 4000)
        if np.max(np.abs(origin[:2] + steps[-1] * way[:2])) > HALF - CELL:
            continue
        below = np.flatnonzero(gap(steps) <= 0.0)[0]
        first = brentq(lambda s: gap(s)[0], steps[below - 1], steps[below], xtol=1e-12)
        assert reach == pytest.approx(first, abs=1e-5)
        checked += 1
    assert checked > 100


def test_rays_that_leave_the_patch_look_past_the_ground_or_end_too_early_meet_nothing():
    record = patch(np.zeros_like(NORTH))
    down = (0.0, 0.0, -1.0)
    assert trace_ray(record, (0.0, 0.0, 50.0), down, 1e3) == (50.0, 1.0)
    assert trace_ray(record, (0.0, 0.0, 50.0), down, 49.9) == (0.0, 0.0)
    assert trace_ray(record, (HALF + 1.0, 0.0, 50.0), down, 1e3) == (0.0, 0.0)
    assert trace_ray(record, (0.0, 0.0, 50.0), (0.6, 0.0, -0.8), 1e3) == (0.0, 0.0)
    assert trace_ray(record, (0.0, 0.0, 50.0), (1.0, 0.0, 0.0), 1e3) == (0.0, 0.0)
    assert trace_ray(record, (0.0, 0.0, np.nan), down, 1e3) == (0.0, 0.0)
    assert trace_ray(record, (np.nan, 0.0, 50.0), down, 1e3) == (0.0, 0.0)
    clear_tile(record)
    assert trace_ray(record, (0.0, 0.0, 50.0), down, 1e3) == (0.0, 0.0)
