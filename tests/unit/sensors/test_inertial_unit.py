"""The inertial unit against closed forms of rigid-body motion and against its own error parameters.

The Allan variance is computed here, as ``allantools`` would: overlapping, from the count.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from instrument_bench import Bench
from scipy.integrate import trapezoid
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from edl6dof.interface.capacities import MAX_GYROS
from edl6dof.sensors.counters import cone, counter_layout, walk
from edl6dof.sensors.vibration import VIBRATION, oscillate, tone

H = 0.02
DEG = np.pi / 180.0
AXES = [
    {"name": name, "axis": axis} for name, axis in zip("xyz", map(tuple, np.eye(3).tolist()), strict=True)
]
#: Three orthogonal instruments of each kind without any error.
GYROS = {
    "axes": AXES,
    **dict.fromkeys(("bias_deg_h", "bias_walk_deg_h_sqrt_h", "noise_deg_sqrt_h", "scale_ppm"), 0.0),
    **{"misalignment_arcsec": 0.0, "quantum_arcsec": 0.0, "bandwidth_hz": 0.0},
}
ACCELEROMETERS = {
    "axes": AXES,
    **dict.fromkeys(("bias_ug", "bias_walk_ug_sqrt_h", "noise_ug_sqrt_hz", "scale_ppm"), 0.0),
    **{"misalignment_arcsec": 0.0, "quantum_m_s": 0.0},
}


def unit(gyros=None, accelerometers=None, seed=1, case=0, **others):
    """A bench with a unit that is ideal but for what is given."""
    params = {
        **{"delay_cycles": 0, "position_m": (0.0, 0.0, 0.0)},
        **{"gyros": GYROS | (gyros or {}), "accelerometers": ACCELEROMETERS | (accelerometers or {})},
    }
    return Bench("inertial_unit", params | others, seed, case)


def series(bench, cycles, motion=None):
    """Counts of gyros and accelerometers and readings of the rate, shape (cycles, 8) each."""
    if motion is None:
        rows = bench.series(cycles, H, "inertial")
        return rows["angle"], rows["gain"], rows["rate"]
    rows = []
    for k in range(cycles):
        read = bench.measure(t=k * H, **motion(k * H))["inertial"]
        rows.append((read["angle"].copy(), read["gain"].copy(), read["rate"].copy()))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def allan_variance(count, m, h):
    """Overlapping Allan variance at tau = ``m h`` of the rate whose integral is ``count``."""
    second = count[2 * m :] - 2.0 * count[m:-m] + count[: -2 * m]
    return np.mean(second**2) / (2.0 * (m * h) ** 2)


@pytest.fixture(scope="module")
def noisy():
    """A quarter of an hour at rest with white noise and nothing else, six of each kind."""
    white = {"axes": [one.model_dump() for one in cone("g")]}
    bench = unit(white | {"noise_deg_sqrt_h": 0.3}, white | {"noise_ug_sqrt_hz": 50.0})
    return [column[:, :6] for column in series(bench, 45_000)]


@pytest.mark.parametrize("m", [1, 10, 100])
def test_white_noise_has_the_allan_deviation_of_its_random_walk(noisy, m):
    angle, gain, _ = noisy
    tau, n = m * H, 0.3 * DEG / 60.0
    for count, density in ((angle, n), (gain, 50.0 * 9.80665e-6)):
        found = np.mean([allan_variance(count[:, i], m, H) for i in range(6)])
        # six records of T / tau independent differences: five standard deviations of their mean square
        assert found == pytest.approx(density**2 / tau, rel=5.0 * np.sqrt(2.0 * m / (6 * 45_000)))


def test_noise_is_normal_and_independent_in_time_and_from_one_instrument_to_the_next(noisy):
    angle, gain, rate = noisy
    steps = np.hstack([np.diff(angle, axis=0), np.diff(gain, axis=0)])
    steps /= steps.std(axis=0)
    n = len(steps)
    assert np.all(np.abs(steps.mean(axis=0)) < 5.0 / np.sqrt(n))
    assert np.all(np.abs((steps**3).mean(axis=0)) < 5.0 * np.sqrt(15.0 / n))
    assert np.all(np.abs((steps**4).mean(axis=0) - 3.0) < 5.0 * np.sqrt(96.0 / n))
    correlation = steps.T @ steps / n - np.eye(12)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(n)
    assert np.abs((steps[1:] * steps[:-1]).mean(axis=0)).max() < 5.0 / np.sqrt(n)
    assert np.mean(np.abs(steps) > 3.0) == pytest.approx(0.0026998, rel=0.1)
    np.testing.assert_allclose(np.diff(angle, axis=0)[:, 0], rate[1:, 0] * H, rtol=1e-9, atol=1e-13)


def test_random_walk_of_the_bias_has_its_allan_deviation():
    """K^2 tau / 3; of 48 unlike copies, as long records of a walk have few independent stretches."""
    k, found = 3.0 * DEG / 3600.0 / 60.0, []
    for case in range(16):
        bench = unit({"bias_walk_deg_h_sqrt_h": 3.0}, case=case)
        angle, _, _ = series(bench, 4000)
        found += [allan_variance(angle[:, i], 1000, H) for i in range(3)]
    assert np.mean(found) == pytest.approx(k**2 * 20.0 / 3.0, rel=0.6)


def test_bias_has_walked_by_its_coefficient_times_the_root_of_the_time():
    """Standard deviation K sqrt(T) of independent copies; each of three axes walks every 24 cycles."""
    bench, dt = unit({"bias_walk_deg_h_sqrt_h": 3.0}), 0.02
    params, copy = bench.params["gyros"], bench.unit["gyro"]
    ends = []
    for key in range(400):
        copy["key"], memory = 7919 * key, np.zeros(1, counter_layout(MAX_GYROS))[0]
        for cycle in range(240):
            walk(params, copy, dt, cycle, memory)
        ends.append(memory["walk"][:3])
    k = 3.0 * DEG / 3600.0 / 60.0
    assert np.std(ends) == pytest.approx(k * np.sqrt(240 * dt), rel=5.0 / np.sqrt(2.0 * 1200))


def test_errors_of_the_copies_have_the_given_spread_and_differ_from_case_to_case():
    copies = [
        unit({"bias_deg_h": 3.6, "scale_ppm": 100.0, "misalignment_arcsec": 60.0}, case=case).unit["gyro"]
        for case in range(400)
    ]
    biases = np.array([copy["bias"][:3] for copy in copies])
    scales = np.array([copy["scale"][:3] for copy in copies])
    off = np.array([copy["axis"][:3] for copy in copies]) - np.eye(3)
    across = off[:, ~np.eye(3, dtype=bool)]
    for values, sigma in ((biases, 3.6 * DEG / 3600.0), (scales, 1e-4), (across, DEG / 60.0)):
        assert values.std() == pytest.approx(sigma, rel=5.0 / np.sqrt(2.0 * values.size))
        assert abs(values.mean()) < 5.0 * sigma / np.sqrt(values.size)
    assert len(set(biases.ravel())) == biases.size


def test_reading_is_scale_times_motion_along_the_true_axis_plus_bias():
    bench = unit({"bias_deg_h": 500.0, "scale_ppm": 1e4, "misalignment_arcsec": 3600.0})
    w = np.array([0.1, -0.2, 0.3])
    angle, _, rate = series(
        bench, 101, lambda t: {"q": Rotation.from_rotvec(w * t).as_quat(scalar_first=True), "w": w}
    )
    copy = bench.unit["gyro"]
    expected = (1.0 + copy["scale"][:3]) * (copy["axis"][:3] @ w) + copy["bias"][:3]
    np.testing.assert_allclose(rate[-1, :3], expected, rtol=1e-12)
    np.testing.assert_allclose(angle[-1, :3], expected * 100 * H, rtol=1e-9)


def test_gyros_count_the_integral_of_the_rate_under_coning():
    """A body axis on a cone: the rate about x is constant though the attitude returns each turn."""
    cone_angle, pulsation = 0.05, 2.0 * np.pi

    def motion(t):
        half, phase = 0.5 * cone_angle, pulsation * t
        q = [np.cos(half), 0.0, np.sin(half) * np.cos(phase), np.sin(half) * np.sin(phase)]
        s = pulsation * np.sin(cone_angle)
        return {
            "q": q,
            "w": [-2.0 * pulsation * np.sin(half) ** 2, -s * np.sin(phase), s * np.cos(phase)],
        }

    angle, _, _ = series(unit(), 1001, motion)
    drift = -2.0 * pulsation * np.sin(0.5 * cone_angle) ** 2 * 20.0
    assert abs(drift) > 0.1
    assert angle[-1, 0] == pytest.approx(drift, rel=1e-3)  # fourth order in a twentieth of a turn
    np.testing.assert_allclose(angle[-1, 1:3], 0.0, atol=1e-4)


def test_accelerometers_feel_the_lever_arm():
    """A unit at ``l`` on a body that turns about its centre of mass at rest: the count is the integral of
    C' d2(C l)/dt2, done here numerically.
    """
    arm = np.array([0.4, -0.3, 0.7])
    bench = unit(position_m=tuple(arm + np.array([-0.8, 0.1, 0.0])))
    bench.outputs["centre"] = (-0.8, 0.1, 0.0)

    def attitude(t):
        return Rotation.from_euler("zyx", np.array([0.3 * t + 0.1 * t**2, 0.2 * np.sin(1.3 * t), 0.4 * t]).T)

    e = 1e-4

    def motion(t):
        turn = (attitude(t - e).inv() * attitude(t + e)).as_rotvec() / (2.0 * e)
        return {"q": attitude(t).as_quat(scalar_first=True), "w": turn}

    _, gain, _ = series(bench, 201, motion)
    fine, e = np.linspace(0.0, 4.0, 8001), 1e-3
    before, now, after = (attitude(fine + k * e).apply(arm) for k in (-1, 0, 1))
    felt = attitude(fine).inv().apply((before - 2 * now + after) / e**2)
    expected = np.trapezoid(felt, fine, axis=0)
    assert np.abs(expected).max() > 0.5
    np.testing.assert_allclose(gain[-1, :3], expected, atol=2e-4)


def test_what_the_centre_of_mass_gains_and_separations_push_is_counted():
    bench = unit(accelerometers={"axes": AXES})
    bench.measure(t=0.0)
    bench.plant["velocity_gain"], bench.plant["separation_gain"] = (1.0, 2.0, 3.0), (-0.25, 0.0, 0.5)
    read = bench.measure(t=H)["inertial"]
    np.testing.assert_allclose(read["gain"][:3], (0.75, 2.0, 3.5), rtol=1e-15)


def test_count_comes_in_whole_quanta_and_loses_nothing():
    w, quantum = np.array([1e-4, 2e-5, -3e-4]), 5.0 * DEG / 3600.0
    bench = unit({"quantum_arcsec": 5.0})
    angle, _, _ = series(
        bench, 501, lambda t: {"q": Rotation.from_rotvec(w * t).as_quat(scalar_first=True), "w": w}
    )
    whole = angle[:, :3] / quantum
    np.testing.assert_allclose(whole, np.round(whole), atol=1e-6)
    behind = np.outer(H * np.arange(501), w) - angle[:, :3]
    assert behind.min() > -1e-9 and behind.max() < quantum * (1.0 + 1e-6) and behind.max() > 0.8 * quantum


def test_range_clips_and_raises_a_flag_that_stays_a_while():
    bench = unit({"range_deg_s": 100.0, "persistence_s": 0.1})
    turned, flags, angles, rates = 0.0, [], [], []
    for k in range(40):
        w = 200.0 * DEG if 10 <= k < 20 else 50.0 * DEG
        turned += w * H if k else 0.0
        q = Rotation.from_rotvec([0.0, 0.0, turned]).as_quat(scalar_first=True)
        read = bench.measure(t=k * H, q=q, w=[0.0, 0.0, w])["inertial"]
        flags.append(int(read["gyro_saturated"][2]))
        angles.append(float(read["angle"][2]))
        rates.append(float(read["rate"][2]))
    assert (
        flags == [0] * 10 + [1] * 10 + [1] * 5 + [0] * 15 or flags == [0] * 10 + [1] * 10 + [1] * 4 + [0] * 16
    )
    assert angles[-1] == pytest.approx((29 * 50.0 + 10 * 100.0) * DEG * H)
    assert max(rates) == pytest.approx(100.0 * DEG)
    assert not bench.sensed["inertial"]["gyro_saturated"][:2].any()


def test_rate_reading_lags_as_its_bandwidth_says():
    bench = unit({"bandwidth_hz": 2.0})
    bench.measure(t=0.0, w=[0.0, 0.0, 0.0])
    for k in range(1, 11):
        read = bench.measure(t=k * H, w=[1.0, 0.0, 0.0])["inertial"]["rate"][0]
        assert read == pytest.approx(1.0 - np.exp(-2.0 * np.pi * 2.0 * k * H), rel=1e-12)


def test_vibration_has_its_amplitude_at_full_thrust_and_vanishes_with_it():
    tone = {"frequency_hz": 7.0, "rate_deg_s": 2.0, "acceleration_m_s2": 0.5}
    bench = unit(vibration=tone)
    bench.measure(t=-H)
    bench.outputs["engine_thrust"] = 0.5 * 7500.0
    angle, gain, rate = (column[1:, :3] for column in series(bench, 5001))
    assert rate.std(axis=0) == pytest.approx(np.full(3, 1.0 * DEG / np.sqrt(2.0)), rel=1e-2)
    pulsation = 2.0 * np.pi * 7.0
    for count, amplitude in ((angle, 1.0 * DEG / pulsation), (gain, 0.25 / pulsation)):
        swing = count - count.mean(axis=0)
        assert swing.std(axis=0) == pytest.approx(np.full(3, amplitude / np.sqrt(2.0)), rel=1e-2)
    np.testing.assert_allclose(  # the count is the integral of the rate
        np.gradient(angle[:, 0], H)[1:-1], np.sinc(2.0 * 7.0 * H) * rate[1:-1, 0], atol=0.1 * DEG
    )
    bench.outputs["engine_thrust"] = 0.0
    read = bench.measure(t=5001 * H)["inertial"]
    assert np.all(read["rate"] == 0.0) and np.abs(read["gain"]).max() < 1e-12


def covariance(variance, frequency, width, window, lag):
    """Of two samples ``lag`` (s) apart of what ``window`` (of f) makes of a random motion with one half-power
    band ``width`` about ``frequency`` (Hz): the integral of its spectrum, without any oscillator.
    """
    f = np.geomspace(1e-4, 1e6, 200_001)
    band = (width * f) ** 2 / ((f * f - frequency**2) ** 2 + (width * f) ** 2)
    spectrum = variance * band / trapezoid(band, f)
    return trapezoid(spectrum * window(f) * np.cos(2.0 * np.pi * f * lag), f)


@pytest.mark.parametrize(
    ("frequency", "width"), [(12.0, 8.0), pytest.param(200.0, 200.0, marks=pytest.mark.long)]
)
def test_random_vibration_has_the_spectrum_of_its_parameters(frequency, width):
    """Variance and covariances of the increments of the counts and of the rate, over five minutes."""
    random = {"frequency_hz": frequency, "bandwidth_hz": width, "rate_deg_s": 2.0, "acceleration_g0": 0.1}
    bench = unit(vibration={"rate_deg_s": 0.0, "acceleration_m_s2": 0.0, "random": random})
    bench.outputs["engine_thrust"] = 0.5 * 7500.0
    angle, velocity, rate = (column[50:, :3] for column in series(bench, 15_000))

    def increment(f):
        return (np.sin(np.pi * f * H) / (np.pi * f)) ** 2

    for rows, deviation, window in (
        (np.diff(velocity, axis=0), 0.5 * 0.1 * 9.80665, increment),
        (np.diff(angle, axis=0), 1.0 * DEG, increment),
        (rate, 1.0 * DEG, np.ones_like),
    ):
        whole = covariance(deviation**2, frequency, width, window, 0.0)
        for lag in range(4):
            product = np.mean(rows[lag:] * rows[: len(rows) - lag])
            expected = covariance(deviation**2, frequency, width, window, lag * H)
            assert product == pytest.approx(expected, abs=0.04 * whole), (deviation, lag)
        assert np.abs(np.corrcoef(rows.T) - np.eye(3)).max() < 0.05  # each axis by itself


def test_turn_of_the_tone_is_the_integral_of_its_rate_about_every_axis():
    params = SimpleNamespace(frequency=40.0, rate=0.3, acceleration=5.0)
    mount, h = SimpleNamespace(phase=(0.4, 1.7, 4.1)), 1e-6
    for t in (0.0, 0.013, 1.2345):
        rate, turn, swing = tone.py_func(params, mount, 0.8, t)
        after, before = (np.array(tone.py_func(params, mount, 0.8, t + s)[1]) for s in (h, -h))
        assert (after - before) / (2.0 * h) == pytest.approx(rate, abs=1e-6)
        assert swing == pytest.approx(np.array(turn) * 5.0 / 0.3, rel=1e-12)


def test_random_vibration_is_a_damped_oscillator_that_noise_keeps_in_its_stationary_state(monkeypatch):
    """Place and speed (over the pulsation) in standard deviations: the transition is the matrix exponential,
    and what it takes from the unit covariance comes back as noise.
    """
    dt, pulsation, decay = 0.004, 2.0 * np.pi * 30.0, np.pi * 25.0
    params = np.zeros(1, [("frequency", "f8"), ("bandwidth", "f8")]).view(np.recarray)[0]
    params["frequency"], params["bandwidth"] = 30.0, 25.0
    memory, kernel = np.zeros(1, VIBRATION).view(np.recarray)[0], oscillate.py_func

    def after(place, speed, *normals):
        monkeypatch.setitem(kernel.__globals__, "normal_pair", lambda *_: normals)
        memory["place"], memory["speed"] = place, speed
        kernel(params, 7, dt, 0, memory)
        return memory["place"][-1], memory["speed"][-1]

    transition = np.column_stack([after(1.0, 0.0, 0.0, 0.0), after(0.0, 1.0, 0.0, 0.0)])
    root = np.column_stack([after(0.0, 0.0, 1.0, 0.0), after(0.0, 0.0, 0.0, 1.0)])
    exact = expm(dt * np.array([[0.0, pulsation], [-pulsation, -2.0 * decay]]))
    assert transition == pytest.approx(exact, rel=1e-12)
    assert root @ root.T == pytest.approx(np.eye(2) - exact @ exact.T, rel=1e-12)


def test_band_of_random_vibration_wider_than_an_oscillator_has_is_refused():
    with pytest.raises(ValueError, match="below two times frequency_hz"):
        unit(vibration={"random": {"frequency_hz": 50.0, "bandwidth_hz": 100.0}})


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_reading_arrives_some_cycles_late(delay):
    bench = unit(delay_cycles=delay)
    seen = [bench.measure(t=k * H, w=[0.01 * k, 0.0, 0.0])["inertial"]["rate"][0] for k in range(20)]
    assert seen == pytest.approx([0.01 * max(k - delay, 0) for k in range(20)])


def test_default_axes_measure_every_direction_equally_well():
    axes = np.array([one.axis for one in cone("g")])
    np.testing.assert_allclose(axes.T @ axes, 2.0 * np.eye(3), atol=1e-15)
    assert [one.name for one in cone("a")] == ["a1", "a2", "a3", "a4", "a5", "a6"]
