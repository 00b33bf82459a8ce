"""Which reading disagrees, against leaving each out in turn with numpy."""

import numpy as np
import pytest

from edl6dof.fsw.navigation.filters.kalman.measurement_update import NONE, invert, outlier


def covariance(rng, n):
    root = rng.normal(size=(n, n))
    return root @ root.T + 0.1 * np.eye(n)


def unexplained(spread, innovation, kept):
    part = spread[np.ix_(kept, kept)]
    return innovation[kept] @ np.linalg.solve(part, innovation[kept])


@pytest.mark.parametrize("n", [1, 2, 4, 8])
def test_inverse(n):
    spread = covariance(np.random.default_rng(n), n)
    work = np.zeros((8, 8))
    work[:n, :n] = spread
    invert(n, work)
    assert np.allclose(work[:n, :n] @ spread, np.eye(n), atol=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_the_reading_whose_absence_explains_most_is_left_out(seed):
    rng = np.random.default_rng(seed)
    spread, innovation = covariance(rng, 4), rng.normal(size=4) * 10.0
    whole = list(range(4))
    falls = [
        unexplained(spread, innovation, whole) - unexplained(spread, innovation, [j for j in whole if j != i])
        for i in whole
    ]
    most = int(np.argmax(falls))
    gate = np.sqrt(falls[most])
    assert outlier(0.99 * gate, 4, spread.copy(), innovation) == most
    assert outlier(1.01 * gate, 4, spread.copy(), innovation) == NONE


def test_a_wrong_beam_is_found_though_the_prior_would_let_it_pass():
    """Four beams on a cone see an unsure velocity; by itself the wrong one lies within two deviations."""
    turns = np.pi / 4 + np.arange(4) * np.pi / 2
    beams = np.array([np.full(4, np.cos(0.44)), np.sin(0.44) * np.cos(turns), np.sin(0.44) * np.sin(turns)]).T
    spread = beams @ beams.T + 0.05**2 * np.eye(4)
    innovation = np.array([0.0, 0.0, 1.5, 0.0])
    assert np.all(np.abs(innovation) < 2.0 * np.sqrt(np.diag(spread)))
    assert outlier(4.0, 4, spread, innovation) == 2
