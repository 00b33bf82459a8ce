"""A lander on four legs, dropped in vacuum from a prescribed state onto prescribed ground, and the same drop
integrated by scipy.

The planet does not rotate and is so large that gravity is uniform within 1e-5 over the drop.  Axes of the
drop: north, east and down from the site; attitudes are from B to them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from edl6dof.scenario import records
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import ATTITUDE, OUTPUTS, POSITION, RATE, VELOCITY, WORKSPACE
from edl6dof.verify.case import BARE, FLAT, ONE_BODY, VACUUM, scenes, state_of

MASS, G = 800.0, 3.72
CENTRE = np.array([-0.85, 0.05, -0.03])
INERTIA = np.array([420.0, 350.0, 380.0])
LATITUDE, LONGITUDE = np.radians([20.0, 30.0])
SCENE = (
    *BARE,
    *VACUUM,
    *FLAT,
    *ONE_BODY,
    "planet.mean_radius_m=1e9",
    "terrain.model=plane",
    "terrain.site_elevation_m=0",
    "terrain.site_latitude_deg=20",
    "terrain.site_longitude_deg=30",
    "initial.latitude_deg=20",
    "initial.longitude_deg=30",
    "initial.altitude_m=100",
    "initial.speed_m_s=0",
    f"vehicle.mass.entry_kg={MASS}",
    f"vehicle.mass.entry_centre_m={CENTRE.tolist()}",
    f"vehicle.mass.entry_inertia_kg_m2={INERTIA.tolist()}",
    "vehicle.mass.entry_products_kg_m2=[0, 0, 0]",
)
#: Tilt of the lander (rad) beyond which a flight has tipped over.
TIPPED = 0.8
#: From F to the axes of the drop.
TO_SITE = np.array(
    [
        [-np.sin(LATITUDE) * np.cos(LONGITUDE), -np.sin(LATITUDE) * np.sin(LONGITUDE), np.cos(LATITUDE)],
        [-np.sin(LONGITUDE), np.cos(LONGITUDE), 0.0],
        [-np.cos(LATITUDE) * np.cos(LONGITUDE), -np.cos(LATITUDE) * np.sin(LONGITUDE), -np.sin(LATITUDE)],
    ]
)
#: Upright: x of B points down, y of B to the east, z of B to the south.
UPRIGHT = Rotation.from_matrix(np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))


def sloping(degrees, azimuth_deg=0.0):
    """Overrides of ground that falls in a direction."""
    return f"terrain.slope_deg={degrees}", f"terrain.slope_azimuth_deg={azimuth_deg}"


def normal(degrees, azimuth_deg=0.0):
    """Outward normal of that ground."""
    slope, azimuth = np.radians([degrees, azimuth_deg])
    return np.array([np.sin(slope) * np.cos(azimuth), np.sin(slope) * np.sin(azimuth), -np.cos(slope)])


@cache
def built(overrides):
    """Truth and tables of the scene with overrides, and the plant before it is put anywhere; for reading."""
    _, loaded = scenes([*SCENE, *overrides])
    tables = records.build_tables(loaded.truth)
    return loaded, records.build_case(loaded.truth, tables), tables, state_of(loaded).plant


class Dropped:
    """The lander as it flies.

    Args:
        overrides: of the ground.
        r: centre of mass in the axes of the drop, m.
        v: its velocity, m/s.
        attitude: from B to the axes of the drop.
        w: body rate, rad/s.
    """

    def __init__(self, overrides, r, v, attitude, w):
        self.loaded, self.case, self.tables, plant = built(tuple(overrides))
        self.plant, self.outputs = plant.copy(), np.zeros(1, OUTPUTS)
        self.gear = self.loaded.scenario.vehicle.landing_gear
        self.plant["legs"] = 1
        self.peak = 0.0
        y = self.plant["y"][0]
        y[POSITION : POSITION + 3] = self.site + TO_SITE.T @ r
        y[VELOCITY : VELOCITY + 3] = TO_SITE.T @ v
        y[ATTITUDE : ATTITUDE + 4] = (Rotation.from_matrix(TO_SITE.T) * attitude).as_quat(scalar_first=True)
        y[RATE : RATE + 3] = w
        self._flown = (
            *(one[0] for one in (self.case, self.tables, self.plant, self.outputs)),
            np.zeros(1, WORKSPACE)[0],
        )
        evaluate(*self._flown)

    @property
    def site(self):
        """The site in F, m."""
        return -1e9 * TO_SITE[2]

    def to(self, t):
        """Fly on to ``t`` (s) and keep the largest tilt (rad) on the way; returns itself."""
        while self.plant["t"][0] < t - 1e-12:
            assert advance(*self._flown, min(self.plant["t"][0] + 0.02, t))
            self.peak = max(self.peak, self.tilt())
        return self

    def state(self):
        """Position, velocity, attitude and body rate, in the axes of the drop."""
        y = self.plant["y"][0]
        attitude = Rotation.from_quat(y[ATTITUDE : ATTITUDE + 4], scalar_first=True)
        r, v = (
            TO_SITE @ part for part in (y[POSITION : POSITION + 3] - self.site, y[VELOCITY : VELOCITY + 3])
        )
        return r, v, Rotation.from_matrix(TO_SITE) * attitude, y[RATE : RATE + 3].copy()

    def tilt(self):
        """Angle (rad) between -x of B and up."""
        axis = TO_SITE[2] @ matrix(self.plant["y"][0, ATTITUDE : ATTITUDE + 4])[:, 0]
        return np.arccos(np.clip(axis, -1.0, 1.0))


def points(gear):
    """Footpads and points of the underside from the centre of mass, B, m."""
    return np.array([*gear.footpads_m, *gear.underside_m]) - CENTRE


def lowest(gear, attitude, up):
    """How far the lowest point reaches below the centre of mass, along a normal, m."""
    return -np.min(attitude.apply(points(gear)) @ up)


def push(gear, up, depth, moves):
    """Force of the ground on points of the lander, shape (points, 3); the rules of the legs written out.

    Args:
        gear: landing-gear parameters.
        up: outward normal of the ground under each point, shape (points, 3).
        depth: how far each is below the ground, m, shape (points,).
        moves: velocity of each, m/s, shape (points, 3).
    """
    climb = np.einsum("ij,ij->i", moves, up)
    normal = np.maximum(gear.stiffness_n_m * depth - gear.damping_n_s_m * climb, 0.0) * (depth > 0.0)
    slip = moves - climb[:, None] * up
    smooth = np.sqrt(np.einsum("ij,ij->i", slip, slip) + gear.slip_speed_m_s**2)
    return normal[:, None] * up - (gear.friction * normal / smooth)[:, None] * slip


def matrix(q):
    """Rotation matrix of a quaternion (w, x, y, z) of any length."""
    w, x, y, z = q / np.sqrt(q @ q)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def across(w):
    """Matrix of the cross product with a vector."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def rewritten(gear, up, start, times):
    """The drop onto a plane through the site, integrated by scipy: states (position, velocity, attitude, body
    rate) at times, s.
    """
    r, v, attitude, w = start
    arms = points(gear)
    ups = np.tile(up, (len(arms), 1))

    def motion(t, y):
        q, w = y[6:10], y[10:]
        turn, spin = matrix(q), across(w)
        depth = -(y[:3] + arms @ turn.T) @ up
        acceleration, turning = np.array([0.0, 0.0, G]), -spin @ (INERTIA * w)
        if depth.max() > 0.0:
            forces = push(gear, ups, depth, y[3:6] + arms @ spin.T @ turn.T)
            acceleration += forces.sum(axis=0) / MASS
            turning += np.cross(arms, forces @ turn).sum(axis=0)
        rate = 0.5 * np.concatenate([[-w @ q[1:]], q[0] * w - spin @ q[1:]])
        return np.concatenate([y[3:6], acceleration, rate, turning / INERTIA])

    begin = np.concatenate([r, v, attitude.as_quat(scalar_first=True), w])
    path = solve_ivp(motion, (0.0, times[-1]), begin, "DOP853", times, rtol=1e-8, atol=1e-9, max_step=0.02)
    return [(y[:3], y[3:6], Rotation.from_quat(y[6:10], scalar_first=True), y[10:]) for y in path.y.T]
