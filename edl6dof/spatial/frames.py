"""Conversions between frames.

I inertial and F planet-fixed share the planet's pole as z; F turns by ``rotation_rate * t`` and coincides
with I at t = 0. N is north-east-down of the geodetic vertical; L is east-north-up at a fixed point; V is the
frame of a velocity (x along it, z in the plane of the local vertical, down) turned by the bank angle.  Angles
in rad, lengths in m.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import asin, atan2, cos, sin, sincos
from edl6dof.spatial.quaternion import from_axes, multiply
from edl6dof.spatial.vector import clamp, cross, dot, scale, sub, take3, unit

#: Adding and subtracting it rounds a number below 2**51 to the nearest integer.
_ROUND = 6755399441055744.0


@kernel
def rotate_z(angle_cos, angle_sin, v):
    """Components in a frame turned by an angle about z (I to F); with the sine negated, back."""
    return angle_cos * v[0] + angle_sin * v[1], angle_cos * v[1] - angle_sin * v[0], v[2]


@kernel
def geodetic(radius, flattening, r_F):
    """Sines and cosines of geodetic latitude and longitude, and the height above the ellipsoid.

    Returns (sin_lat, cos_lat, sin_lon, cos_lon, altitude).  Bowring's parametric-latitude iteration without
    trigonometric functions; two passes leave less than 1e-9 m for heights up to 10,000 km.  The height is
    stationary in the latitude, so that it is taken after one pass (1e-9 m up to 1,000 km, 1e-8 m up to 10,000
    km): the density, which needs it, can be evaluated early.
    Source: B. R. Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23 (1976).
    """
    x, y, z = r_F
    axis = sqrt(x * x + y * y)
    inverse = 1.0 / axis if axis > 0.0 else 0.0
    cos_lon, sin_lon = (x * inverse, y * inverse) if axis > 0.0 else (1.0, 0.0)
    shape = 1.0 - flattening
    e2 = flattening * (2.0 - flattening)
    # in radii; sine and cosine keep a common factor up to the end: normalising them in each pass cost 10 %
    # more
    per_radius = 1.0 / radius
    height, width = z * per_radius, axis * per_radius
    s, c = _bowring(height, width, shape, e2, s=height, c=shape * shape * width)
    length2 = s * s + c * c
    altitude = radius * ((width * c + height * s - sqrt(length2 - e2 * s * s)) / sqrt(length2))
    s, c = _bowring(height, width, shape, e2, s, c=c)
    inverse = 1.0 / sqrt(s * s + c * c)
    return s * inverse, c * inverse, sin_lon, cos_lon, altitude


@kernel
def _bowring(height, width, shape, e2, s, c):
    """One pass: improve sine and cosine of the latitude, both times a common factor."""
    sb, cb = shape * s, c
    b2 = sb * sb + cb * cb
    b3 = b2 * sqrt(b2)
    return height * b3 + e2 / shape * sb * sb * sb, width * b3 - e2 * cb * cb * cb


@kernel
def from_geodetic(radius, flattening, lat, lon, altitude):
    """Planet-fixed position of a geodetic latitude, longitude and height."""
    e2 = flattening * (2.0 - flattening)
    prime = radius / sqrt(1.0 - e2 * sin(lat) * sin(lat))
    horizontal = (prime + altitude) * cos(lat)
    return horizontal * cos(lon), horizontal * sin(lon), (prime * (1.0 - e2) + altitude) * sin(lat)


@kernel
def ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, v_N):
    """Components in F of a vector with components north, east, down."""
    up_part = -sin_lat * v_N[0] - cos_lat * v_N[2]
    return (
        up_part * cos_lon - sin_lon * v_N[1],
        up_part * sin_lon + cos_lon * v_N[1],
        cos_lat * v_N[0] - sin_lat * v_N[2],
    )


@kernel
def fixed_to_ned(sin_lat, cos_lat, sin_lon, cos_lon, v_F):
    """Components north, east, down of a vector with components in F."""
    radial = cos_lon * v_F[0] + sin_lon * v_F[1]
    return (
        cos_lat * v_F[2] - sin_lat * radial,
        cos_lon * v_F[1] - sin_lon * v_F[0],
        -cos_lat * radial - sin_lat * v_F[2],
    )


#: A local frame L fixed to the planet: its origin in F, and sines and cosines of its geodetic latitude and
#: longitude.
LOCAL_FRAME = record(
    ("origin_F", "f8", (3,)),  # m, F: origin
    ("sin_lat", "f8"),  # sine of the geodetic latitude of the origin
    ("cos_lat", "f8"),  # cosine of that latitude
    ("sin_lon", "f8"),  # sine of the longitude of the origin
    ("cos_lon", "f8"),  # cosine of that longitude
)


def fill_local_frame(
    record: np.void, radius: float, flattening: float, lat: float, lon: float, altitude: float
) -> None:
    """Place a ``LOCAL_FRAME`` record at a geodetic latitude and longitude (rad) and height (m)."""
    record["origin_F"] = from_geodetic(radius, flattening, lat, lon, altitude)
    record["sin_lat"], record["cos_lat"], record["sin_lon"], record["cos_lon"] = (
        sin(lat),
        cos(lat),
        sin(lon),
        cos(lon),
    )


@kernel
def fixed_to_enu(site_F, trig, r_F):
    """East, north, up of a position relative to a site, in the site's geodetic frame L; ``trig``: sine and
    cosine of the latitude and of the longitude of the site.
    """
    sin_lat, cos_lat, sin_lon, cos_lon = trig
    north, east, down = fixed_to_ned(sin_lat, cos_lat, sin_lon, cos_lon, sub(r_F, site_F))
    return east, north, -down


@kernel
def to_local(frame, r_F):
    """East, north, up in a ``LOCAL_FRAME`` of a position in F."""
    trig = (frame.sin_lat, frame.cos_lat, frame.sin_lon, frame.cos_lon)
    return fixed_to_enu(take3(frame.origin_F, 0), trig, r_F)


@kernel
def ned_attitude(sin_lat, cos_lat, sin_lon, cos_lon):
    """Quaternion ``q_F2N``."""
    north = ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (1.0, 0.0, 0.0))
    east = ned_to_fixed(sin_lat, cos_lat, sin_lon, cos_lon, (0.0, 1.0, 0.0))
    return from_axes(north, east, cross(north, east))


@kernel
def wind_angles(v_B):
    """Speed, alpha = atan2(w, u) and beta = asin(v / V) of an air-relative velocity in B."""
    speed = sqrt(v_B[0] * v_B[0] + v_B[1] * v_B[1] + v_B[2] * v_B[2])
    if speed <= 0.0:
        return 0.0, 0.0, 0.0
    return speed, atan2(v_B[2], v_B[0]), asin(clamp(v_B[1] / speed, -1.0, 1.0))


@kernel
def total_angle_of_attack(v_B):
    """Angle between the velocity and the body x axis, 0 .. pi."""
    return atan2(sqrt(v_B[1] * v_B[1] + v_B[2] * v_B[2]), v_B[0])


@kernel
def path_axes(v, up):
    """Unit axes of the path frame at zero bank: x along ``v``, y right (horizontal), z down, for a unit
    vector ``up``.

    A vertical velocity leaves the horizontal direction open: y is then any horizontal unit vector.  A vehicle
    at rest counts as moving straight down.
    """
    x = unit(v)
    if dot(x, x) == 0.0:
        x = scale(-1.0, up)
    y = cross(x, up)
    if dot(y, y) < 1e-18:
        # the coordinate axis farthest from x spans a plane with it
        if abs(x[0]) <= abs(x[1]) and abs(x[0]) <= abs(x[2]):
            y = cross(x, (1.0, 0.0, 0.0))
        elif abs(x[1]) <= abs(x[2]):
            y = cross(x, (0.0, 1.0, 0.0))
        else:
            y = cross(x, (0.0, 0.0, 1.0))
    y = unit(y)
    return x, y, cross(x, y)


@kernel
def bank_angle(v, up, body_x, body_y, body_z):
    """Bank angle: rotation about the velocity from the path frame at zero bank to the body, after alpha and
    beta are removed.

    All vectors are in one common frame.  The body axis that stays perpendicular to the velocity under alpha
    and beta rotations is ``y_V = (y_B - sin(beta) x_V) / cos(beta)``; the bank angle is its angle from the
    horizontal, positive right wing down.
    """
    x, y, z = path_axes(v, up)
    side = dot(body_y, x)
    y_v = sub(body_y, scale(side, x))
    return atan2(dot(y_v, z), dot(y_v, y))


@kernel
def attitude_from_wind_angles(v, up, bank, alpha, beta):
    """``q_A2B`` of a body at bank, angle of attack and sideslip (rad); ``v`` and ``up`` in A."""
    x, y, z = path_axes(v, up)
    q_path = from_axes(x, y, z)
    q_bank = (cos(0.5 * bank), sin(0.5 * bank), 0.0, 0.0)
    q_beta = (cos(0.5 * beta), 0.0, 0.0, -sin(0.5 * beta))
    q_alpha = (cos(0.5 * alpha), 0.0, sin(0.5 * alpha), 0.0)
    return multiply(multiply(multiply(q_path, q_bank), q_beta), q_alpha)


@kernel
def attitude_in_wind(v, v_air, up, bank, alpha):
    """``q_A2B`` of a body with ``bank`` (rad) about the planet-relative velocity ``v``, and with the angle of
    attack ``alpha`` (rad) and zero sideslip relative to the air, of velocity ``v_air``; vectors in A.

    The lateral axis y_B lies in the banked plane through ``v``, and is perpendicular to ``v_air``.
    """
    _, y, z = path_axes(v, up)
    below = sub(scale(cos(bank), z), scale(sin(bank), y))
    forward = path_axes(v_air, up)[0]
    right = unit(cross(below, forward))
    q_air = from_axes(forward, right, cross(forward, right))
    return multiply(q_air, (cos(0.5 * alpha), 0.0, sin(0.5 * alpha), 0.0))


@kernel
def great_circle(start, end):
    """Central angle and initial azimuth (from north through east) between (latitude, longitude), rad."""
    (sin_lat1, cos_lat1), (sin_lat2, cos_lat2) = sincos(start[0]), sincos(end[0])
    sin_dlon, cos_dlon = sincos(end[1] - start[1])
    a = cos_lat2 * sin_dlon
    b = cos_lat1 * sin_lat2 - sin_lat1 * cos_lat2 * cos_dlon
    c = sin_lat1 * sin_lat2 + cos_lat1 * cos_lat2 * cos_dlon
    return atan2(sqrt(a * a + b * b), c), atan2(a, b)


@kernel
def wrap(angle):
    """Angle brought within pi of zero."""
    turns = angle * (0.5 / pi)
    return angle - 2.0 * pi * ((turns + _ROUND) - _ROUND)
