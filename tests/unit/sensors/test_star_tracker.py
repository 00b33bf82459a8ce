"""Star tracker, ground tracking and switches: errors with the given spread, at the given times."""

import numpy as np
import pytest
from instrument_bench import Bench
from scipy.spatial.transform import Rotation

ARCSEC = np.pi / 180.0 / 3600.0
TRUE = Rotation.from_rotvec([0.4, -1.0, 0.7])


def off(bench, head=0):
    """Rotation vector (B, arcsec) by which the attitude read is off the true one."""
    read = Rotation.from_quat(bench.sensed["stars"]["q_I2B"][head], scalar_first=True)
    return (TRUE.inv() * read).as_rotvec() / ARCSEC


def tracker(case=0, altitude=125e3, **params):
    heads = [{"name": "s1", "axis": (0.0, 0.6, 0.8)}, {"name": "s2", "axis": (1.0, 0.0, 0.0)}]
    bench = Bench("star_tracker", {"every_cycles": 1, "heads": heads} | params, case=case)
    bench.put(q=TRUE.as_quat(scalar_first=True))
    bench.outputs["altitude"] = altitude
    return bench


def test_noise_is_that_about_the_boresight_and_across_it():
    bench = tracker(noise_arcsec=5.0, boresight_noise_arcsec=50.0, misalignment_arcsec=0.0)
    errors = []
    for _ in range(1200):
        assert bench.measure()["stars"]["valid"][0] == 1
        errors.append(off(bench))
    about = np.array(errors) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [0.0, 0.6, 0.8]]).T
    assert about.std(axis=0) == pytest.approx([5.0, 5.0, 50.0], rel=5.0 / np.sqrt(2400.0))
    assert np.all(np.abs(about.mean(axis=0)) < 5.0 * about.std(axis=0) / np.sqrt(1200.0))


def test_heads_have_errors_of_their_own_each_about_its_own_boresight():
    bench = tracker(noise_arcsec=0.0, boresight_noise_arcsec=50.0, misalignment_arcsec=0.0)
    errors = []
    for _ in range(1200):
        bench.measure()
        errors.append((off(bench) @ (0.0, 0.6, 0.8), off(bench, 1)[0]))
        assert np.abs(off(bench, 1)[1:]).max() < 1e-6
    errors = np.array(errors)
    assert errors.std(axis=0) == pytest.approx(50.0, rel=5.0 / np.sqrt(2400.0))
    assert abs(np.corrcoef(errors.T)[0, 1]) < 5.0 / np.sqrt(1200.0)


def test_noise_across_the_boresight_does_not_turn_about_it():
    bench = tracker(noise_arcsec=5.0, boresight_noise_arcsec=0.0, misalignment_arcsec=0.0)
    for _ in range(20):
        bench.measure()
        assert off(bench) @ (0.0, 0.6, 0.8) == pytest.approx(0.0, abs=1e-6)
        assert np.linalg.norm(off(bench)) > 0.1


def test_alignment_is_off_by_the_same_all_through_a_case():
    ideal = {"noise_arcsec": 0.0, "boresight_noise_arcsec": 0.0, "misalignment_arcsec": 20.0}
    errors = []
    for case in range(200):
        bench = tracker(case, **ideal)
        bench.measure()
        errors.append(off(bench))
        bench.measure()
        np.testing.assert_allclose(off(bench), errors[-1], rtol=1e-6)
    assert np.std(errors) == pytest.approx(20.0, rel=5.0 / np.sqrt(1200.0))


def test_sees_no_stars_below_the_lowest_altitude_nor_when_it_turns_fast_and_keeps_its_own_rate():
    bench = tracker(lowest_m=100e3, rate_deg_s=1.0, every_cycles=3)
    assert [int(bench.measure()["stars"]["valid"][0]) for _ in range(7)] == [1, 0, 0, 1, 0, 0, 1]
    for altitude, w, valid in ((99e3, 0.0, 0), (101e3, 0.0, 1), (101e3, 0.02, 0), (101e3, 0.017, 1)):
        bench = tracker(lowest_m=100e3, rate_deg_s=1.0, altitude=altitude)
        assert bench.measure(w=[0.0, w, 0.0])["stars"]["valid"][0] == valid


def test_sees_no_stars_once_the_event_that_ends_its_view_has_happened():
    bench = tracker()
    bench.unit["until"] = 2
    seen = []
    for t, done in ((1.0, np.nan), (2.0, 2.5), (2.5, 2.5), (9.0, 2.5)):
        bench.plant["done"][1], bench.plant["t"] = done, t
        seen.append(int(bench.measure()["stars"]["valid"][0]))
    assert seen == [1, 1, 0, 0]
    bench.unit["until"] = 0
    assert bench.measure()["stars"]["valid"][0] == 1


def test_tracking_arrives_once_with_the_error_of_the_case_along_the_track():
    position, velocity = [], []
    r, v = np.array([3.4e6, 1e6, -5e5]), np.array([500.0, -1000.0, 4500.0])
    for case in range(300):
        bench = Bench(
            "ground_tracking",
            {"position_m": (100.0, 400.0, 30.0), "velocity_m_s": (0.1, 0.2, 0.3)},
            case=case,
        )
        sent = bench.measure(r=r, v=v)["tracking"]
        assert sent["fresh"] == 1
        radial, normal = r / np.linalg.norm(r), np.cross(r, v) / np.linalg.norm(np.cross(r, v))
        axes = np.array([radial, np.cross(normal, radial), normal])
        position.append(axes @ (sent["r_I"] - r))
        velocity.append(axes @ (sent["v_I"] - v))
        assert axes[1] @ v > 0.0
        before = sent["r_I"].copy()
        again = bench.measure(r=2.0 * r)["tracking"]
        assert again["fresh"] == 0 and np.array_equal(again["r_I"], before)
    tolerance = 5.0 / np.sqrt(600.0)
    assert np.std(position, axis=0) == pytest.approx([100.0, 400.0, 30.0], rel=tolerance)
    assert np.std(velocity, axis=0) == pytest.approx([0.1, 0.2, 0.3], rel=tolerance)


@pytest.mark.parametrize("pads, opening, said", [(0, 0.0, (0, 0)), (2, 0.94, (1, 0)), (0, 0.96, (0, 1))])
def test_switches_say_what_touches_and_what_is_open(pads, opening, said):
    bench = Bench("switches")
    bench.outputs["pads"], bench.outputs["wing_opening"] = pads, opening
    sensed = bench.measure()
    assert (sensed["footpad_contact"], sensed["wing_open"]) == said
