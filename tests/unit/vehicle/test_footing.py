"""Planes of the ground under the points of the landing gear, and what they push with: written out with numpy,
on a rotating planet, on planes that lean otherwise under each point.
"""

import numpy as np
import pytest
from dropped_lander import LATITUDE, LONGITUDE, TO_SITE, UPRIGHT, Dropped, across, points, push
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.environment.terrain import ground
from edl6dof.scenario import records
from edl6dof.vehicle.landing_gear import contacts, ground_loads, minimum_clearance, normal_of
from edl6dof.vehicle.plant import POSITION, VELOCITY

PLACE = np.sin(LATITUDE), np.cos(LATITUDE), np.sin(LONGITUDE), np.cos(LONGITUDE)
#: Angle by which the planet has turned: from F to I.
TURNED = 0.7
ROTATION = np.cos(TURNED), np.sin(TURNED)
TO_I = Rotation.from_rotvec([0.0, 0.0, TURNED])
#: From north, east and down of the place to I.
SITE_TO_I = TO_I * Rotation.from_matrix(TO_SITE.T)
CENTRE = np.array([-0.82, 0.04, -0.02])
ALTITUDE = -4000.0


def quaternion(attitude):
    """As kernels take it, of an attitude from B to north, east and down."""
    return tuple((SITE_TO_I * attitude).as_quat(scalar_first=True))


def up_of(rise):
    """Upward normals in north, east and down of ground that rises by this towards north and east."""
    rise = np.atleast_2d(rise)
    up = np.column_stack([-rise, -np.ones(len(rise))])
    return up / np.linalg.norm(up, axis=1)[:, None]


@pytest.mark.parametrize(
    ("north", "east", "leans"),
    [
        (0.0, 0.0, (0.0, 0.0)),
        (0.3, 0.0, (-0.3, 0.0)),  # rises to the north: its normal leans to the south
        (0.0, 0.3, (0.0, -0.3)),
        (-0.2, 0.5, (0.2, -0.5)),
    ],
)
def test_normal_leans_away_from_where_the_ground_rises(north, east, leans):
    attitude = Rotation.from_rotvec([0.3, -1.1, 0.6])
    normal, cosine = normal_of(PLACE, quaternion(attitude), ROTATION, north, east)
    found = attitude.apply(normal)
    assert np.linalg.norm(found) == pytest.approx(1.0)
    assert found / -found[2] == pytest.approx([*leans, -1.0], abs=1e-12)
    assert cosine == pytest.approx(np.cos(np.arctan(np.hypot(north, east))))


class Footed:
    """The lander of Tianwen-1 over planes that lean otherwise under each point.

    Attributes:
        arms: the points from the centre of mass, B, m.
        up: normal of the plane under each, north, east, down.
        height: of each above its plane, along its normal, m.
    """

    def __init__(self, seed):
        loaded = edl6dof.load("tianwen1")
        self.case = records.build_case(loaded.truth, records.build_tables(loaded.truth))[0]
        self.plant = records.initial_plant(loaded.truth, self.case)[0]
        self.gear = loaded.scenario.vehicle.landing_gear
        rng = np.random.default_rng(seed)
        self.attitude = Rotation.from_rotvec(0.2 * rng.normal(size=3)) * UPRIGHT
        self.arms = np.array([*self.gear.footpads_m, *self.gear.underside_m]) - CENTRE
        rise = 0.3 * rng.normal(size=(len(self.arms), 2))
        below = np.max(self.attitude.apply(self.arms)[:, 2]) + rng.uniform(-0.15, 0.1, len(self.arms))
        footing = self.plant["inputs"]["footing"]
        footing[: len(self.arms)] = np.column_stack([ALTITUDE - below, rise])
        self.plant["inputs"]["ground_altitude"] = ALTITUDE - below.max()
        self.up = up_of(rise)
        self.height = np.einsum("ij,ij->i", np.array([0.0, 0.0, -1.0]) * below[:, None], self.up)
        self.height += np.einsum("ij,ij->i", self.attitude.apply(self.arms), self.up)
        self.v, self.w = rng.normal(size=3), rng.normal(size=3)

    def loads(self):
        """Force and moment about the centre of mass (B), and how many footpads touch."""
        spin = np.array([0.0, 0.0, self.case["planet"]["rotation_rate"]])
        q = quaternion(self.attitude)
        y = self.plant["y"]
        y[POSITION : POSITION + 3] = TO_I.apply(-3.39e6 * TO_SITE[2])
        y[VELOCITY : VELOCITY + 3] = np.cross(spin, y[POSITION : POSITION + 3]) + SITE_TO_I.apply(self.v)
        w = tuple(self.w + (SITE_TO_I * self.attitude).inv().apply(spin))
        place = (*PLACE, ALTITUDE, ALTITUDE)
        return ground_loads(self.case, self.plant["inputs"], y, q, w, tuple(CENTRE), ROTATION, place)


@pytest.mark.parametrize("seed", range(6))
def test_loads_are_those_of_the_springs_on_the_plane_under_each_point(seed):
    """Motion is that relative to the ground, which turns with the planet."""
    lander = Footed(seed)
    moves = lander.v + lander.attitude.apply(lander.arms @ across(lander.w).T)
    forces = lander.attitude.inv().apply(push(lander.gear, lander.up, -lander.height, moves))
    force, moment, pads = lander.loads()
    assert np.linalg.norm(forces.sum(axis=0)) > 100.0
    assert force == pytest.approx(forces.sum(axis=0), rel=1e-6, abs=1e-3)
    assert moment == pytest.approx(np.cross(lander.arms, forces).sum(axis=0), rel=1e-6, abs=1e-3)
    assert pads == np.sum(lander.height[:4] < 0.0)


def test_a_foot_pressed_on_one_side_turns_that_side_up():
    """On level ground, at rest: the rate that the moment gives lifts the foot that is pressed."""
    for foot in range(4):
        lander = Footed(0)
        lander.v, lander.w = np.zeros(3), np.zeros(3)
        lander.attitude = UPRIGHT
        arms = UPRIGHT.apply(lander.arms)
        planes = np.zeros((len(arms), 3))
        planes[:, 0] = ALTITUDE - arms[:, 2].max() - 1.0
        planes[foot, 0] = ALTITUDE - arms[foot, 2] + 0.02
        lander.plant["inputs"]["footing"][: len(arms)] = planes
        force, moment, pads = lander.loads()
        assert pads == 1 and UPRIGHT.apply(force) == pytest.approx([0.0, 0.0, -800.0], abs=1e-3)
        assert UPRIGHT.apply(np.cross(moment, lander.arms[foot]))[2] < 0.0


@pytest.mark.parametrize("seed", range(6))
def test_clearance_is_that_of_the_point_nearest_to_its_plane(seed):
    lander = Footed(seed)
    found = minimum_clearance(
        lander.case,
        lander.plant["inputs"],
        tuple(CENTRE),
        quaternion(lander.attitude),
        ROTATION,
        PLACE,
        ALTITUDE,
    )
    assert found == pytest.approx(lander.height.min(), abs=1e-8)


def test_plane_under_each_point_touches_the_ground_there():
    """At the point's own place: its height, and its rise by differences."""
    rough = tuple(
        f"terrain.landing_area.{name}={value}"
        for name, value in (("model", "generated"), ("rms_slope_deg", 15), ("rock_abundance", 0.1))
    )
    turn = Rotation.from_rotvec([0.2, -0.1, 0.4]) * UPRIGHT
    probe = Dropped(rough, np.array([7.0, -4.0, -1.0]), np.zeros(3), turn, np.zeros(3))
    case, tables = probe.case[0], probe.tables[0]

    def elevation(north, east):
        lat, lon = LATITUDE + north / 1e9, LONGITUDE + east / (1e9 * np.cos(LATITUDE))
        return ground(case["terrain"], tables["terrain"], lat, lon)[0]

    arms = turn.apply(points(probe.gear))
    above = np.array([7.0, -4.0, -1.0 - elevation(7.0, -4.0)])
    lander = Dropped(rough, above, np.zeros(3), turn, np.zeros(3))
    planes = lander.plant["inputs"]["footing"][0][: contacts(case["vehicle"]["landing_gear"])]
    assert len(planes) == len(arms) and np.ptp(planes[:, 1:], axis=0).min() > 0.05
    for (altitude, rise_north, rise_east), (north, east, _) in zip(planes, arms, strict=True):
        y, x, d = 7.0 + north, -4.0 + east, 1e-3
        here = altitude + rise_north * north + rise_east * east
        assert here == pytest.approx(elevation(y, x), abs=1e-5)
        assert rise_north == pytest.approx((elevation(y + d, x) - elevation(y - d, x)) / (2.0 * d), abs=0.01)
        assert rise_east == pytest.approx((elevation(y, x + d) - elevation(y, x - d)) / (2.0 * d), abs=0.01)
