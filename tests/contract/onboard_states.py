"""States that the flight computer may find itself in: a grid over flight, and single ones."""

from itertools import product
from math import cos, pi, radians, sin

import numpy as np
from pyquaternion import Quaternion

from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV, derive
from edl6dof.fsw.navigation.wind_estimate import WIND_ESTIMATE
from edl6dof.interface.sensed import SENSED

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
ENTRY, LANDER = 0, 0b111

X, Y, Z = np.eye(3)


def nav_state(
    onboard,
    lat,
    lon,
    altitude,
    velocity_N,
    attitude,
    rate=(0.0, 0.0, 0.0),
    force=(0.0, 0.0, 0.0),
    t=50.0,
    height=None,
):
    """Navigation of a state given by north-east-down velocity and an attitude relative to that triad."""
    planet = onboard[0]["planet"]
    spin = Quaternion(axis=Z, radians=planet["rotation_rate"] * t)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    ned = np.column_stack([np.cross(up, east), east, -up])
    e2 = planet["flattening"] * (2.0 - planet["flattening"])
    prime = planet["equatorial_radius"] / np.sqrt(1.0 - e2 * sin(lat) ** 2)
    r = spin.rotate((prime + altitude) * up - np.array([0.0, 0.0, prime * e2 * sin(lat)]))
    sensed, nav = np.zeros(1, SENSED)[0], np.zeros(1, NAV)[0]
    sensed["t"], sensed["r_I"] = t, r
    sensed["v_I"] = spin.rotate(ned @ np.asarray(velocity_N)) + np.cross((0, 0, planet["rotation_rate"]), r)
    sensed["q_I2B"] = (spin * Quaternion(matrix=ned) * attitude).elements
    sensed["w_B"], sensed["specific_force_B"] = rate, force
    sensed["height_above_ground"] = altitude - onboard[0]["site"]["altitude"] if height is None else height
    believed = [onboard[0][name] for name in ("atmosphere", "vehicle")]
    derive(planet, *believed, onboard[0]["site"]["frame"], sensed, np.zeros(1, WIND_ESTIMATE)[0], nav)
    return nav


def any_attitude(rng):
    return Quaternion(axis=rng.normal(size=3), radians=rng.uniform(0.0, 2.0 * pi))


def states(onboard):
    """Fast and slow, steep and level, over the target and far from it, any attitude, spinning or not."""
    site = onboard[0]["site"]
    rng = np.random.default_rng(11)
    for away, altitude, (speed, fpa), force in product(
        (0.0, 0.05, 0.25),
        (-3900.0, 12e3, 60e3, 124e3),
        (
            (0.0, 0.0),
            (1e-3, -0.3),
            (1.0, -pi / 2),
            (80.0, -pi / 2),
            (650.0, -0.4),
            (4800.0, -0.2),
            (900.0, 0.5),
            (4000.0, -pi / 2),
        ),
        (0.0, 60.0),
    ):
        azimuth = rng.uniform(-pi, pi)
        velocity = speed * np.array([cos(fpa) * cos(azimuth), cos(fpa) * sin(azimuth), -sin(fpa)])
        attitude = any_attitude(rng) if force else Quaternion(axis=Y, radians=-pi / 2)
        yield nav_state(
            onboard,
            site["aim_latitude"] + away,
            site["aim_longitude"],
            altitude,
            velocity,
            attitude,
            rng.normal(size=3) * (1.0 if force else 0.0),
            # any way round in the body
            attitude.rotate(np.array([-force, 0.0, 0.1 * force])),
            t=rng.uniform(0.0, 600.0),
        )


def guided(bank=0.9, direction=(0.0, 0.0, -1.0), translating=0):
    guide = np.zeros(1, GUIDE)[0]
    guide["bank"], guide["alpha"], guide["thrust_direction_N"] = bank, radians(-10.0), direction
    guide["translating"], guide["force_N"] = translating, (200.0, -300.0)
    return guide
