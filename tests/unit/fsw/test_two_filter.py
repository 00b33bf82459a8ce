"""The velocity and height filters: the fit against numpy's least squares, when they correct, and how well."""

import made_up_belief as belief
import made_up_course as course
import made_up_instruments as instruments
import made_up_landing as landing
import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.filters.two_filter import TWO_FILTER, TwoFilterParams, correct, start
from edl6dof.fsw.navigation.strapdown import level_axes

ONBOARD = belief.onboard_record()


@pytest.fixture(scope="module")
def descent():
    return course.truth(ONBOARD, False)


def flown_by(descent, first, cycles, looks=None, onboard=ONBOARD, excluded=(), bias=0.0, **changes):
    """What the filters do over a piece of the descent, with beams ``excluded``, and a ``bias`` of the speeds
    (m/s); yields cycle, what was and is, readings, memory.
    """
    params = np.zeros(1, dtype_of(TwoFilterParams))
    fill(params[0], TwoFilterParams(**changes))
    records, memory = landing.records(), np.zeros(1, TWO_FILTER)[0]
    sensed, motion, solution, health, _ = (record[0] for record in records)
    health["beam_speed"][list(excluded)] = 0

    def begin(sensed, solution):
        start(params[0], onboard[0], sensed, solution, memory)

    for k in landing.stepped(onboard, descent, first, cycles, begin, records, looks):
        before = solution.copy()
        sensed["radar"]["speed"] += bias
        correct(params[0], onboard[0], health, sensed, motion, solution, memory)
        yield k, before, solution, sensed, memory


def errors(descent, k, solution):
    """Of the height, and of the velocity relative to the planet."""
    planet, r = ONBOARD[0]["planet"], descent[0][k]
    height = level_axes(planet, tuple(solution["r_I"]), solution["t"])[3] - solution["terrain"]
    apart = solution["v_I"] - descent[1][k]
    return height - level_axes(planet, tuple(r), solution["t"])[3], apart - np.cross(
        [0.0, 0.0, course.SPIN], solution["r_I"] - r
    )


def test_the_fit_is_that_of_weighted_least_squares(descent):
    window, rows, residuals, weights, times = 2.0, [], [], [], []
    found = None
    for k, before, _, sensed, memory in flown_by(
        descent, 900, 60, window_s=window, edit=20.0, converged_m_s=1e-6, radar_interval_s=0.0
    ):
        q, v, r = before["q_I2B"], before["v_I"], before["r_I"]
        arm = np.array(instruments.ARM) - np.array(instruments.CENTRE)
        spin = np.array([0.0, 0.0, course.SPIN])
        place = r + np.array(instruments.from_frame(tuple(q), tuple(arm)))
        rate = (descent[3][k] + 1e-7) / course.DT
        swing = np.array(instruments.from_frame(tuple(q), tuple(np.cross(rate, arm))))
        for beam in range(4):
            axis = ONBOARD[0]["instruments"]["beam_axis"][beam]
            u = np.array(instruments.from_frame(tuple(q), tuple(axis)))
            speed = u @ (v - np.cross(spin, place) + swing)
            rows.append(u)
            residuals.append(sensed["radar"]["speed"][beam] - speed)
            weights.append(1.0 / (0.1 / 3.0 + abs(speed) * 0.01 / 3.0) ** 2)
            times.append(k * course.DT)
        found = memory["correction"].copy()
    t = np.array(times) - times[-1]
    fading = np.exp(t / window)
    A = np.hstack([np.array(rows), np.array(rows) * t[:, None]])
    W = np.array(weights) * fading
    # what is believed before, at the start of the piece, fades too
    begun = 900 * course.DT - times[-1]
    prior = np.exp(begun / window) * np.diag([1 / 25.0] * 3 + [1 / 0.05**2] * 3)
    carried = np.block([[np.eye(3), begun * np.eye(3)], [np.zeros((3, 3)), np.eye(3)]])
    information = carried.T @ prior @ carried + A.T @ (W[:, None] * A)
    assert found == pytest.approx(np.linalg.solve(information, A.T @ (W * np.array(residuals))), rel=1e-6)


def test_nothing_is_corrected_before_convergence(descent):
    kept = 0
    for _, before, solution, _, memory in flown_by(descent, 900, 100):
        if memory["converged"] == 0:
            assert np.array_equal(before["v_I"], solution["v_I"])
            kept += 1
        if memory["heights"] < 40:
            assert before["terrain"] == solution["terrain"]
    assert 0 < kept < 60 and memory["converged"] == 1


@pytest.mark.parametrize(
    "beam_state",
    [pytest.param(0, marks=pytest.mark.long), pytest.param(1, marks=pytest.mark.long), 2],
    ids=["sound", "one lost", "one false"],
)
def test_height_and_velocity_are_found(descent, beam_state):
    last = len(descent[0]) - 1
    looks = np.zeros((last + 1, 8), np.int64)
    looks[:1800, 1] = beam_state
    for k, _, solution, _, _ in flown_by(descent, 600, last - 600, looks):
        if k == 1200:
            height, velocity = errors(descent, k, solution)
            assert abs(height) < 8.0 and np.linalg.norm(velocity) < (0.8 if beam_state else 0.5)
    height, velocity = errors(descent, k, solution)
    assert abs(height) < 0.5 and np.linalg.norm(velocity) < 0.1
    assert 0.0 < solution["sigma_v"].max() < 0.05


@pytest.mark.parametrize(("state", "refused"), [(0, 0), (2, 0b0100)], ids=["sound again", "still wrong"])
def test_an_excluded_beam_is_compared_and_not_used(descent, state, refused):
    """So it is used again once it has agreed for long (``watch_beams``)."""
    looks = np.zeros((len(descent[0]), 8), np.int64)
    looks[:, 2] = state
    reported = [
        (int(solution["speeds_refused"]) & 0b0100, int(solution["beams_used"]) & 0b0100)
        for _, _, solution, _, _ in flown_by(descent, 900, 200, looks, excluded=[2])
        if solution["looked"]
    ]
    assert np.mean([one == (refused, 0) for one in reported]) > 0.95
    assert all(used == 0 for _, used in reported)


def two_radars():
    """A belief with a second radar, turned by 45 deg."""
    onboard = ONBOARD.copy()
    unit, lean = onboard[0]["instruments"], np.radians(25.0)
    for k in range(4):
        around = k * np.pi / 2.0
        unit["beam_axis"][4 + k] = np.cos(lean), np.sin(lean) * np.cos(around), np.sin(lean) * np.sin(around)
    unit["n_beams"] = 8
    return onboard


@pytest.mark.parametrize("bias", [-2.0, 4.0])
@pytest.mark.parametrize("beam", [1, 6])
def test_a_biased_beam_is_identified_and_no_other(descent, beam, bias):
    """No reading of another beam counts as wrong; the velocity does not feel the bias."""
    shifts, found = np.zeros(8), []
    shifts[beam] = bias
    for _, _, solution, _, _ in flown_by(descent, 900, 700, onboard=two_radars(), bias=shifts):
        found.append(int(solution["speeds_refused"]))
    assert np.mean([one & ~(1 << beam) != 0 for one in found]) < 0.01
    assert np.mean([one == 1 << beam for one in found[-200:]]) > 0.9
    assert np.linalg.norm(errors(descent, 900 + 699, solution)[1]) < 0.2


def test_one_false_echo_alone_does_not_become_the_velocity(descent):
    """Without another echo for 30 s, by when information from before would have faded to nothing."""
    looks = np.ones((len(descent[0]), 8), np.int64)
    looks[:, 2] = 2
    for _, _, solution, _, _ in flown_by(descent, 900, 600, looks):
        assert solution["beams_used"] == 0
    assert np.linalg.norm(errors(descent, 900 + 599, solution)[1]) < 3.0
