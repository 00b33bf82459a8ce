"""Coarse avoidance: Tianwen-1's rule on planted images, and the drift of backshell and canopy."""

import numpy as np
import pytest
from as_flown import as_flown
from charts import new
from scipy.integrate import solve_ivp

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.hazard import coarse_avoidance as kernels
from edl6dof.fsw.hazard.coarse_avoidance import COARSE, DRIFT, DRIFTER, CoarseParams, choose_part
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.onboard import FSW, NODES, ONBOARD
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.interface.sensed import CAMERA
from edl6dof.spatial.quaternion import from_axes

#: Kernels given the memory of hazard detection, of which they get their part.
predict_drifts = as_flown(
    kernels.predict_drifts,
    "air, drifter, nav, memory",
    "air, drifter, memory.carried_N, nav, memory.coarse.drift",
)
predict_drift = as_flown(
    kernels.predict_drift,
    "air, drifter, lasting, nav, memory",
    "air, drifter, memory.carried_N, lasting, nav, memory.coarse.drift[0]",
)
follow_wind = as_flown(kernels.follow_wind, "seconds, nav, dt, memory", "seconds, nav, dt, memory.carried_N")
distance_from_drifts = as_flown(
    kernels.distance_from_drifts, "memory, spread, east, north", "memory.coarse.drift, spread, east, north"
)
MIDDLES = (2.0 * np.arange(CAMERA_CELLS) + 1.0) / CAMERA_CELLS - 1.0
#: Of the cells, along z (rows) and y (columns) of B; as the lander hangs below, y points south and z east.
Z, Y = np.meshgrid(MIDDLES, MIDDLES, indexing="ij")


def navigated(v_N=(0.0, 0.0, 62.0), height=1200.0, place=(300.0, -200.0)):
    """Upright at the pole of a frame: nose down, y of B to the south, z of B to the east."""
    nav = new(NAV)
    nav["north_I"], nav["east_I"], nav["up_I"] = np.eye(3)
    nav["q_I2B"] = from_axes((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    nav["v_N"], nav["height"], nav["site_L"] = v_N, height, (*place, height)
    nav["altitude"], nav["gravity"] = height - 4000.0, 3.72
    return nav


def image(density, seen=None):
    camera = new(CAMERA)
    camera["density"], camera["seen"] = density, 1 if seen is None else seen
    return camera


def chosen(density, v_N, seen=None, drift=None, **values):
    params, out = new(dtype_of(CoarseParams)), new(COARSE)
    fill(params, CoarseParams(**values))
    if drift is not None:
        out["drift"][1] = drift
    nav = navigated(v_N)
    found = choose_part(params, image(density, seen), nav, out)
    return out, out["target_L"][out["part"]] - nav["site_L"][:2] if found else None


@pytest.mark.parametrize("rocky_side, target", [("east", (-170.0, 0.0)), ("west", (170.0, 0.0))])
def test_slanting_image_is_halved_along_the_velocity(rocky_side, target):
    density = np.where((Z > 0.0) == (rocky_side == "east"), 0.2, 0.1)
    out, to = chosen(density, (10.0, 0.0, 62.0))
    assert out["parts"] == 2
    np.testing.assert_allclose(to, (target[0], 120.0), atol=1e-9)
    np.testing.assert_allclose(sorted(out["obstacles"][:2]), (0.1, 0.2), atol=1e-6)


def test_halves_follow_the_velocity():
    """Flying north-east, with rocks to the south-east: the north-west half is taken."""
    density = np.where(Z - (-Y) > 0.0, 0.3, 0.0)  # east more than north
    out, to = chosen(density, (8.0, 8.0, 62.0), lead_s=0.0)
    assert out["parts"] == 2
    np.testing.assert_allclose(to, 170.0 * np.array([-np.sqrt(0.5), np.sqrt(0.5)]), atol=1e-6)


@pytest.mark.parametrize("east, north", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_steep_image_is_quartered(east, north):
    density = np.where((Z * east > 0.0) & (-Y * north > 0.0), 0.05, 0.15)
    out, to = chosen(density, (0.5, 0.2, 62.0), lead_s=0.0)
    assert out["parts"] == 4
    np.testing.assert_allclose(to, 170.0 * np.sqrt(0.5) * np.array([east, north]), atol=1e-6)


def test_what_is_not_seen_counts_as_obstacles():
    density, seen = np.where(Z > 0.0, 0.0, 0.3), np.where((Z > 0.0) & (Y < 0.2), 0, 1)
    out, to = chosen(density, (10.0, 0.0, 62.0), seen=seen)
    assert to[0] == pytest.approx(-170.0)
    assert max(out["obstacles"]) == pytest.approx(np.mean(Y[Z > 0.0] < 0.2), abs=1e-6)


def test_part_below_the_drift_is_not_taken():
    drift = new(DRIFT)
    drift["count"] = 3
    # straight into the target east of the course, which has fewer obstacles
    drift["place_L"][:3] = [(470.0, -300.0, 900.0), (470.0, -200.0, 300.0), (470.0, -80.0, 0.0)]
    density = np.where(Z > 0.0, 0.0, 0.3)
    out, to = chosen(density, (10.0, 0.0, 62.0), drift=drift)
    assert to[0] == pytest.approx(-170.0)
    out, to = chosen(density, (10.0, 0.0, 62.0), drift=drift, keep_clear_m=0.0, spread_m_s=0.0)
    assert to[0] == pytest.approx(170.0)
    out, to = chosen(density, (10.0, 0.0, 62.0), drift=drift, keep_clear_m=341.0, spread_m_s=0.0)
    assert to is None and out["clear"].max() == pytest.approx(340.0)


def test_distance_from_the_drift_is_that_of_the_nearest_path():
    memory = new(FSW["hazard"])
    drifts = memory["coarse"]["drift"]
    assert distance_from_drifts(memory, 4.0, 50.0, 30.0) == 1e9
    drifts[0]["count"] = drifts[2]["count"] = 3
    drifts[0]["place_L"][:3] = [(0.0, 0.0, 900.0), (100.0, 0.0, 300.0), (200.0, 0.0, 0.0)]
    drifts[2]["place_L"][:3] = [(0.0, 0.0, 900.0), (0.0, 50.0, 300.0), (0.0, 300.0, 0.0)]
    assert distance_from_drifts(memory, 0.0, 50.0, 30.0) == pytest.approx(30.0)
    assert distance_from_drifts(memory, 0.0, 20.0, 200.0) == pytest.approx(20.0)
    assert distance_from_drifts(memory, 0.0, 230.0, -40.0) == pytest.approx(50.0)


def test_region_of_the_backshell_grows_with_time():
    """A body that falls for 40 s without wind is up to 40 times 3 m from the place below its release."""
    memory = new(FSW["hazard"])
    drift = memory["coarse"]["drift"][0]
    drift["count"] = 41
    drift["place_L"][:41, 2] = np.linspace(1000.0, 0.0, 41)
    assert distance_from_drifts(memory, 3.0, 200.0, 0.0) == pytest.approx(200.0 - 3.0 * 40.0)


def test_lasting_gust_is_one_path_and_one_that_dies_another():
    nav, drifter, memory = navigated((9.0, 3.0, 62.0)), new(DRIFTER), new(FSW["hazard"])
    drifter["mass"], drifter["drag_area"], memory["carried_N"] = 168.0, 139.0, (9.0, 3.0)
    predict_drifts(air(), drifter, nav, memory)
    drifts = memory["coarse"]["drift"]
    ends = np.array([path["place_L"][path["count"] - 1, :2] for path in drifts])
    # of the expected wind alone, 2.4 and -4.8 m/s there, and with what the vehicle was carried by beside it
    seconds = drifts[0]["count"] - 1
    assert ends[2] - ends[0] == pytest.approx(np.array([7.8, 6.6]) * seconds, rel=0.1)
    assert ends[1] == pytest.approx(0.5 * (ends[0] + ends[2]), abs=2.0)


def air():
    """Exponential air with a wind that grows with height."""
    record = new(ONBOARD["atmosphere"])
    heights = np.linspace(-6000.0, 10000.0, NODES)
    record["bottom"], record["top"], record["spacing"] = heights[0], heights[-1], heights[1] - heights[0]
    record["ln_density"] = np.log(0.018) - (heights + 4000.0) / 11000.0
    record["wind_north"], record["wind_east"] = 2e-3 * (heights + 4000.0), -4e-3 * (heights + 4000.0)
    return record


def test_drift_is_that_of_an_integrated_fall():
    nav, drifter, memory = navigated((9.0, 3.0, 62.0)), new(DRIFTER), new(FSW["hazard"])
    drifter["mass"], drifter["drag_area"], memory["carried_N"] = 168.0, 139.0, (7.0, 2.0)
    predict_drift(air(), drifter, 1.0, nav, memory)
    out = memory["coarse"]["drift"][0]

    def slope(_, y):
        height = y[2]
        # of the expected wind, what blew at the release instead
        wind = np.array([2e-3 * height + 7.0 - 2.4, -4e-3 * height + 2.0 + 4.8, 0.0])
        v = np.array([y[3], y[4], y[5]]) - wind
        density = 0.018 * np.exp(-height / 11000.0)
        a = -0.5 * density * 139.0 / 168.0 * np.linalg.norm(v) * v + (0.0, 0.0, 3.72)
        return [y[3], y[4], -y[5], *a]

    path = out["place_L"][: out["count"]]
    flown = solve_ivp(
        slope, (0.0, len(path) - 1.0), [-200.0, 300.0, 1200.0, 9.0, 3.0, 62.0], rtol=1e-9, dense_output=True
    ).sol(np.arange(len(path) - 1))
    np.testing.assert_allclose(path[:-1, 1], flown[0], atol=0.5)
    np.testing.assert_allclose(path[:-1, 0], flown[1], atol=0.5)
    np.testing.assert_allclose(path[:-1, 2], flown[2], atol=0.5)
    terminal = np.sqrt(2.0 * 168.0 * 3.72 / (0.018 * 139.0))
    assert path[-3, 2] - path[-2, 2] == pytest.approx(terminal, rel=0.01)
    assert path[-1, 2] == 0.0


def test_wind_is_what_is_left_of_the_velocity_without_the_swings():
    memory, nav = new(FSW["hazard"]), navigated()
    for k in range(3000):
        swing = 6.0 * np.sin(2.0 * np.pi * k * 0.02 / 4.0)
        nav["v_N"] = (5.0 + swing, -3.0 - swing, 60.0)
        follow_wind(10.0, nav, 0.02, memory)
    assert memory["carried_N"] == pytest.approx((5.0, -3.0), abs=0.5)
