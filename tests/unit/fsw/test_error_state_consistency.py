"""Whether the error-state filter claims what is so: errors over their covariance, and innovations over
theirs, in 100 made-up flights (NEES and NIS, 95 % bounds of chi-square).

Source: Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation (2001), 5.4.
"""

import made_up_belief as belief
import made_up_course as course
import made_up_landing as landing
import numpy as np
import pytest
from scipy.stats import chi2

from edl6dof.fsw.navigation.filters.kalman.states import STATES

FLIGHTS = 100
#: Slopes so small that ranges are linear in them.
ONBOARD, PARAMS = belief.onboard_record(), belief.params_record(slope_sigma_deg=2.0, slope_change_deg=0.5)
#: Parts of the error state, that are looked at one by one too.
PARTS = {"position": (0, 3), "velocity": (3, 6), "attitude": (6, 9), "biases": (9, 15), "slope": (16, 18)}


def flights(flown, reports, **how):
    """Errors and covariances at the reports, and innovations, of all flights."""
    every = [landing.fly(ONBOARD.copy(), PARAMS, flown, reports, seed=seed, **how) for seed in range(FLIGHTS)]
    errors, covariances, innovations = (np.array([flight[k] for flight in every]) for k in range(3))
    return errors, covariances[..., :STATES], innovations


def nees(errors, covariances, part):
    """Mean over the flights, at each report."""
    first, end = part
    e, P = errors[..., first:end], covariances[..., first:end, first:end]
    return np.mean(np.sum(e * np.linalg.solve(P, e[..., None])[..., 0], axis=-1), axis=0)


def bounds(size, samples, chance=0.05):
    """Of the mean of ``samples`` values that are chi-square of ``size``."""
    return chi2.ppf([0.5 * chance, 1.0 - 0.5 * chance], size * samples) / samples


def assert_consistent(errors, covariances, reports):
    low, high = bounds(STATES, FLIGHTS)
    mean = nees(errors, covariances, (0, STATES))
    assert np.all((low < mean) & (mean < high)), f"{mean} not in {low:.2f} .. {high:.2f}"
    for name, part in PARTS.items():
        # five parts at several reports: one in a hundred of them all
        low, high = bounds(part[1] - part[0], FLIGHTS, 0.01 / reports)
        mean = nees(errors, covariances, part)
        assert np.all((low < mean) & (mean < high)), f"{name}: {mean} not in {low:.2f} .. {high:.2f}"


def assert_innovations_consistent(innovations, first, end):
    """Mean square of the innovations of ranges and speeds over the flights, look by look; those of one look
    share the considered errors, so that looks far apart are counted alone.
    """
    for kind in range(2):
        squares = innovations[:, first:end, kind] ** 2
        looked = squares[:, np.any(squares > 0.0, axis=(0, 2))]
        mean = np.sum(looked, axis=2).mean(axis=0)
        low, high = bounds(4, FLIGHTS)
        assert len(mean) > 100
        assert np.mean((low < mean) & (mean < high)) > 0.9, "95 % of the looks within the 95 % bounds"
        assert np.mean(mean) == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize(
    "stars_until",
    [-1.0, pytest.param(100.0, marks=pytest.mark.long)],
    ids=["from one fix", "with star fixes"],
)
def test_entry_dead_reckoning_claims_what_is_so(stars_until):
    flown = course.truth(ONBOARD, True)
    reports = [200, 1500, 3000, 4500, 5999]
    errors, covariances, _ = flights(flown, reports, stars_until=stars_until)
    assert_consistent(errors, covariances, len(reports))


def test_descent_with_radar_claims_what_is_so():
    flown = course.truth(ONBOARD, False)
    ignition, down = int(np.argmax(flown[5] < 1200.0)), len(flown[0]) - 1
    reports = [100, ignition // 2, ignition, ignition + 300, down - 300, down]
    errors, covariances, innovations = flights(flown, reports)
    assert_consistent(errors, covariances, len(reports))
    assert_innovations_consistent(innovations, 0, ignition)
    assert_innovations_consistent(innovations, ignition, down)


def test_a_filter_that_believes_too_much_is_found():
    begun = tuple(column[:101] for column in course.truth(ONBOARD, False))
    errors, covariances, _ = flights(begun, [100], size=1.5)
    with pytest.raises(AssertionError):
        assert_consistent(errors, covariances, 1)
