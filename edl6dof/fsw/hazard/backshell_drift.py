"""Drift of backshell and canopy once they are released: the path that the lander has to stay away from.

They fall as a point mass with drag through the believed air.  At the height of the release, the wind is taken
from the velocity of the vehicle under its parachute over several swings, as one alone is metres per second
off.  It is unknown how much of its difference from the expected wind lasts farther down, since a gust dies in
some hundred metres: there is a path for all of it, one for half and one for none.
"""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import record, whole

#: Points of the path, a second apart; steps of integration in each second.
PATH_POINTS, STEPS = 160, 10
#: Shares of the difference from the expected wind that last, each with a path of its own.
LASTING = (0.0, 0.5, 1.0)

#: Believed body that leaves the lander: backshell with the canopy that carries it.
DRIFTER = record(
    ("mass", "f8"),  # kg; 0: nothing leaves it
    ("drag_area", "f8"),  # m2
    ("length", "f8"),  # m: from the backshell to the canopy above it
)

DRIFT = record(
    ("count", whole(0, PATH_POINTS)),
    ("place_L", "f8", (PATH_POINTS, 3)),  # m: east and north of the landing site; height above the ground
)


@kernel
def fall(atmosphere, drifter, gravity, altitude, shift, velocity):
    """Acceleration (north, east, down, m/s2) at an altitude (m); ``shift``: of the wind that is expected."""
    density, _, _ = model_atmosphere(atmosphere, altitude)
    wind_north, wind_east = expected_wind(atmosphere, altitude)
    north, east = velocity[0] - wind_north - shift[0], velocity[1] - wind_east - shift[1]
    down = velocity[2]
    speed = sqrt(north * north + east * east + down * down)
    drag = 0.5 * density * drifter.drag_area / drifter.mass * speed
    return -drag * north, -drag * east, gravity - drag * down


@kernel
def follow_wind(time_constant, nav, dt, carried):
    """Bring the velocity that the vehicle is carried with, north and east (m/s), ``dt`` (s) ahead: smoothed
    over ``time_constant`` (s).
    """
    share = min(dt / time_constant, 1.0)
    carried[0] += share * (nav.v_N[0] - carried[0])
    carried[1] += share * (nav.v_N[1] - carried[1])


@kernel
def predict_drifts(atmosphere, drifter, carried, nav, out):
    """A path for each share of ``LASTING``, into the ``DRIFT`` records ``out``; arguments as of
    :func:`predict_drift`.
    """
    for k in range(len(LASTING)):
        predict_drift(atmosphere, drifter, carried, lasting=LASTING[k], nav=nav, out=out[k])


@kernel
def predict_drift(atmosphere, drifter, carried, lasting, nav, out):
    """Fly backshell and canopy from the state of the vehicle to the ground.

    Args:
        atmosphere: believed air and wind.
        drifter: ``DRIFTER`` record.
        carried: velocity that the vehicle was carried with, see :func:`follow_wind`.
        lasting: share of its difference from the expected wind that lasts.
        nav: ``NAV`` record at their release.
        out: ``DRIFT`` record, written; the last point is where they come to the ground.
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
            a = fall(
                atmosphere,
                drifter,
                nav.gravity,
                altitude=below + height,
                shift=shift,
                velocity=(v_n, v_e, v_d),
            )
            half = (v_n + 0.5 * step * a[0], v_e + 0.5 * step * a[1], v_d + 0.5 * step * a[2])
            a = fall(
                atmosphere,
                drifter,
                nav.gravity,
                altitude=below + height - 0.5 * step * v_d,
                shift=shift,
                velocity=half,
            )
            north, east, height = north + step * half[0], east + step * half[1], height - step * half[2]
            v_n, v_e, v_d = v_n + step * a[0], v_e + step * a[1], v_d + step * a[2]


@kernel
def distance_from_drifts(drifts, east, north):
    """Least horizontal distance (m) of a place from the paths, from their beginning on, as a weaker wind ends
    on the way; 1e9 without a path.
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
            least = min(least, sqrt(off_e * off_e + off_n * off_n))
    return least
