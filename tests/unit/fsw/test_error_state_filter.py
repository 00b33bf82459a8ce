"""The error-state filter against a textbook filter, against exact transitions and derivatives, and what it
does with beams that lie or are lost.
"""

import made_up_belief as belief
import made_up_course as course
import made_up_instruments as instruments
import made_up_landing as landing
import numpy as np
import pytest
from as_flown import as_flown
from scipy.linalg import expm
from textbook_filter import TextbookFilter, matrix, skew

from edl6dof.fsw.navigation.filters.error_state import correct, start
from edl6dof.fsw.navigation.filters.kalman.covariance import axes_covariance
from edl6dof.fsw.navigation.filters.kalman.measurement_update import (
    median,
    refused_again,
    update_by_stars,
    weighted_noise,
)
from edl6dof.fsw.navigation.filters.kalman.radar_update import range_row, speed_row
from edl6dof.fsw.navigation.filters.kalman.states import ACTING, MOVING, STATES, WIDTH, fill_transition
from edl6dof.fsw.navigation.radar_beams import expected_range, ground_normal, place_antenna
from edl6dof.fsw.navigation.strapdown import level_axes

ONBOARD, PARAMS = belief.onboard_record(), belief.params_record()
#: Every reading counts fully, as in the textbook.
ALL_COUNT = belief.params_record(gate=20.0, huber=20.0, gravity_m_s2=1e-3)
UNSURE = belief.params_record(unknown_rate_deg_s=60.0)
FILL_TRANSITION = "mu, r_I, memory.interval, memory.transition"
#: Rise of the ground towards north and east, in the derivatives.
SLOPE = np.array([0.2, -0.1])
CENTRE, ARM = np.array(instruments.CENTRE), np.array(instruments.ARM)


@pytest.fixture(scope="module")
def descent():
    return course.truth(ONBOARD, False)


def whole(memory):
    """The covariance of states and considered errors together."""
    full = np.diag(memory["considered"]).astype(float)
    full[:STATES] = memory["covariance"]
    full[STATES:, :STATES] = memory["covariance"][:, STATES:].T
    return full


def followed(onboard, params, flown, first, cycles):
    """Let filter and textbook follow a piece of a flight; yields both after each cycle that had readings."""
    records = landing.records()
    sensed, motion, solution, health, memory = (record[0] for record in records)
    book = TextbookFilter(
        *(onboard[0]["instruments"], onboard[0]["planet"], onboard[0]["site"]["altitude"]),
        params[0][["terrain_sigma", "terrain_change", "relief"]].item(),
        params[0][["slope_sigma", "slope_change"]].item(),
        *(params[0]["gravity"], flown[2][first]),
    )

    def begin(sensed, solution):
        start(params[0], onboard[0], sensed, solution, memory)

    for _ in landing.stepped(onboard, flown, first, cycles, begin, records):
        before = solution.copy()
        correct(params[0], onboard[0], health, sensed, motion, solution, memory)
        book.move(course.DT, motion["angle"], motion["gain"], before["q_I2B"])
        if memory["interval"]["dt"] == 0.0:
            before["terrain"] += look(book, before, motion, sensed)
            yield before, solution, memory, book
            book.dx = np.zeros(len(book.dx))


def look(book, before, motion, sensed):
    """Let the textbook take in what the filter took in; the ground rises below as it moves on."""
    q, r, v, t = before["q_I2B"], before["r_I"], before["v_I"], before["t"]
    spin, C = np.array([0.0, 0.0, course.SPIN]), matrix(q)
    north, east, up, altitude = map(np.array, level_axes(ONBOARD[0]["planet"], tuple(r), t))
    v_rel, slope = v - np.cross(spin, r), before["slope"]
    rise = slope @ (north @ v_rel, east @ v_rel) * sum(dt for dt, *_ in book.cycles)
    terrain = before["terrain"] + rise
    book.carry_forward(r, v_rel, (north, east, up), altitude - book.site - terrain, q)
    place = r + C @ (ARM - CENTRE)
    north, east, up, altitude = map(np.array, level_axes(ONBOARD[0]["planet"], tuple(place), t))
    height = altitude - book.site - terrain
    for beam in range(4):
        swing = C @ np.cross(motion["rate"], ARM - CENTRE)
        book.take_speed(beam, sensed["radar"]["speed"][beam], C, up, v - np.cross(spin, place), swing)
    for beam in range(4):
        book.take_range(
            beam, sensed["radar"]["range"][beam], C, ARM - CENTRE, (north, east, up), slope, height
        )
    return rise


def test_filter_agrees_with_a_textbook_filter(descent):
    compared = 0
    for before, solution, memory, book in followed(ONBOARD, ALL_COUNT, descent, 1000, 200):
        size = np.sqrt(np.diag(book.P))
        size[size == 0.0] = 1.0
        scaled = (whole(memory) - book.P) / np.outer(size, size)
        assert np.abs(scaled).max() < 1e-9
        for name, at in (("r_I", 0), ("v_I", 3), ("gyro_bias", 9), ("accelerometer_bias", 12)):
            found = solution[name] - before[name] - book.dx[at : at + 3]
            assert np.abs(found).max() < 1e-9 * max(size[at], np.abs(before[name]).max()), name
        assert abs(solution["terrain"] - before["terrain"] - book.dx[15]) < 1e-9 * size[15]
        assert np.abs(solution["slope"] - before["slope"] - book.dx[16:18]).max() < 1e-9
        turned = (np.eye(3) + skew(book.dx[6:9])) @ matrix(before["q_I2B"])
        assert np.abs(matrix(solution["q_I2B"]) - turned).max() < 1e-9 + np.abs(book.dx[6:9]).max() ** 2
        compared += 1
    assert compared == 99 and solution["beams_used"] == 15


def test_covariance_is_symmetric_and_positive_all_the_way(descent):
    for _, _, memory, _ in followed(ONBOARD, PARAMS, descent, 1400, 400):
        P = whole(memory)
        assert np.array_equal(P[:STATES, :STATES], P[:STATES, :STATES].T)
        size = np.sqrt(np.diag(P))
        size[size == 0.0] = 1.0
        assert np.linalg.eigvalsh(P / np.outer(size, size)).min() > -1e-12


def test_transition_is_the_exponential_of_constant_motion():
    T, f, w = 0.5, np.array([2.0, -7.0, 3.0]), np.array([0.0, 0.0, 0.02])
    r, C = np.array([2.1e6, 1.9e6, 1.8e6]), matrix(np.array([0.5, 0.5, 0.5, 0.5]))
    memory = landing.records()[4][0]
    interval = memory["interval"]
    interval["dt"], interval["gain"], interval["path"] = T, f * T, 0.5 * f * T**2
    interval["frame"] = C * T
    for k in range(3):
        interval["turned"][k], interval["pushed"][k] = C * T * w[k], C * T * (C.T @ f)[k]
    size = np.linalg.norm(r)
    F = np.zeros((WIDTH, WIDTH))
    F[0:3, 3:6] = np.eye(3)
    F[3:6, 0:3] = course.MU / size**3 * (3.0 * np.outer(r, r) / size**2 - np.eye(3))
    F[3:6, 6:9], F[3:6, 12:15], F[6:9, 9:12] = -skew(f), -C, -C
    for k in range(3):
        F[6:9, 18 + 3 * k : 21 + 3 * k], F[3:6, 27 + 3 * k : 30 + 3 * k] = -C * w[k], -C * (C.T @ f)[k]
    as_flown(fill_transition, "mu, r_I, memory", FILL_TRANSITION)(course.MU, tuple(r), memory)
    made = memory["transition"][:MOVING, :ACTING]
    assert made == pytest.approx(expm(F * T)[:MOVING, :ACTING], rel=1e-6, abs=1e-6)


def expected(flown, error, beam):
    """What a solution ``error`` away from a flight at 2.7 km expects of a beam, and its direction."""
    solution, motion = np.zeros(1, landing.SOLUTION)[0], np.zeros(1, landing.MOTION)[0]
    solution["r_I"], solution["v_I"] = flown[0][1000] + error[:3], flown[1][1000] + error[3:6]
    solution["terrain"], solution["slope"] = error[15], SLOPE + error[16:]
    turned = landing.multiply((1.0, *(0.5 * error[6:9])), tuple(flown[2][1000]))
    solution["q_I2B"] = turned / np.linalg.norm(turned)
    motion["rate"], motion["centre"] = (0.1, -0.2, 0.05), CENTRE
    q, lever, velocity, swing, up, height = place_antenna(ONBOARD[0], motion, solution, 0.0)
    u = instruments.from_frame(q, tuple(ONBOARD[0]["instruments"]["beam_axis"][beam]))
    normal = ground_normal(up, tuple(solution["slope"]))
    above = height - np.dot(lever, np.subtract(up, normal))
    reach, steepness, _ = expected_range(u, up, normal, above, course.RADIUS)
    speed = np.dot(u, np.add(velocity, swing))
    return np.array([reach, speed]), (u, up, normal, lever, velocity, steepness)


@pytest.mark.parametrize("beam", range(4))
def test_rows_are_the_derivatives_of_what_is_expected(descent, beam):
    (reach, speed), (u, up, normal, lever, velocity, steepness) = expected(descent, np.zeros(STATES), beam)
    rows, found = np.zeros((2, WIDTH)), np.zeros((2, STATES))
    range_row(u, up, normal, lever, steepness, reach, course.RADIUS, beam, rows[0])
    speed_row(u, course.SPIN, velocity, speed, beam, rows[1])
    steps = np.array([*[10.0] * 3, *[0.1] * 3, *[1e-5] * 3, *[1.0] * 7, *[1e-4] * 2])
    for state in range(STATES):
        away = np.zeros(STATES)
        away[state] = steps[state]
        both = expected(descent, away, beam)[0] - expected(descent, -away, beam)[0]
        found[:, state] = both / (2.0 * steps[state])
    # second order: the planet's curvature under the beam, its turning over the lever
    assert rows[0, :STATES] == pytest.approx(found[0], rel=5e-3, abs=2e-3 * np.abs(found[0, :3]).max())
    assert rows[1, :3] == pytest.approx(found[1, :3], rel=1e-3, abs=1e-9)
    assert rows[1, 3:STATES] == pytest.approx(found[1, 3:], rel=1e-4, abs=1e-3)


def test_gate_weighs_and_refuses():
    assert weighted_noise(1.0, 1.0, 0.5, 4.0, 2.5) == 0.5
    assert weighted_noise(-3.0, 1.0, 0.5, 4.0, 2.5) == pytest.approx(0.5 + 0.2)
    assert weighted_noise(4.1, 1.0, 0.5, 4.0, 2.5) < 0.0
    room = np.zeros(8)
    for values in ([3.0], [3.0, 1.0], [5.0, -1.0, 2.0], [1.0, 9.0, 2.0, 7.0, 5.0, 5.0, 0.0, 1.0]):
        assert median(np.array(values), len(values), room) == np.median(values)
    assert [refused_again(3, refused, 4) for refused in range(5)] == [0, 0, 0, 4, 4]
    assert refused_again(3, 0, 0) == 3


def test_three_axes_spread_as_the_geometry_says():
    unit, out = ONBOARD[0]["instruments"], np.zeros((3, 3))
    for bits in (0b111111, 0b111110, 0b101101):
        used = unit["gyro_axis"][:6][[bool(bits >> k & 1) for k in range(6)]]
        axes_covariance(unit["gyro_axis"], bits, 6, out)
        assert out == pytest.approx(np.linalg.inv(used.T @ used))
    axes_covariance(unit["gyro_axis"], 0b11, 6, out)
    assert out == pytest.approx(np.linalg.inv(used.T @ used)), "two axes leave it as it was"


def ends(flown):
    """Cycles of ignition and touchdown."""
    return int(np.argmax(flown[5] < 1200.0)), len(flown[0]) - 1


def height_error(error, flown, k):
    return np.array(level_axes(ONBOARD[0]["planet"], tuple(flown[0][k]), 0.0)[2]) @ error[:3] - error[15]


def relative(error):
    return error[3:6] - np.cross([0.0, 0.0, course.SPIN], error[:3])


def test_landing_over_even_ground_is_known_as_well_as_required(descent):
    ignition, down = ends(descent)
    even = belief.params_record(relief_m=1.0)
    errors, _, _, _, claims = landing.fly(ONBOARD.copy(), even, descent, [ignition, down])
    assert 3.0 * claims[0, 9] < 5.0 and (3.0 * claims[0, 3:6]).max() < 0.3
    assert 3.0 * claims[1, 9] < 0.5 and (3.0 * claims[1, 3:6]).max() < 0.1
    assert np.degrees(3.0 * np.hypot(claims[1, 6], claims[1, 7])) < 0.2
    for k, at in enumerate((ignition, down)):
        assert abs(height_error(errors[k], descent, at)) < 3.5 * claims[k, 9]
        assert np.linalg.norm(relative(errors[k])) < 3.5 * np.linalg.norm(claims[k, 3:6])


@pytest.mark.parametrize("where", [0, 200, 1000, 1600])
def test_a_false_lock_is_refused_and_the_sound_beams_are_used(descent, where):
    ignition, down = ends(descent)
    looks = np.zeros((down + 1, 8), np.int64)
    looks[where : where + 400, 2] = 2
    errors, _, _, used, claims = landing.fly(ONBOARD.copy(), PARAMS, descent, [down], looks=looks)
    locked = used[used > 0]
    lying = used[where : where + 400]
    near = np.abs(descent[5][where : where + 400] - 55.0) < 25.0  # there 60 m is no lie
    assert not np.any((lying & 4 != 0) & ~near)
    assert np.mean(locked & 0b1011 == 0b1011) > 0.999
    assert abs(height_error(errors[0], descent, down)) < 4.0 * claims[0, 9]
    assert np.linalg.norm(relative(errors[0])) < 4.0 * np.linalg.norm(claims[0, 3:6])


@pytest.mark.parametrize("lost", [(0,), (0, 1), (0, 2)])
def test_the_landing_is_still_known_with_beams_lost(descent, lost):
    _, down = ends(descent)
    looks = np.zeros((down + 1, 8), np.int64)
    looks[:, list(lost)] = 1
    even = belief.params_record(relief_m=1.0)
    errors, _, _, used, claims = landing.fly(ONBOARD.copy(), even, descent, [down], looks=looks)
    assert used.max() == 15 - sum(1 << beam for beam in lost)
    assert 3.0 * claims[0, 9] < 0.6 and (3.0 * claims[0, 3:6]).max() < 0.3
    assert abs(height_error(errors[0], descent, down)) < 4.0 * claims[0, 9]
    assert np.linalg.norm(relative(errors[0])) < 4.0 * np.linalg.norm(claims[0, 3:6])


def test_gate_opens_when_the_solution_is_wrong(descent):
    apart, used = [], []
    for k, (_, solution, _, _) in enumerate(followed(ONBOARD, PARAMS, descent, 1000, 400)):
        if k == 50:
            solution["v_I"] += 8.0
            solution["terrain"] += 400.0
        apart.append(abs(solution["v_I"] - descent[1][1000 + 2 * (k + 1)]).max())
        used.append(int(solution["beams_used"]))
    assert used[51:55] == [0, 0, 0, 0], "all beams are refused at first"
    assert used[-1] == 15 and apart[-1] < 0.5
    assert used.index(15, 52) < 50 + 25, "the gate opens after some ten looks"


def standing(descent):
    """A filter that has just started, at rest in its own frame."""
    records = landing.records()
    sensed, motion, solution, health, memory = (record[0] for record in records)
    solution["r_I"], solution["q_I2B"] = descent[0][0], descent[2][0]
    start(PARAMS[0], ONBOARD[0], sensed, solution, memory)
    motion["dt"], motion["rate_known"], motion["force_known"] = 0.05, 1, 1
    return sensed, motion, solution, health, memory


def test_star_fixes_that_stay_away_are_believed_in_the_end(descent):
    sensed, motion, solution, health, memory = standing(descent)
    fix = landing.multiply(landing.about_axis((0.0, 0.6, 0.8), 0.02), tuple(descent[2][0]))
    motion["fixes"], motion["fix_q_I2B"] = 1, fix
    apart = []
    for k in range(1, 400):
        solution["t"] = sensed["t"] = 0.05 * k
        correct(PARAMS[0], ONBOARD[0], health, sensed, motion, solution, memory)
        apart.append(landing.rotation_vector(landing.multiply(fix, (1, -1, -1, -1) * solution["q_I2B"])))
    size = np.linalg.norm(apart, axis=1)
    assert size[150] == pytest.approx(0.02, rel=0.01) and size[-1] < 1e-3


def test_mean_of_two_star_trackers_has_half_the_bias_variance_of_one():
    """Many fixes of two trackers leave the variance of their mean bias, then those of one its own."""
    onboard, records = ONBOARD.copy(), landing.records()
    unit = onboard[0]["instruments"]
    unit["n_trackers"] = 2
    sensed, motion, solution, _, memory = (record[0] for record in records)
    solution["r_I"], solution["q_I2B"] = (3.4e6, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    start(PARAMS[0], onboard[0], sensed, solution, memory)
    motion["fix_q_I2B"] = solution["q_I2B"]
    for fixes in (2, 1):
        for i in range(6, 9):  # the gyros have drifted
            memory["covariance"][i, i] += np.radians(0.1) ** 2
        motion["fixes"] = fixes
        for _ in range(4000):
            update_by_stars(PARAMS[0], onboard[0], sensed, motion, solution, memory)
        left = np.diag(memory["covariance"])[6:9]
        assert left == pytest.approx(np.full(3, unit["star_bias"] ** 2 / fixes), rel=0.02)


def test_antenna_is_placed_where_it_will_be(descent):
    """The readings of the radar are a cycle younger than those of the inertial unit."""
    solution, motion = np.zeros(1, landing.SOLUTION)[0], np.zeros(1, landing.MOTION)[0]
    k, dt = 900, course.DT
    for ahead in range(2):
        at = k + ahead
        solution["t"], solution["r_I"], solution["v_I"] = at * dt, descent[0][at], descent[1][at]
        solution["q_I2B"], motion["dt"], motion["centre"] = descent[2][at], dt, CENTRE
        motion["gain"], motion["rate"] = descent[4][at], descent[3][at] / dt
        placed = place_antenna(ONBOARD[0], motion, solution, (k + 1) * dt)
        if ahead == 0:
            before = placed
    assert before[5] == pytest.approx(placed[5], abs=0.02), "height; it falls 5 m in a cycle"
    assert before[2] == pytest.approx(placed[2], abs=0.05), "velocity"
    assert np.array(before[0]) == pytest.approx(np.array(placed[0]), abs=1e-3), "attitude"


def test_unknown_motion_and_excluded_gyros_make_the_filter_unsure(descent):
    sensed, motion, solution, health, memory = standing(descent)
    sure = []
    for k in range(80):
        if k == 20:
            motion["rate_known"] = 0
        if k == 40:
            motion["rate_known"], health["gyro"][1] = 1, 0
        solution["t"] = sensed["t"] = 0.05 * k
        correct(UNSURE[0], ONBOARD[0], health, sensed, motion, solution, memory)
        sure.append((memory["covariance"][6, 6], memory["covariance"][9:12, 9:12].trace()))
    assert sure[20][0] < 2.0 * sure[0][0]
    assert np.sqrt(sure[41][0]) == pytest.approx(np.radians(60.0), rel=0.1), "60 deg/s for a second"
    assert sure[79][1] > 1.5 * sure[20][1]
