"""The landing radar against rays to an ellipsoid and a plane worked out here, and its losses and errors."""

import numpy as np
import pytest
from instrument_bench import Bench
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from edl6dof.environment.terrain import NONE, PLANE
from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE

IDEAL = {
    **dict.fromkeys(("dropout", "misalignment_deg", "range_noise_m", "range_noise_relative_pct"), 0.0),
    **dict.fromkeys(
        ("range_scale_pct", "reflectivity_m", "speed_noise_m_s", "speed_noise_relative_pct"), 0.0
    ),
    **{"speed_scale_pct": 0.0, "every_cycles": 1},
}
LAT, LON = np.radians(25.066), np.radians(109.925)
UP = np.array([np.cos(LAT) * np.cos(LON), np.cos(LAT) * np.sin(LON), np.sin(LAT)])
EAST = np.array([-np.sin(LON), np.cos(LON), 0.0])
NORTH = np.cross(UP, EAST)
A, F = 3396190.0, 1.0 / 169.89444722361179
#: Attitude with x of B straight down, y east.
DOWN = Rotation.from_matrix(np.column_stack([-UP, EAST, np.cross(-UP, EAST)]))


def surface(latitude, longitude, altitude):
    n = A / np.sqrt(1.0 - F * (2.0 - F) * np.sin(latitude) ** 2)
    flat = (n + altitude) * np.cos(latitude)
    z = (n * (1.0 - F) ** 2 + altitude) * np.sin(latitude)
    return np.array([flat * np.cos(longitude), flat * np.sin(longitude), z])


def radar(height, attitude=DOWN, case=0, model=NONE, v=(0.0, 0.0, 0.0), **params):
    """A radar over the landing site; ``v`` (I) relative to the turning planet."""
    bench = Bench("radar", IDEAL | params, case=case)
    planet, terrain = bench.case["planet"], bench.case["terrain"]
    assert planet["equatorial_radius"] == A and abs(planet["flattening"] - F) < 1e-12
    terrain["model"] = model
    bench.plant["inputs"]["areoid"] = 0.0
    bench.plant["shape"] = CONFIG_BACKSHELL
    ground = terrain["site_elevation"] if model == PLANE else 0.0
    r = surface(LAT, LON, height + ground)
    spin = np.array([0.0, 0.0, planet["rotation_rate"]])
    bench.put(r=r, v=np.asarray(v) + np.cross(spin, r), q=attitude.as_quat(scalar_first=True))
    return bench


def beams(bench, attitude=DOWN):
    """Antenna (I, at t = 0 also F) and directions of the beams."""
    r = bench.plant["y"][:3] + attitude.apply(bench.params["position"] - bench.outputs["centre"])
    return r, attitude.apply(bench.unit["axis"][: bench.params["n_beams"]])


def test_range_is_that_of_the_ray_to_the_ellipsoid():
    for height, tilt in ((6500.0, 20.0), (1200.0, 40.0), (30.0, -10.0)):
        attitude = DOWN * Rotation.from_rotvec(np.radians([5.0, tilt, 3.0]))
        bench = radar(height, attitude, incidence_deg=80.0)
        bench.outputs["centre"] = (-0.9, 0.02, -0.1)
        read = bench.measure()["radar"]
        r, u = beams(bench, attitude)
        squash = np.array([1.0, 1.0, 1.0 / (1.0 - F)])
        for k, beam in enumerate(u):  # |S (r + x u)| = A
            p, d = squash * r, squash * beam
            half, c = p @ d, p @ p - A * A
            x = (-half - np.sqrt(half**2 - (d @ d) * c)) / (d @ d)
            assert read["locked"][k] == 1
            assert read["range"][k] == pytest.approx(x, abs=2e-3)
    assert read["fresh"] == 1 and not read["locked"][4:].any()


def test_range_is_that_to_sloping_ground():
    """The plane of the site: its height above the ellipsoid at the foot of the beam, by bisection."""
    bench = radar(700.0, model=PLANE, incidence_deg=80.0)
    terrain = bench.case["terrain"]
    terrain["tilt_north"], terrain["tilt_east"], terrain["slope_radius"] = 0.08, -0.15, 2000.0
    read = bench.measure()["radar"]
    r, u = beams(bench)

    def clearance(x, beam):
        p = r + x * beam
        longitude, axis, latitude = np.arctan2(p[1], p[0]), np.hypot(p[0], p[1]), LAT
        for _ in range(20):  # fixed point of the textbook
            n = A / np.sqrt(1.0 - F * (2.0 - F) * np.sin(latitude) ** 2)
            latitude = np.arctan2(p[2] + F * (2.0 - F) * n * np.sin(latitude), axis)
        altitude = axis / np.cos(latitude) - n
        north, east = (
            terrain["radius"] * (latitude - LAT),
            terrain["radius"] * np.cos(LAT) * (longitude - LON),
        )
        return altitude - (terrain["site_elevation"] + 0.08 * north - 0.15 * east)

    exact = [brentq(clearance, 100.0, 3000.0, args=(beam,), xtol=1e-6) for beam in u]
    np.testing.assert_allclose(read["range"][:4], exact, atol=2e-3)
    assert np.ptp(exact) > 30.0


def test_speed_is_how_fast_the_ground_at_the_foot_comes_nearer():
    """A finite difference of the distance from the moving, turning body to the foot of each beam."""
    attitude = DOWN * Rotation.from_rotvec([0.1, 0.2, -0.3])
    v, w = np.array([30.0, -12.0, 7.0]) - 60.0 * UP, np.array([0.3, -0.2, 0.4])
    bench = radar(900.0, attitude, v=v, position_m=(1.0, -2.0, 0.5))
    bench.put(w=w)
    read = bench.measure()["radar"]
    r, u = beams(bench, attitude)
    foot = r + read["range"][:4, None] * u
    h, centre = 1e-3, bench.plant["y"][:3]
    turning = w - attitude.inv().apply([0.0, 0.0, bench.case["planet"]["rotation_rate"]])  # of the ground
    arm = bench.params["position"] - bench.outputs["centre"]

    def distance(t):
        turned = attitude * Rotation.from_rotvec(turning * t)
        return np.linalg.norm(foot - (centre + v * t + turned.apply(arm)), axis=1)

    np.testing.assert_allclose(read["speed"][:4], -(distance(h) - distance(-h)) / (2.0 * h), atol=1e-5)
    assert np.ptp(read["speed"][:4]) > 1.0


@pytest.mark.parametrize(
    "height, tilt, given, locked",
    [
        (1000.0, 0.0, {}, 4),
        (7010.0, 0.0, {}, 0),
        (4.0, 0.0, {"position_m": (0.0, 0.0, 0.0)}, 0),
        (6.0, 0.0, {"position_m": (0.0, 0.0, 0.0)}, 4),
        (1000.0, 50.0, {"incidence_deg": 85.0}, 0),
        (1000.0, 44.0, {"incidence_deg": 85.0}, 4),
        (1000.0, 44.0, {"incidence_deg": 50.0}, 2),
    ],
)
def test_height_tilt_and_incidence_decide_which_beams_have_an_echo(height, tilt, given, locked):
    attitude = DOWN * Rotation.from_rotvec([0.0, np.radians(tilt), 0.0])
    read = radar(height, attitude, **given).measure()["radar"]
    assert read["locked"].sum() == locked
    assert np.all((read["range"] > 0.0) == (read["locked"] == 1))


def test_sees_nothing_through_the_heat_shield_and_measures_at_its_own_rate():
    bench = radar(1000.0, every_cycles=3)
    assert [int(bench.measure()["radar"]["fresh"]) for _ in range(5)] == [1, 0, 0, 1, 0]
    bench = radar(1000.0)
    bench.plant["shape"] = CONFIG_CAPSULE
    assert not bench.measure()["radar"]["locked"].any()


def leave(bench, place, v=(0.0, 0.0, 0.0)):
    """Let a part fly at ``place``, at ``v`` relative to the planet."""
    part = bench.plant["debris"][0]
    spin = np.array([0.0, 0.0, bench.case["planet"]["rotation_rate"]])
    part["active"], part["r_I"], part["v_I"] = 3, place, np.asarray(v) + np.cross(spin, place)


@pytest.mark.parametrize(
    "distance, off_deg, seen",
    [(300.0, 2.0, True), (300.0, 3.0, False), (40.0, 14.0, True), (40.0, 16.0, False), (2500.0, 0.0, False)],
)
def test_beam_locks_on_a_part_inside_its_lobes_and_on_no_other(distance, off_deg, seen):
    bench = radar(1000.0, v=-50.0 * UP)
    r, u = beams(bench)
    across = np.cross(u[0], UP) / np.linalg.norm(np.cross(u[0], UP))
    to_part = np.cos(np.radians(off_deg)) * u[0] + np.sin(np.radians(off_deg)) * across
    leave(bench, r + distance * to_part, v=-80.0 * UP)
    read = bench.measure()["radar"]
    if seen:
        assert read["range"][0] == pytest.approx(distance)
        assert read["speed"][0] == pytest.approx(-30.0 * -UP @ to_part)
    else:
        assert read["range"][0] == pytest.approx(1000.0 / np.cos(np.radians(25.0)), rel=1e-3)
    assert read["range"][1:4] == pytest.approx([1000.0 / np.cos(np.radians(25.0))] * 3, rel=1e-3)


def readings(bench, n, name):
    rows = []
    for _ in range(n):
        radar_ = bench.measure()["radar"]
        rows.append(np.where(radar_["locked"][:4] == 1, radar_[name][:4], np.nan))
    return np.array(rows)


def test_noise_has_its_two_parts_and_echoes_are_lost_as_often_as_given():
    ideal = radar(1000.0, v=-50.0 * UP).measure()["radar"].copy()
    given = {"range_noise_m": 0.5, "range_noise_relative_pct": 0.1, "speed_noise_m_s": 0.1}
    bench = radar(1000.0, v=-50.0 * UP, **given, dropout=0.1)
    found = readings(bench, 1200, "range") - ideal["range"][:4]
    lost = np.isnan(found).mean()
    assert lost == pytest.approx(0.1, abs=5.0 * np.sqrt(0.09 / 4800.0))
    assert np.nanstd(found) == pytest.approx(0.5 + 1e-3 * ideal["range"][0], rel=5.0 / np.sqrt(2.0 * 4320.0))
    assert np.abs(np.nanmean(found, axis=0)).max() < 0.15
    closing = readings(bench, 800, "speed") - ideal["speed"][:4]
    assert np.nanstd(closing) == pytest.approx(0.1, rel=5.0 / np.sqrt(2.0 * 2880.0))


def test_scale_and_reflectivity_are_drawn_for_each_beam_and_case():
    ideal = radar(1000.0).measure()["radar"]["range"][:4].copy()
    shifted = [
        radar(1000.0, case=case, reflectivity_m=2.0, range_scale_pct=1.0).measure()["radar"]["range"][:4]
        - ideal
        for case in range(100)
    ]
    assert np.std(shifted) == pytest.approx(np.hypot(2.0, 0.01 * ideal[0]), rel=5.0 / np.sqrt(800.0))


def test_reading_is_the_truth_times_the_scale_of_the_beam_plus_its_shift():
    v = 40.0 * EAST - 60.0 * UP
    ideal = radar(1000.0, v=v).measure()["radar"].copy()
    bench = radar(1000.0, v=v, range_scale_pct=1.0, speed_scale_pct=2.0, reflectivity_m=3.0)
    read, unit = bench.measure()["radar"], bench.unit
    exact = (1.0 + unit["range_scale"][:4]) * ideal["range"][:4] + unit["reflectivity"][:4]
    assert read["range"][:4] == pytest.approx(exact, rel=1e-12)
    exact = (1.0 + unit["speed_scale"][:4]) * ideal["speed"][:4]
    assert read["speed"][:4] == pytest.approx(exact, rel=1e-12)
    drawn = [
        radar(1000.0, case=case, range_scale_pct=1.0, speed_scale_pct=2.0)
        .unit[["range_scale", "speed_scale"]]
        .tolist()
        for case in range(100)
    ]
    assert np.std(np.array(drawn)[..., :4], axis=(0, 2)) == pytest.approx(
        [0.01, 0.02], rel=5.0 / np.sqrt(800.0)
    )


def test_faults_add_their_noise_and_offset_to_their_own_beam():
    """Noise of a fault is independent of that of the radar itself: the variances add."""
    v = -50.0 * UP
    ideal = radar(1000.0, v=v).measure()["radar"].copy()
    bench = radar(1000.0, v=v, range_noise_m=0.5, speed_noise_m_s=0.1, speed_noise_relative_pct=1.0)
    faults = bench.plant["instruments"]
    faults["range"]["noise"][1], faults["range"]["offset"][1] = 2.0, 7.0
    faults["speed"]["noise"][2], faults["speed"]["offset"][2] = 3.0, -5.0
    rows = bench.series(2000, 0.02, "radar")
    tolerance = 5.0 / np.sqrt(4000.0)
    off = rows["range"][:, :4] - ideal["range"][:4]
    assert off.std(axis=0) == pytest.approx([0.5, np.hypot(0.5, 2.0), 0.5, 0.5], rel=tolerance)
    assert off.mean(axis=0) == pytest.approx([0.0, 7.0, 0.0, 0.0], abs=5.0 * 2.1 / np.sqrt(2000.0))
    off = rows["speed"][:, :4] - ideal["speed"][:4]
    own = 0.1 + 0.01 * abs(ideal["speed"][0])
    assert off.std(axis=0) == pytest.approx([own, own, np.hypot(own, 3.0), own], rel=tolerance)
    assert off.mean(axis=0) == pytest.approx([0.0, 0.0, -5.0, 0.0], abs=5.0 * 3.1 / np.sqrt(2000.0))


def test_dust_takes_echoes_and_blurs_the_speed_near_the_ground_under_thrust():
    dust = {"dust": {"height_m": 20.0, "speed_noise_m_s": 2.0, "dropout": 0.4}}
    place = {"position_m": (0.0, 0.0, 0.0)}
    for height, thrust, noise, lost in (
        (10.0, 7500.0, 1.0, 0.2),
        (10.0, 0.0, 0.0, 0.0),
        (25.0, 7500.0, 0.0, 0.0),
    ):
        bench = radar(height, **dust, **place)
        bench.outputs["engine_thrust"] = thrust
        found = readings(bench, 500, "speed")
        assert np.nanstd(found) == pytest.approx(noise, rel=5.0 / np.sqrt(2.0 * 1600.0), abs=1e-9)
        assert np.isnan(found).mean() == pytest.approx(lost, abs=0.045 if lost else 0.0)


def test_errors_of_range_and_speed_of_all_beams_are_independent():
    """Noise of the radar, of a fault and of the dust together: no correlation beyond that of the sample."""
    dust = {"height_m": 20.0, "speed_noise_m_s": 1.0, "dropout": 0.0}
    bench = radar(10.0, position_m=(0.0, 0.0, 0.0), range_noise_m=0.5, speed_noise_m_s=0.5, dust=dust)
    bench.outputs["engine_thrust"] = 7500.0
    faults = bench.plant["instruments"]
    faults["range"]["noise"], faults["speed"]["noise"] = 0.5, 0.5
    rows = bench.series(4000, 0.02, "radar")
    off = np.hstack([rows[name][:, :4] for name in ("range", "speed")])
    assert off.std(axis=0) == pytest.approx(np.sqrt([0.5] * 4 + [0.75] * 4), rel=5.0 / np.sqrt(8000.0))
    assert np.abs(np.corrcoef(off.T) - np.eye(8)).max() < 5.0 / np.sqrt(4000.0)
