"""A vehicle over the landing area, for eyes: where it is put, and what lies along a look, by way of the
planet-fixed frame.
"""

import numpy as np
from instrument_bench import Bench

import edl6dof
from edl6dof.environment.areoid import areoid_file, areoid_map, lay_areoid
from edl6dof.environment.terrain import geodetic_of, ground
from edl6dof.interface.sensed import cell_direction
from edl6dof.sensors.ray_ground import height_over_ground, point_motion
from edl6dof.spatial.frames import from_geodetic, ned_to_fixed
from edl6dof.spatial.quaternion import from_axes, from_euler_321, from_frame, multiply
from edl6dof.vehicle.mass import CONFIG_LANDER
from edl6dof.vehicle.plant import ATTITUDE


def area(model="mola", **settings):
    """Tianwen-1 over a generated landing area."""
    chosen = {"model": "generated", "rock_abundance": 0.1, **settings}
    overrides = [f"terrain.landing_area.{key}={value}" for key, value in chosen.items()]
    return edl6dof.load("tianwen1", [f"terrain.model={model}", *overrides])


def bare(slope_deg=0.0):
    """Tianwen-1 over a plane."""
    return edl6dof.load("tianwen1", ["terrain.model=plane", f"terrain.slope_deg={slope_deg}"])


class Hovering(Bench):
    """A bench for an eye, ``height`` m above a place north and east of the site.

    ``turns`` (deg) about z, y, x of the body that looks down with y to the east; ``v_ned`` (m/s) over the
    ground, ``w`` (rad/s) of the body.
    """

    def __init__(self, name, loaded, params=None, height=100.0, place=(0.0, 0.0), turns=(0.0, 0.0, 0.0),
                 v_ned=(0.0, 0.0, 0.0), w=(0.0, 0.0, 0.0), seed=1):  # fmt: skip
        super().__init__(name, params, seed=seed, loaded=loaded)
        planet, terrain = self.case["planet"], self.case["terrain"]
        shape = float(planet["equatorial_radius"]), float(planet["flattening"])
        lat, lon = geodetic_of(terrain, *map(float, place))
        corners = (np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon))
        areoid = self.plant["inputs"]["areoid"]
        lay_areoid(areoid_map(areoid_file(loaded.scenario.planet)), corners, lat, lon,
                   from_geodetic(*shape, lat, lon, 0.0), areoid)  # fmt: skip
        elevation = ground(terrain, self.tables["terrain"], lat, lon)[0]
        at_areoid = float(areoid[:3] @ from_geodetic(*shape, lat, lon, 0.0) + areoid[3])
        r = np.array(from_geodetic(*shape, lat, lon, at_areoid + elevation + height))
        down, east = (np.array(ned_to_fixed(*corners, axis)) for axis in ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
        upright = from_axes(tuple(down), tuple(east), tuple(np.cross(down, east)))
        q = multiply(upright, from_euler_321(*np.radians(turns)))
        spin = float(planet["rotation_rate"])
        v = np.array(ned_to_fixed(*corners, v_ned)) + spin * np.array([-r[1], r[0], 0.0])
        self.put(t=0.0, r=r, v=v, q=np.array(q), w=w)
        self.plant["shape"] = CONFIG_LANDER
        self.plant["imagers"]["scan"] = self.plant["imagers"]["camera_trigger"] = 1

    def scan(self):
        """All ranges of a lidar's scan, from where the vehicle is."""
        rows = []
        for k in range(64):
            self.plant["imagers"]["scan"] = 1 if k == 0 else 0
            rows.append(self.measure()["lidar"]["range"].copy())
        return np.vstack(rows)

    def eye(self):
        """Place of the eye in F, which coincides with I at t = 0."""
        place = tuple(map(float, self.params["position"]))
        return np.array(point_motion(self.case, self.plant, self.outputs, place, (1.0, 0.0))[0])

    def looks(self, cells):
        """Direction in F of every cell, shape (cells, cells, 3)."""
        q = tuple(self.plant["y"][ATTITUDE : ATTITUDE + 4])
        tangent = float(np.tan(0.5 * self.params["field_of_view"]))
        rows = [
            [from_frame(q, cell_direction(tangent, cells, i, j)) for j in range(cells)] for i in range(cells)
        ]
        return np.array(rows)

    def clearance(self, point_F):
        """Height of a point above the ground below it, m."""
        areoid = self.plant["inputs"]["areoid"]
        return height_over_ground(self.case, self.tables, areoid, tuple(map(float, point_F)))[0]
