"""Hazard detection in flight: when it asks for image and scan, what it makes of a scan shot from a moving,
tilted lander, and what it does without one.
"""

import numpy as np
import pytest
from charts import new, rocky
from given_functions import detect_hazards
from pyquaternion import Quaternion

from edl6dof.config.dtype import fill
from edl6dof.fsw.hazard.registry import HAZARD_DETECTION, HazardParams
from edl6dof.fsw.mission import G_AVOID, G_HOVER, G_POWERED
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.interface.capacities import SCAN_BLOCK, SCAN_COLUMNS, SCAN_ROWS
from edl6dof.interface.sensed import SENSED, cell_direction

TANGENT, EYE = np.tan(np.radians(14.0)), np.array([-0.5, 0.6, 0.0])
SITE = np.array([5.0, -3.0])
LEVEL = -4100.0
#: East, north, up, m.
JUMP = np.array((0.4, -0.3, 2.0))
#: North, east, down, m/s.
VELOCITY = (-0.15, 0.2, 0.1)


class Lander:
    """A lander that drifts and turns over rocky ground, at a place and attitude of its own."""

    def __init__(self, detection="lidar", stones=(), slope=0.0):
        self.onboard, self.fsw, self.sensed = new(ONBOARD), new(FSW), new(SENSED)
        fill(self.onboard["hazard"], HazardParams(detection=detection))
        self.onboard["site"]["frame"]["cos_lat"] = self.onboard["site"]["frame"]["cos_lon"] = 1.0
        self.onboard["vehicle"]["configuration"]["centre"] = (-0.9, 0.0, 0.0)
        eye = self.onboard["instruments"]["imagers"]["lidar"]
        eye["place"], eye["tangent"], eye["sigma"] = EYE, TANGENT, 0.03
        terminal = self.onboard["guidance"]["powered"]["terminal"]
        terminal["lateral_speed"], terminal["avoidance_rate"], terminal["avoidance_height"] = 2.0, 3.3, 20.0
        self.fsw["vehicle"]["mass"], self.fsw["vehicle"]["engine"]["specific_impulse"] = 900.0, 300.0
        self.stones, self.slope, self.t = np.array(stones).reshape(-1, 3), slope, 0.0
        self.place = np.array([*SITE, LEVEL + 100.0])
        self.onboard["rates"]["base"] = 50
        self.fsw["nav"]["v_N"] = VELOCITY

    def ground(self, east, north):
        """Height above the level, m."""
        near = self.stones[np.hypot(*(self.stones[:, :2] - (north.mean(), east.mean())).T) < 60.0]
        return self.slope * east + rocky(near, north, east)

    def axes(self):
        """Axes of B as rows, in east, north, up: nose down, tilted and turning a little."""
        tilt = Quaternion(axis=(0.6, 0.8, 0.0), degrees=2.0 + 1.5 * np.sin(self.t))
        turn = Quaternion(axis=(0.0, 0.0, 1.0), degrees=30.0 + 0.5 * self.t)
        upright = np.array([(0.0, 0.0, -1.0), (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0)])
        return np.array([(tilt * turn).rotate(axis) for axis in upright])

    def step(self, kind=G_HOVER, elapsed=20.0, shoot=True):
        """One cycle; returns what the eyes are told."""
        fsw, nav, axes = self.fsw, self.fsw["nav"], self.axes()
        # of the frame of a site at latitude and longitude 0: up, east, north are x, y, z of F, which is I
        in_i = axes[:, [2, 0, 1]]
        nav["q_I2B"] = Quaternion(matrix=in_i.T).elements
        # in the middle of a scan, a radar update moves the position as navigated
        jump = JUMP if self.t > 0.6 else np.zeros(3)
        nav["t"], nav["site_L"], nav["height"], nav["gravity"] = self.t, self.place + jump, 100.0, 3.72
        if shoot and fsw["hazard"]["scanning"] and fsw["landing_point"]["fine_known"] == 0:
            self.shoot(axes)
        state, point, command = fsw["vehicle"], fsw["landing_point"], fsw["command"]
        detect_hazards(self.onboard, kind, elapsed, self.sensed, nav, state, fsw["hazard"], point, command)
        self.t += 0.02
        north, east, down = VELOCITY
        self.place += 0.02 * np.array([east, north, -down])
        return int(command["camera_trigger"]), int(command["scan"])

    def shoot(self, axes):
        """The next block of rows: ray against ground by bisection."""
        lidar = self.sensed["lidar"]
        lidar["row"] = 0 if lidar["fresh"] == 0 else lidar["row"] + SCAN_BLOCK
        lidar["fresh"] = 1
        eye = self.place + (EYE - (-0.9, 0.0, 0.0)) @ axes
        cells = [(lidar["row"] + i, j) for i in range(SCAN_BLOCK) for j in range(SCAN_COLUMNS)]
        rays = np.array([cell_direction(TANGENT, SCAN_COLUMNS, i, j) for i, j in cells]) @ axes
        near, far = np.full(len(rays), 60.0), np.full(len(rays), 160.0)
        for _ in range(24):
            middle = 0.5 * (near + far)
            east, north, up = (eye + middle[:, None] * rays).T
            below = up - LEVEL < self.ground(east, north)
            near, far = np.where(below, near, middle), np.where(below, middle, far)
        lidar["range"] = near.reshape(SCAN_BLOCK, SCAN_COLUMNS)

    def scan(self):
        """Fly until the spot is chosen; returns it less the place at the beginning, east and north."""
        for _ in range(SCAN_ROWS // SCAN_BLOCK + 1):
            self.step()
        assert self.fsw["landing_point"]["fine_known"] == 1
        return self.fsw["landing_point"]["fine_L"] - SITE


def test_given_spot_asks_for_nothing_and_chooses_nothing():
    lander = Lander("given")
    for kind in (G_POWERED, G_HOVER, G_AVOID):
        assert lander.step(kind) == (0, 0)
    assert lander.fsw["landing_point"].tobytes() == bytes(lander.fsw["landing_point"].nbytes)


def test_scan_waits_for_the_hover_to_settle_but_not_for_ever():
    lander = Lander()
    lander.fsw["nav"]["v_N"] = (0.0, 0.0, 1.0)
    assert lander.step(elapsed=1.0) == (0, 0)
    assert lander.step(elapsed=8.1) == (0, 1)
    lander = Lander()
    assert lander.step(elapsed=1.0) == (0, 1)
    assert lander.step(elapsed=1.0) == (0, 0)


def test_pair_of_images_weighs_by_variance_against_a_lidar_of_at_least_a_millimetre():
    """Points of 2 mm beside a lidar without noise weigh (1/2)^2, those of 0.5 mm hardly less than its own."""
    for sigma, weight in ((2e-3, 0.25), (0.5e-3, 1.001**-2)):
        lander = Lander()
        eyes, stereo = lander.onboard["instruments"]["imagers"], lander.sensed["stereo"]
        eyes["lidar"]["sigma"] = 0.0
        eyes["stereo"]["place"], eyes["stereo"]["tangent"], eyes["stereo"]["sigma"] = EYE, TANGENT, sigma
        lander.step()
        stereo["fresh"], stereo["range"][60, 70] = 1, 100.0
        lander.step(shoot=False)
        assert lander.fsw["hazard"]["elevation_map"]["weight"].sum() == pytest.approx(weight, rel=1e-6)


def test_scan_from_a_moving_tilted_lander_is_a_map_of_the_ground():
    stones = [(SITE[1] + 4.0, SITE[0] - 3.0, 1.2), (SITE[1] - 10.0, SITE[0] + 8.0, 0.8)]
    lander = Lander(stones=stones, slope=np.tan(np.radians(4.0)))
    lander.scan()
    hazard = lander.fsw["hazard"]
    chart, known = hazard["elevation_map"], hazard["elevation_map"]["weight"] >= 1.0
    assert known.mean() > 0.6
    rows, columns = np.nonzero(known)
    east, north = chart["corner_L"][0] + (columns + 0.5) * 0.2, chart["corner_L"][1] + (rows + 0.5) * 0.2
    off = chart["mean"][known] + chart["level"] - LEVEL - lander.slope * east
    on_plain = np.min([np.hypot(north - n, east - e) - d for n, e, d in stones], axis=0) > 0.3
    # within a cell the slope alone rises by 14 mm
    assert np.abs(off[on_plain]).max() < 0.015
    for n, e, d in stones:
        assert off[np.hypot(north - n, east - e) < 0.2].max() == pytest.approx(0.5 * d, abs=0.06)
    slopes = hazard["footprint"]["slope"]
    assert np.median(slopes[slopes < 1.0]) == pytest.approx(lander.slope, abs=1e-3)


@pytest.mark.parametrize(
    "detection",
    [
        *(pytest.param(n, marks=pytest.mark.long) for n in HAZARD_DETECTION.names[1:-1]),
        HAZARD_DETECTION.names[-1],
    ],
)
def test_spot_is_clear_of_the_rocks_and_near(detection):
    rng = np.random.default_rng(3)
    stones = np.column_stack([rng.uniform(-30.0, 30.0, (60, 2)) + SITE[::-1], np.full(60, 0.7)])
    spot = Lander(detection, stones).scan()
    away = np.hypot(*(stones[:, :2] - SITE[::-1] - spot[::-1]).T)
    assert away.min() > 3.0
    assert np.hypot(*spot) < 20.0


def test_without_a_return_the_point_below_is_taken():
    lander = Lander()
    for _ in range(80):
        lander.step(shoot=False)
    assert lander.fsw["landing_point"]["fine_known"] == 0
    lander.step(G_AVOID, shoot=False)
    assert lander.fsw["landing_point"]["fine_known"] == 1
    assert tuple(lander.fsw["landing_point"]["fine_L"]) == tuple(lander.fsw["nav"]["site_L"][:2])


def test_image_is_asked_for_once_and_sets_the_coarse_point():
    lander = Lander()
    lander.onboard["instruments"]["imagers"]["camera"]["tangent"] = 0.5
    lander.fsw["nav"]["v_N"] = (0.0, 0.0, 60.0)
    assert [lander.step(G_POWERED, 0.0)[0] for _ in range(3)] == [1, 0, 0]
    camera = lander.sensed["camera"]
    camera["fresh"], camera["seen"] = 1, 1
    camera["density"][:32], camera["density"][:, :32] = 0.5, 0.5
    lander.step(G_POWERED, 0.1)
    assert lander.fsw["landing_point"]["coarse_known"] == 1
    assert lander.fsw["hazard"]["coarse"]["part"] == 3
    assert lander.fsw["hazard"]["image_t"] == pytest.approx(0.06)


def test_without_a_part_away_from_the_backshell_the_plain_rule_sets_the_target():
    lander = Lander()
    lander.onboard["instruments"]["imagers"]["camera"]["tangent"] = 0.5
    lander.onboard["hazard"]["coarse"]["keep_clear"] = 2e9
    lander.step(G_POWERED, 0.0)
    lander.sensed["camera"]["fresh"] = 1
    lander.step(G_POWERED, 0.1)
    assert lander.fsw["landing_point"]["coarse_known"] == 0
    assert lander.fsw["hazard"]["image_t"] == 0.0
