"""Navigation against states constructed forward with numpy and pyquaternion."""

from math import acos, cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from pyquaternion import Quaternion

from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.navigation.derived import NAV, derive, model_atmosphere
from edl6dof.fsw.navigation.wind_estimate import WIND_ESTIMATE
from edl6dof.interface.sensed import SENSED

X, Y, Z = np.eye(3)
SPIN = 7.08821807e-05


def ellipsoid(planet, lat, lon, altitude):
    """Planet-fixed position: foot point of the ellipsoid plus altitude along its normal (gradient of the
    quadric).
    """
    a, b = planet["equatorial_radius"], planet["equatorial_radius"] * (1.0 - planet["flattening"])
    normal = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    half = np.array([a, a, b])
    return half**2 * normal / np.linalg.norm(half * normal) + altitude * normal


def triad(lat, lon):
    """North, east, down in F, as columns."""
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    return np.column_stack([np.cross(up, east), east, -up])


def fly_state(
    onboard, lat, lon, altitude, speed, fpa, azimuth, bank, alpha, beta, t=0.0, force=(0.0, 0.0, 0.0)
):
    """Sensor record of a state given by its angles."""
    planet = onboard[0]["planet"]
    turn = Quaternion(axis=Z, radians=planet["rotation_rate"] * t)
    ned = triad(lat, lon)
    path = (
        Quaternion(axis=Z, radians=azimuth)
        * Quaternion(axis=Y, radians=fpa)
        * Quaternion(axis=X, radians=bank)
    )
    body = path * Quaternion(axis=Z, radians=-beta) * Quaternion(axis=Y, radians=alpha)
    q = turn * Quaternion(matrix=ned) * body
    r = turn.rotate(ellipsoid(planet, lat, lon, altitude))
    v = turn.rotate(
        ned @ (Quaternion(axis=Z, radians=azimuth) * Quaternion(axis=Y, radians=fpa)).rotate(speed * X)
    )
    sensed = np.zeros(1, SENSED)[0]
    sensed["t"], sensed["r_I"], sensed["q_I2B"] = t, r, q.elements
    sensed["v_I"] = v + np.cross((0.0, 0.0, planet["rotation_rate"]), r)
    sensed["specific_force_B"] = force
    return sensed, v, q


def nav_of(onboard, sensed):
    nav = np.zeros(1, NAV)[0]
    believed = [onboard[0][name] for name in ("planet", "atmosphere", "vehicle")]
    derive(*believed, onboard[0]["site"]["frame"], sensed, np.zeros(1, WIND_ESTIMATE)[0], nav)
    return nav


def test_flight_angles_are_those_the_state_was_built_from(onboard):
    rng = np.random.default_rng(0)
    for _ in range(60):
        given = {
            "latitude": rng.uniform(-1.5, 1.5),
            "longitude": rng.uniform(-pi, pi),
            "altitude": rng.uniform(-4e3, 130e3),
            "speed": rng.uniform(1.0, 6000.0),
            "flight_path_angle": rng.uniform(-1.5, 1.5),
            "azimuth": rng.uniform(-pi, pi),
            "bank": rng.uniform(-pi, pi),
            "alpha": rng.uniform(-3.0, 3.0),
            "beta": rng.uniform(-1.4, 1.4),
        }
        sensed, v, q = fly_state(onboard, *given.values(), t=rng.uniform(0.0, 900.0))
        nav = nav_of(onboard, sensed)
        for name, value in given.items():
            assert nav[name] == pytest.approx(value, abs=1e-3 if name == "altitude" else 1e-7, rel=1e-9), name
        assert nav["v_rel_I"] == pytest.approx(v, abs=1e-6)
        assert nav["tilt"] == pytest.approx(acos(np.clip(-(q.rotate(X) @ nav["up_I"]), -1, 1)), abs=1e-7)
        frame = np.column_stack([nav["north_I"], nav["east_I"], -nav["up_I"]])
        assert frame.T @ frame == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(frame) == pytest.approx(1.0)
        assert frame @ nav["v_N"] == pytest.approx(v, abs=1e-6)
        assert nav["radius"] == pytest.approx(np.linalg.norm(sensed["r_I"]))


def test_total_angle_of_attack_is_that_to_the_air_of_the_expected_wind(onboard):
    """At every node of the believed air it is what the table and the velocities make of it with numpy."""
    air = onboard[0]["atmosphere"]
    assert np.hypot(air["wind_north"], air["wind_east"]).max() > 20.0
    rng = np.random.default_rng(3)
    for k in range(0, len(air["wind_north"]) - 1, 7):
        lat, lon, altitude = 0.4, 1.9, air["bottom"] + k * air["spacing"]
        flown = rng.uniform(150.0, 800.0), rng.uniform(-0.5, 0.0), rng.uniform(-pi, pi), rng.uniform(-pi, pi)
        sensed, v, q = fly_state(
            onboard, lat, lon, altitude, *flown, rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)
        )
        wind = triad(lat, lon)[:, :2] @ (air["wind_north"][k], air["wind_east"][k])
        u = q.inverse.rotate(v - wind)
        nav = nav_of(onboard, sensed)
        assert nav["total_alpha"] == pytest.approx(acos(u[0] / np.linalg.norm(u)), abs=1e-7)
        assert nav["alpha_in_air"] == pytest.approx(np.arctan2(u[2], u[0]), abs=1e-7)
        assert nav["beta_in_air"] == pytest.approx(np.arcsin(u[1] / np.linalg.norm(u)), abs=1e-7)


def test_vehicle_at_rest_on_the_ground_has_no_planet_relative_velocity(onboard):
    sensed, _, _ = fly_state(
        onboard, radians(25.0), radians(110.0), -4000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, t=500.0
    )
    assert np.linalg.norm(sensed["v_I"]) > 200.0
    assert nav_of(onboard, sensed)["speed"] < 1e-9


@pytest.mark.parametrize(
    "east, north, up", [(0, 0, 0), (1200.0, 0, 0), (0, -850.0, 0), (0, 0, 1500.0), (-90.0, 400.0, 1000.0)]
)
def test_position_from_the_landing_site_is_east_north_up(onboard, east, north, up):
    site, planet = onboard[0]["site"], onboard[0]["planet"]
    lat, lon = site["latitude"], site["longitude"]
    ned = triad(lat, lon)
    r = ellipsoid(planet, lat, lon, site["altitude"]) + ned @ np.array([north, east, -up])
    sensed = np.zeros(1, SENSED)[0]
    sensed["r_I"], sensed["q_I2B"] = r, (1.0, 0.0, 0.0, 0.0)
    nav = nav_of(onboard, sensed)
    assert nav["site_L"] == pytest.approx((east, north, up), abs=1e-5)


def upright(onboard, roll_about_up_from_south, tilt=0.0, towards=0.0):
    """Landed-type attitude: x_B down, y_B south, turned about up; then tilted by the shortest rotation."""
    site = onboard[0]["site"]
    ned = triad(site["latitude"], site["longitude"])
    down, south = ned[:, 2], -ned[:, 0]
    q = Quaternion(matrix=np.column_stack([down, south, np.cross(down, south)]))
    q = Quaternion(axis=-down, radians=roll_about_up_from_south) * q
    level = cos(towards) * ned[:, 0] + sin(towards) * ned[:, 1]
    q = Quaternion(axis=level, radians=tilt) * q
    sensed = np.zeros(1, SENSED)[0]
    sensed["r_I"] = ellipsoid(onboard[0]["planet"], site["latitude"], site["longitude"], 0.0)
    sensed["q_I2B"] = q.elements
    return nav_of(onboard, sensed), q


def test_roll_error_is_zero_with_y_axis_south_and_turning_by_it_brings_y_south(onboard):
    nav, _ = upright(onboard, 0.0)
    assert nav["roll_to_south"] == pytest.approx(0.0, abs=1e-12)
    assert nav["tilt"] == pytest.approx(0.0, abs=1e-7)
    for angle in (0.1, -0.4, 1.5, -2.5, 3.0):
        nav, q = upright(onboard, angle)
        assert nav["roll_to_south"] == pytest.approx(angle)  # goal minus actual about x_B, which points down
        y = (q * Quaternion(axis=X, radians=nav["roll_to_south"])).rotate(Y)
        assert y == pytest.approx(-nav["north_I"], abs=1e-9)


def test_roll_error_of_a_tilted_lander_is_off_by_no_more_than_the_foreshortening(onboard):
    """The horizontal projection of y_B shortens across the tilt: at most (1 - cos tilt) / 2 to first
    order.
    """
    for tilt in (radians(4.0), radians(25.0)):
        worst = 0.0
        for towards in np.linspace(0, pi, 9):
            for roll in (0.0, 0.5, -1.2, 2.8):
                nav, _ = upright(onboard, roll, tilt, towards)
                worst = max(worst, abs(nav["roll_to_south"] - roll))
                assert nav["tilt"] == pytest.approx(tilt, abs=1e-7)
        assert worst <= 0.56 * (1.0 - cos(tilt))


def air_force(drag, lift, alpha):
    """Specific force in B of a body that meets the air at ``alpha``."""
    return Quaternion(axis=Y, radians=alpha).inverse.rotate(np.array([-drag, 0.0, -lift]))


def test_drag_is_that_along_the_trim_however_the_vehicle_flies_over_the_ground(onboard):
    """A crosswind puts the planet-relative velocity beside the air: no lift is taken for drag for that."""
    rng = np.random.default_rng(3)
    node = np.argmin(np.abs(mach_nodes() - 12.0))
    trim = onboard[0]["vehicle"]["airframe"]["alpha"][node]
    still, _, _ = fly_state(onboard, 0.4, 1.9, 3e4, 3000.0, -0.2, 3.1, 0.0, 0.0, 0.0, 200.0, (0.0, 0.0, 0.0))
    speed = mach_nodes()[node] * 3000.0 / nav_of(onboard, still)["mach"]
    for drag, lift in rng.uniform((5.0, -3.0), (100.0, 20.0), size=(10, 2)):
        angles = rng.uniform((-1.5, -0.3, -0.1), (1.5, 0.0, 0.1))
        force = air_force(drag, lift, trim)
        sensed, _, _ = fly_state(onboard, 0.4, 1.9, 3e4, speed, -0.2, 3.1, *angles, 200.0, force)
        assert nav_of(onboard, sensed)["drag"] == pytest.approx(drag, abs=1e-9)


def test_lift_is_that_across_the_air_so_that_another_trim_shows_in_it(onboard):
    sensed, _, _ = fly_state(
        onboard, 0.4, 1.9, 3e4, 3000.0, -0.2, 3.1, 0.7, -0.21, 0.0, 200.0, (0.0, 0.0, 0.0)
    )
    alpha = nav_of(onboard, sensed)["alpha_in_air"]
    sensed["specific_force_B"] = air_force(40.0, 7.0, alpha)
    assert nav_of(onboard, sensed)["lift"] == pytest.approx(7.0, abs=1e-9)


def test_drag_is_axial_once_the_trim_wing_is_open(onboard):
    sensed, _, _ = fly_state(
        onboard, 0.4, 1.9, 1e4, 600.0, -0.2, 3.1, 0.0, 0.0, 0.0, 200.0, (-9.0, 0.0, -1.0)
    )
    sensed["wing_open"] = 1
    assert nav_of(onboard, sensed)["drag"] == 9.0


def test_onboard_atmosphere_is_log_linear_between_nodes_and_its_scale_height_is_the_local_slope(onboard):
    table = onboard[0]["atmosphere"]
    nodes = table["bottom"] + table["spacing"] * np.arange(len(table["ln_density"]))
    for h in np.linspace(nodes[0] + 1.0, nodes[-1] - table["spacing"], 57):
        density, sound, scale_height = model_atmosphere(table, h)
        assert density == pytest.approx(np.exp(np.interp(h, nodes, table["ln_density"])), rel=1e-12)
        assert sound == pytest.approx(np.interp(h, nodes, table["speed_of_sound"]), rel=1e-12)
        if abs((h - nodes[0]) / table["spacing"] % 1.0 - 0.5) < 0.4:
            up, down = (np.log(model_atmosphere(table, h + s)[0]) for s in (1.0, -1.0))
            assert scale_height == pytest.approx(-2.0 / (up - down), rel=1e-6)
            assert 4e3 < scale_height < 20e3


def test_energy_falls_at_the_rate_of_drag_work(onboard):
    """dE/dt = -V D (Wu et al. eq. 10) on a ballistic arc: without drag it is constant over a non-rotating
    planet.
    """
    onboard[0]["planet"]["rotation_rate"] = 0.0
    mu = onboard[0]["planet"]["mu"]
    sensed, _, _ = fly_state(onboard, 0.0, 0.5, 1e5, 4000.0, -0.2, pi / 2, 0.0, 0.0, 0.0)
    r, v = np.array(sensed["r_I"]), np.array(sensed["v_I"])
    first = nav_of(onboard, sensed)["energy"]
    dt = 0.5
    for _ in range(100):
        half = v - 0.5 * dt * mu * r / np.linalg.norm(r) ** 3
        r = r + dt * half
        v = half - 0.5 * dt * mu * r / np.linalg.norm(r) ** 3
    sensed["r_I"], sensed["v_I"] = r, v
    nav = nav_of(onboard, sensed)
    assert nav["altitude"] < 8e4
    assert nav["energy"] == pytest.approx(first, rel=1e-7)
    assert nav["mach"] == pytest.approx(
        nav["speed"] / model_atmosphere(onboard[0]["atmosphere"], nav["altitude"])[1]
    )


def test_energy_of_navigation_and_of_the_reference_trajectory_agree_at_the_same_altitude_and_speed(onboard):
    """The reference is tabulated over its own energy, flown over a sphere; guidance looks it up with the
    navigated energy.
    """
    planet = onboard[0]["planet"]
    h, v = 10e3, 450.0
    sensed, _, _ = fly_state(onboard, onboard[0]["site"]["latitude"], 1.9, h, v, -0.3, pi, 0.0, 0.0, 0.0)
    nav = nav_of(onboard, sensed)
    reference = 0.5 * v * v + planet["mu"] * (
        1.0 / planet["equatorial_radius"] - 1.0 / (planet["equatorial_radius"] + h)
    )
    assert sqrt(2.0 * nav["energy"]) == pytest.approx(sqrt(2.0 * reference), rel=0.01)
