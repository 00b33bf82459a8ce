"""Coarse avoidance: the part of an image with the fewest obstacles, and a target in it away from backshell
and canopy.

Rule of Tianwen-1, claim 1 of Chinese patent CN108594802B: where the angle of the velocity to the vertical
lies within a preset range, the image is halved along the velocity, else quartered about its centre; the part
with the fewest obstacles is chosen, and the thrust turned towards it. Cells that show no ground count as
obstacles. Where no part has a target away from the drift, the plain rule of powered guidance sets the target.
The distance of the target, and the rule on the drift of backshell and canopy, are estimates.

Backshell and canopy fall, once released, as a point mass with drag through the believed air. At the height of
the release, the wind is taken from the velocity of the vehicle under its parachute over several swings, as a
single swing is metres per second off. It is unknown how much of the difference between this wind and the
expected one persists below, since a gust extends over some hundred metres: one path assumes all of it, one
half and one none. The region in which backshell and canopy are expected grows around each path with time.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.config.base import Params, param
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.interface.capacities import CAMERA_CELLS
from edl6dof.kernels import kernel
from edl6dof.records import record, whole
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, take3, take4

#: Points of the path, a second apart; steps of integration in each second.
PATH_POINTS, STEPS = 160, 10
#: Shares of the difference from the expected wind that persist, one for each path.
LASTING = (0.0, 0.5, 1.0)

#: Believed body that leaves the lander: backshell with the canopy that carries it.
DRIFTER = record(
    ("mass", "f8"),  # kg; 0: no backshell
    ("drag_area", "f8"),  # m2
    ("length", "f8"),  # m: from the backshell to the canopy above it
)

DRIFT = record(
    ("count", whole(0, PATH_POINTS)),
    ("place_L", "f8", (PATH_POINTS, 3)),  # m: east and north of the landing site; height above the ground
)


@kernel
def fall(atmosphere, drifter, gravity, altitude, shift, velocity):
    """Acceleration of the falling body (north, east, down, m/s2) at an altitude (m); ``shift``: difference
    from the expected wind, north and east (m/s); ``velocity``: north, east, down (m/s).
    """
    density, _, _ = model_atmosphere(atmosphere, altitude)
    wind_north, wind_east = expected_wind(atmosphere, altitude)
    north, east = velocity[0] - wind_north - shift[0], velocity[1] - wind_east - shift[1]
    down = velocity[2]
    speed = sqrt(north * north + east * east + down * down)
    drag = 0.5 * density * drifter.drag_area / drifter.mass * speed
    return -drag * north, -drag * east, gravity - drag * down


@kernel
def follow_wind(time_constant, nav, dt, carried):
    """Smooth the horizontal velocity of the vehicle over ``time_constant`` (s) into ``carried`` (north, east,
    m/s), an estimate of the wind.
    """
    share = min(dt / time_constant, 1.0)
    carried[0] += share * (nav.v_N[0] - carried[0])
    carried[1] += share * (nav.v_N[1] - carried[1])


@kernel
def predict_drifts(atmosphere, drifter, carried, nav, out):
    """Predict a path for each share of ``LASTING``; arguments as for :func:`predict_drift`."""
    for k in range(len(LASTING)):
        predict_drift(atmosphere, drifter, carried, lasting=LASTING[k], nav=nav, out=out[k])


@kernel
def predict_drift(atmosphere, drifter, carried, lasting, nav, out):
    """Predict the path of backshell and canopy from the state of the vehicle at their release to the ground.

    Args:
        atmosphere, drifter: believed air and wind; ``DRIFTER`` record.
        carried: smoothed velocity under the parachute, see :func:`follow_wind`.
        lasting: share of the difference of ``carried`` from the expected wind that persists.
        nav: ``NAV`` record at the release.
        out: ``DRIFT`` record, written; the last point is on the ground.
    """
    out.count = 0
    if drifter.mass <= 0.0:
        return
    wind_north, wind_east = expected_wind(atmosphere, nav.altitude)
    shift = (lasting * (carried[0] - wind_north), lasting * (carried[1] - wind_east))
    north, east, height = nav.site_L[1], nav.site_L[0], nav.height
    v_n, v_e, v_d = nav.v_N[0], nav.v_N[1], nav.v_N[2]
    step, below = 1.0 / STEPS, nav.altitude - nav.height
    for k in range(PATH_POINTS):
        out.place_L[k, 0], out.place_L[k, 1], out.place_L[k, 2] = east, north, max(height, 0.0)
        out.count = k + 1
        if height <= 0.0:
            return
        for _ in range(STEPS):
            # midpoint rule
            a = fall(atmosphere, drifter, nav.gravity, below + height, shift, velocity=(v_n, v_e, v_d))
            half = (v_n + 0.5 * step * a[0], v_e + 0.5 * step * a[1], v_d + 0.5 * step * a[2])
            middle = below + height - 0.5 * step * v_d
            a = fall(atmosphere, drifter, nav.gravity, middle, shift, velocity=half)
            north, east, height = north + step * half[0], east + step * half[1], height - step * half[2]
            v_n, v_e, v_d = v_n + step * a[0], v_e + step * a[1], v_d + step * a[2]


@kernel
def distance_from_drifts(drifts, spread, east, north):
    """Least horizontal distance (m) of a place (m east, north of the site) from discs around the points of
    the paths, whose radius is ``spread`` (m/s) times the time since the release; 1e9 without a path.
    """
    least = 1e9
    for path in range(len(LASTING)):
        place_L = drifts[path].place_L
        for k in range(1, drifts[path].count):
            e0, n0 = place_L[k - 1, 0], place_L[k - 1, 1]
            e1, n1 = place_L[k, 0] - e0, place_L[k, 1] - n0
            along = e1 * (east - e0) + n1 * (north - n0)
            share = min(max(along / max(e1 * e1 + n1 * n1, 1e-12), 0.0), 1.0)
            off_e, off_n = east - e0 - share * e1, north - n0 - share * n1
            least = min(least, sqrt(off_e * off_e + off_n * off_n) - spread * k)
    return least


#: Most parts of an image.
MAX_PARTS_OF_IMAGE = 4


class CoarseParams(Params):
    """Coarse avoidance at the start of powered descent."""

    halved_from_deg: float = param(
        3.0,
        "angle of the velocity to the vertical from which the image is divided into halves",
        status="estimate",
        ge=0.0,
        le=90.0,
    )
    halved_to_deg: float = param(
        60.0,
        "angle of the velocity to the vertical up to which the image is divided into halves",
        status="estimate",
        ge=0.0,
        le=90.0,
    )
    divert_m: float = param(170.0, "distance of the target into the chosen part", status="estimate", ge=0.0)
    lead_s: float = param(
        12.0,
        "time of drift at the present velocity that is added to the position of the target",
        status="estimate",
        ge=0.0,
        le=60.0,
    )
    keep_clear_m: float = param(
        100.0, "least distance of the target from where the backshell may be", status="estimate", ge=0.0
    )
    spread_m_s: float = param(
        3.2,
        "growth of the radius around the predicted path in which the backshell may be: 1.5 sigma",
        status="derived", source="errors of predicted paths, tools/separation.py", ge=0.0,
    )  # fmt: skip
    wind_time_s: float = param(
        10.0, "time over which drift under the canopy is taken for wind", status="estimate", gt=0.1, le=100.0
    )


COARSE = record(
    ("parts", whole(0, MAX_PARTS_OF_IMAGE)),  # number of parts of the image
    ("part", whole(0, MAX_PARTS_OF_IMAGE - 1)),  # chosen part
    ("obstacles", "f8", (MAX_PARTS_OF_IMAGE,)),  # share of obstacles and unseen cells in each part
    ("target_L", "f8", (MAX_PARTS_OF_IMAGE, 2)),  # m: east, north of the landing site, of each part
    ("clear", "f8", (MAX_PARTS_OF_IMAGE,)),  # m: distance of each target from where the backshell may be
    ("drift", DRIFT, (len(LASTING),)),
)


@kernel
def part_of(parts, along, across, y, z):
    """Part of the image with a cell at (``y``, ``z``) of B: of two parts, the side (1 or 0) of the horizontal
    velocity, whose y and z components are ``along`` and ``across``; of four, by the signs of y and z.
    """
    if parts == 2:
        return 1 if along * z - across * y > 0.0 else 0
    return (1 if y > 0.0 else 0) + (2 if z > 0.0 else 0)


@kernel
def direction_of(parts, part, along, across):
    """Unit direction in y and z of B from the centre of the image into a part."""
    side = 1.0 if part % 2 == 1 else -1.0
    if parts == 2:
        size = sqrt(along * along + across * across)
        return -side * across / size, side * along / size
    other = 1.0 if part >= 2 else -1.0
    return side * sqrt(0.5), other * sqrt(0.5)


@kernel
def count_obstacles(camera, parts, along, across, out):
    """Write the share of obstacles and unseen cells in each part of the image."""
    cells = (0.0, 0.0, 0.0, 0.0)
    for part in range(MAX_PARTS_OF_IMAGE):
        out.obstacles[part] = 0.0
    for i in range(CAMERA_CELLS):
        z = (2.0 * i + 1.0) / CAMERA_CELLS - 1.0
        for j in range(CAMERA_CELLS):
            y = (2.0 * j + 1.0) / CAMERA_CELLS - 1.0
            part = part_of(parts, along, across, y, z)
            share = camera.density[i, j] if camera.seen[i, j] != 0 else 1.0
            out.obstacles[part] += share
            cells = (
                cells[0] + (1.0 if part == 0 else 0.0),
                cells[1] + (1.0 if part == 1 else 0.0),
                cells[2] + (1.0 if part == 2 else 0.0),
                cells[3] + (1.0 if part == 3 else 0.0),
            )
    for part in range(parts):
        out.obstacles[part] /= max(cells[part], 1.0)


@kernel
def lay_targets(p, nav, along, across, out):
    """Write the target of each part: ahead with the drift, and aside into the part."""
    q = take4(nav.q_I2B)
    for part in range(out.parts):
        y, z = direction_of(out.parts, part, along, across)
        into = from_frame(q, (0.0, y, z))
        east, north = dot(into, take3(nav.east_I, 0)), dot(into, take3(nav.north_I, 0))
        size = max(sqrt(east * east + north * north), 1e-9)
        out.target_L[part, 0] = nav.site_L[0] + p.lead * nav.v_N[1] + p.divert * east / size
        out.target_L[part, 1] = nav.site_L[1] + p.lead * nav.v_N[0] + p.divert * north / size


@kernel
def choose_part(p, camera, nav, out):
    """Choose the part of fewest obstacles whose target is away from the drift. Returns True if there is one.

    Args:
        p: coarse parameters.
        camera, nav: ``CAMERA`` record with the image; ``NAV`` record at the exposure.
        out: ``COARSE`` record with the predicted drift, written.
    """
    q = take4(nav.q_I2B)
    side = sqrt(nav.v_N[0] * nav.v_N[0] + nav.v_N[1] * nav.v_N[1])
    slant = atan2(side, nav.v_N[2])
    north, east = take3(nav.north_I, 0), take3(nav.east_I, 0)
    along = nav.v_N[0] * dot(from_frame(q, (0.0, 1.0, 0.0)), north) + nav.v_N[1] * dot(
        from_frame(q, (0.0, 1.0, 0.0)), east
    )
    across = nav.v_N[0] * dot(from_frame(q, (0.0, 0.0, 1.0)), north) + nav.v_N[1] * dot(
        from_frame(q, (0.0, 0.0, 1.0)), east
    )
    out.parts = 2 if p.halved_from <= slant <= p.halved_to and along * along + across * across > 0.0 else 4
    count_obstacles(camera, out.parts, along, across, out)
    lay_targets(p, nav, along, across, out)
    found = False
    for part in range(out.parts):
        target = out.target_L[part]
        out.clear[part] = distance_from_drifts(out.drift, p.spread, target[0], target[1])
        if out.clear[part] < p.keep_clear:
            continue
        if not found or out.obstacles[part] < out.obstacles[out.part]:
            out.part, found = part, True
    return found
