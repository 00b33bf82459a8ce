"""Frame conversions against scipy's Rotation, definitions in space, finite differences and 80-bit closed
forms.

Geodetic coordinates: the forward map (latitude, longitude, height to position) is closed-form; it is checked
against the meaning of an ellipsoid's normal, then evaluated in 80-bit arithmetic as the truth for the
iteration back, and a numerical search for the nearest point of the ellipsoid is the second witness.
Directions north, east, up are derivatives of that map.  Great circles: haversine, vector angle and the worked
example of E. Williams' Aviation Formulary (Los Angeles to New York).  Bank, attack
and sideslip: the definitions of a lift vector and of the body components of the velocity.
"""

from math import asin, atan2, cos, degrees, hypot, pi, radians, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from edl6dof.spatial import frames
from edl6dof.spatial.quaternion import axes, to_frame

RNG = np.random.default_rng(3)
MARS, EARTH = (3396190.0, 1.0 / 169.8944472), (6378137.0, 1.0 / 298.257223563)
PLANETS = pytest.mark.parametrize("planet", [MARS, EARTH, (3396190.0, 0.0)], ids=["Mars", "Earth", "sphere"])
LATITUDES = [-90.0, -89.999999, -60.0, -45.0, -1e-7, 0.0, 1e-7, 25.1, 45.0, 75.0, 89.9999, 90.0]
HEIGHTS = [-10e3, 0.0, 10.0, 125e3, 1e6, 4e6, 10e6]
UP = [tuple(map(float, u / np.linalg.norm(u))) for u in RNG.normal(size=(12, 3))]


def exact_position(planet, lat, lon, height):
    """Planet-fixed position in 80-bit arithmetic."""
    a, f, lat, lon, height = (np.longdouble(x) for x in (*planet, lat, lon, height))
    prime = a / np.sqrt(np.cos(lat) ** 2 + (1 - f) ** 2 * np.sin(lat) ** 2)
    across = (prime + height) * np.cos(lat)
    return np.array(
        [across * np.cos(lon), across * np.sin(lon), (prime * (1 - f) ** 2 + height) * np.sin(lat)]
    )


def trig(lat, lon):
    return sin(lat), cos(lat), sin(lon), cos(lon)


@PLANETS
def test_height_is_measured_along_the_normal_of_the_ellipsoid(planet):
    """Definition: the foot lies on the ellipsoid, and the way up from it runs along the gradient of its
    equation.
    """
    a, b = planet[0], planet[0] * (1.0 - planet[1])
    for lat, lon, height in RNG.uniform((-pi / 2, -pi, -1e4), (pi / 2, pi, 1e6), size=(50, 3)):
        foot = np.array(frames.from_geodetic(*planet, lat, lon, 0.0))
        assert (foot / (a, a, b)) @ (foot / (a, a, b)) == pytest.approx(1.0, abs=1e-14)
        gradient = foot / (a * a, a * a, b * b)
        top = np.array(frames.from_geodetic(*planet, lat, lon, height))
        assert top == pytest.approx(foot + height * gradient / np.linalg.norm(gradient), abs=1e-8)
        assert atan2(gradient[2], hypot(gradient[0], gradient[1])) == pytest.approx(lat, abs=1e-14)


@PLANETS
@pytest.mark.parametrize("height", HEIGHTS)
def test_geodetic_returns_to_where_it_came_from(planet, height):
    for lat_deg in LATITUDES:
        for lon_deg in (-180.0, -90.0, 0.0, 63.7, 179.9999):
            lat, lon = radians(lat_deg), radians(lon_deg)
            position = tuple(float(x) for x in exact_position(planet, lat, lon, height))
            sl, cl, so, co, altitude = frames.geodetic(*planet, position)
            # a few ulp of the distance from the centre; the method leaves 1e-9 m up to 1,000 km and 1e-8 m at
            # 10,000 km
            assert altitude == pytest.approx(height, abs=8e-9 if height < 1e7 else 2e-8)
            assert atan2(sl, cl) == pytest.approx(lat, abs=4e-16 * 3)
            assert (
                cl >= 0.0
                and hypot(sl, cl) == pytest.approx(1.0, abs=1e-15)
                and hypot(so, co) == pytest.approx(1.0, abs=1e-15)
            )
            if abs(lat_deg) < 89.9:
                assert cos(lon - atan2(so, co)) == pytest.approx(1.0, abs=1e-15)


@PLANETS
def test_altitude_is_the_distance_to_the_nearest_point_of_the_ellipsoid(planet):
    a, b = planet[0], planet[0] * (1.0 - planet[1])
    for across, z in ((3.5e6, 1.2e6), (6.4e6, -2.0e6), (1.0e6, 7.0e6), (9.0e6, 9.0e6)):

        def distance(angle, across=across, z=z):
            return hypot(across - a * cos(angle), z - b * sin(angle))

        middle = atan2(z, across)
        best = minimize_scalar(
            distance, bounds=(middle - 0.3, middle + 0.3), method="bounded", options={"xatol": 1e-9}
        )
        inside = (across / a) ** 2 + (z / b) ** 2 < 1.0
        altitude = frames.geodetic(*planet, (across, 0.0, z))[4]
        assert altitude == pytest.approx(-best.fun if inside else best.fun, abs=1e-6)


@PLANETS
def test_on_the_axis_longitude_is_zero_and_altitude_counts_from_the_pole(planet):
    for sign in (1.0, -1.0):
        sl, cl, so, co, altitude = frames.geodetic(*planet, (0.0, 0.0, sign * 4.0e6 * planet[0] / 3396190.0))
        assert (sl, cl, so, co) == pytest.approx((sign, 0.0, 0.0, 1.0), abs=3e-16)
        polar = planet[0] * (1.0 - planet[1])
        assert altitude == pytest.approx(4.0e6 * planet[0] / 3396190.0 - polar, abs=1e-8)


def test_planet_fixed_axes_turn_eastward():
    """A star fixed in I drifts west in F; by scipy the components turn with the inverse rotation."""
    for angle in (-2.0, 0.3, 1.7):
        v = tuple(RNG.normal(size=3))
        turned = frames.rotate_z(cos(angle), sin(angle), v)
        assert turned == pytest.approx(Rotation.from_euler("z", angle).inv().apply(v), abs=1e-15)
        assert frames.rotate_z(cos(angle), -sin(angle), turned) == pytest.approx(v, abs=1e-15)


@PLANETS
def test_north_east_and_up_are_where_latitude_longitude_and_height_grow(planet):
    for lat, lon in RNG.uniform((-1.4, -pi), (1.4, pi), size=(25, 2)):

        def growth(step, lat=lat, lon=lon):
            late, early = (
                np.array(frames.from_geodetic(*planet, lat + s * step[0], lon + s * step[1], s * step[2]))
                for s in (1, -1)
            )
            return (late - early) / np.linalg.norm(late - early)

        directions = [growth((1e-5, 0.0, 0.0)), growth((0.0, 1e-5, 0.0)), -growth((0.0, 0.0, 10.0))]
        for k, unit in enumerate(np.eye(3)):
            assert frames.ned_to_fixed(*trig(lat, lon), tuple(unit)) == pytest.approx(directions[k], abs=1e-8)
        v = tuple(RNG.normal(size=3))
        assert frames.fixed_to_ned(*trig(lat, lon), v) == pytest.approx(
            [d @ np.array(v) for d in directions], abs=1e-8
        )
        rotation = Rotation.from_euler("ZY", (lon, -lat - pi / 2))  # the textbook sequence from F to N
        assert frames.fixed_to_ned(*trig(lat, lon), v) == pytest.approx(rotation.inv().apply(v), abs=1e-14)
        assert to_frame(frames.ned_attitude(*trig(lat, lon)), v) == pytest.approx(
            rotation.inv().apply(v), abs=1e-14
        )


@pytest.mark.parametrize("lat_deg", [-90.0, 90.0])
def test_the_local_frame_exists_at_the_poles(lat_deg):
    lat = radians(lat_deg)
    assert frames.ned_to_fixed(*trig(lat, 0.4), (0.0, 0.0, 1.0)) == pytest.approx(
        (0.0, 0.0, -lat_deg / 90.0), abs=1e-15
    )
    q = frames.ned_attitude(*trig(lat, 0.4))
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)


def test_east_north_up_from_the_landing_site():
    """100 m along each direction from Zhurong's site, walked on the ellipsoid by its radii of curvature."""
    lat, lon = radians(25.066), radians(109.925)
    a, f = MARS
    e2 = f * (2.0 - f)
    prime = a / sqrt(1.0 - e2 * sin(lat) ** 2)
    meridian = prime * (1.0 - e2) / (1.0 - e2 * sin(lat) ** 2)
    site = frames.from_geodetic(*MARS, lat, lon, 0.0)
    walks = {
        (100.0, 0.0, 0.0): frames.from_geodetic(*MARS, lat, lon + 100.0 / (prime * cos(lat)), 0.0),
        (0.0, 100.0, 0.0): frames.from_geodetic(*MARS, lat + 100.0 / meridian, lon, 0.0),
        (0.0, 0.0, 100.0): frames.from_geodetic(*MARS, lat, lon, 100.0),
    }
    for expected, position in walks.items():
        # curvature: 1.5 mm
        assert frames.fixed_to_enu(site, trig(lat, lon), position) == pytest.approx(expected, abs=2e-3)


def test_great_circle_from_los_angeles_to_new_york():
    """Williams, Aviation Formulary, worked example: 0.623585 rad, initial course 66 deg (1.150035 rad)."""
    lax, jfk = (
        (radians(33 + 57 / 60), -radians(118 + 24 / 60)),
        (radians(40 + 38 / 60), -radians(73 + 47 / 60)),
    )
    angle, azimuth = frames.great_circle(lax, jfk)
    assert angle == pytest.approx(0.623585, abs=1e-6)
    assert azimuth == pytest.approx(1.150035, abs=1e-6) and round(degrees(azimuth)) == 66


def test_great_circle_is_the_haversine_angle_and_points_at_the_target():
    for lat1, lon1, lat2, lon2 in RNG.uniform((-1.5, -pi, -1.5, -pi), (1.5, pi, 1.5, pi), size=(60, 4)):
        angle, azimuth = frames.great_circle((lat1, lon1), (lat2, lon2))
        haversine = sin((lat2 - lat1) / 2) ** 2 + cos(lat1) * cos(lat2) * sin((lon2 - lon1) / 2) ** 2
        assert angle == pytest.approx(2.0 * asin(sqrt(haversine)), abs=1e-7)
        north, east, _ = frames.fixed_to_ned(
            *trig(lat1, lon1), (cos(lat2) * cos(lon2), cos(lat2) * sin(lon2), sin(lat2))
        )
        assert (cos(azimuth), sin(azimuth)) == pytest.approx(
            (north / hypot(north, east), east / hypot(north, east)), abs=1e-12
        )


@pytest.mark.parametrize("metres", [0.001, 1.0, 100.0])
def test_great_circle_resolves_a_millimetre_and_its_antipode(metres):
    step = metres / MARS[0]
    near = frames.great_circle((0.4, 1.0), (0.4 + step, 1.0))[0]
    far = frames.great_circle((0.4, 1.0), (-0.4 + step, 1.0 + pi))[0]
    assert near * MARS[0] == pytest.approx(metres, abs=2e-9)
    assert (pi - far) * MARS[0] == pytest.approx(metres, abs=2e-9)


def test_angle_of_attack_and_sideslip_of_a_known_velocity():
    speed, alpha, beta = frames.wind_angles((400.0, 30.0, -70.0))
    assert speed == pytest.approx(np.linalg.norm((400.0, 30.0, -70.0)))
    rebuilt = (speed * cos(alpha) * cos(beta), speed * sin(beta), speed * sin(alpha) * cos(beta))
    assert rebuilt == pytest.approx((400.0, 30.0, -70.0), rel=1e-14)
    assert alpha < 0.0 < beta  # wind from above and from the right
    assert frames.total_angle_of_attack((400.0, 30.0, -70.0)) == pytest.approx(
        atan2(hypot(30.0, 70.0), 400.0), rel=1e-12
    )
    assert frames.total_angle_of_attack((-1.0, 0.0, 0.0)) == pytest.approx(pi)
    assert (
        frames.wind_angles((0.0, 0.0, 0.0)) == (0.0, 0.0, 0.0)
        and frames.total_angle_of_attack((0.0, 0.0, 0.0)) == 0.0
    )


@pytest.mark.parametrize("bank_deg", [-180.0, -120.0, -45.0, 0.0, 15.0, 90.0, 170.0])
@pytest.mark.parametrize("alpha_deg, beta_deg", [(-10.0, 0.0), (0.0, 0.0), (5.0, -8.0), (-25.0, 20.0)])
def test_attitude_carries_bank_angle_of_attack_and_sideslip(bank_deg, alpha_deg, beta_deg):
    bank, alpha, beta = radians(bank_deg), radians(alpha_deg), radians(beta_deg)
    for up in UP:
        v = tuple(map(float, RNG.normal(size=3) * 3000.0))
        q = frames.attitude_from_wind_angles(v, up, bank, alpha, beta)
        speed, a, b = frames.wind_angles(to_frame(q, v))
        assert (speed, a, b) == pytest.approx((np.linalg.norm(v), alpha, beta), abs=1e-9)
        assert np.exp(1j * frames.bank_angle(v, up, *axes(q))) == pytest.approx(np.exp(1j * bank), abs=1e-12)


@pytest.mark.parametrize("bank_deg", [-150.0, -60.0, 0.0, 40.0, 90.0, 180.0])
def test_lift_points_up_at_zero_bank_and_right_at_ninety(bank_deg):
    """The lift of a positive angle of attack, in B (sin a, 0, -cos a), seen against the vertical and the
    right-hand side.
    """
    bank, alpha = radians(bank_deg), radians(12.0)
    for up in UP:
        v = tuple(map(float, RNG.normal(size=3)))
        q = frames.attitude_from_wind_angles(v, up, bank, alpha, 0.0)
        lift = np.array(axes(q)).T @ (sin(alpha), 0.0, -cos(alpha))
        right = np.cross(v, up)
        climb = np.array(v) @ up / np.linalg.norm(v)
        assert lift @ np.array(v) == pytest.approx(0.0, abs=1e-12)
        assert lift @ np.array(up) == pytest.approx(cos(bank) * sqrt(1.0 - climb**2), abs=1e-12)
        assert lift @ right / np.linalg.norm(right) == pytest.approx(sin(bank), abs=1e-12)


def assert_right_handed_path(v, up):
    x, y, z = (np.array(axis) for axis in frames.path_axes(v, up))
    assert np.column_stack([x, y, z]).T @ np.column_stack([x, y, z]) == pytest.approx(np.eye(3), abs=1e-6)
    assert np.cross(x, y) == pytest.approx(z, abs=1e-12)
    assert x == pytest.approx(np.array(v) / np.linalg.norm(v), abs=1e-14)
    assert y @ np.array(up) == pytest.approx(0.0, abs=1e-6)


def test_path_axes_are_horizontal_to_the_right_and_down():
    for up in UP:
        v = tuple(map(float, RNG.normal(size=3) * 500.0))
        assert_right_handed_path(v, up)
        assert np.array(frames.path_axes(v, up)[2]) @ np.array(up) < 0.0


@pytest.mark.parametrize("tilt", [0.0, 1e-16, 1e-12, 1e-8])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_path_axes_of_a_vertical_velocity_are_finite(sign, tilt):
    for up in [*UP, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]:
        aside = np.cross(up, (0.3, 0.5, 0.8))
        assert_right_handed_path(tuple(map(float, 60.0 * sign * np.array(up) + 60.0 * tilt * aside)), up)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_path_axes_of_a_vertical_velocity_are_finite_above_35_north_45_east(sign):
    """There the three components of the vertical are equal and swapping them gives no second direction."""
    up = (sqrt(1 / 3),) * 3
    assert_right_handed_path(tuple(sign * 60.0 * u for u in up), up)


def test_wrapped_angles_point_the_same_way():
    for angle in (-7.0, -pi + 1e-9, -1.0, 0.0, 3.0, 4.0, 100.0):
        assert -pi <= frames.wrap(angle) <= pi
        assert np.exp(1j * frames.wrap(angle)) == pytest.approx(np.exp(1j * angle), abs=1e-14)
