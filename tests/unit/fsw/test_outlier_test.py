"""Which reading disagrees, against leaving each out in turn with numpy."""

import numpy as np
import pytest
from scipy.special import erfc

from edl6dof.fsw.navigation.filters.kalman.measurement_update import DISTINCT, NONE, invert, outlier


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
    second, most = np.argsort(falls)[-2:]
    gate = np.sqrt(falls[most])
    identified = falls[most] - falls[second] > DISTINCT
    expected = (most, 1.0) if identified else (NONE, pytest.approx(falls[most]))
    assert outlier(0.99 * gate, 4, spread.copy(), innovation) == expected
    assert outlier(1.01 * gate, 4, spread.copy(), innovation) == (NONE, 1.0)


def cones(*turns_deg):
    """Beams on a cone of half angle 25 deg at these angles about its axis, shape (beams, 3)."""
    turns, lean = np.radians(turns_deg), np.radians(25.0)
    return np.array(
        [np.full(len(turns), np.cos(lean)), np.sin(lean) * np.cos(turns), np.sin(lean) * np.sin(turns)]
    ).T


#: Beams of one radar, and of two; the velocity is hardly known, and the noise of a speed is one.
ONE, TWO = cones(45, 135, 225, 315), cones(45, 135, 225, 315, 0, 90, 180, 270)
UNKNOWN = 1e3


def named(beams, bias, draws, gate=4.0, of=0):
    """Beam named in each draw of the noise, with a bias of beam ``of``; share of the draws in which a wrong
    one is noticed, named or not.
    """
    rng, spread = np.random.default_rng(1), UNKNOWN**2 * beams @ beams.T + np.eye(len(beams))
    noise = rng.normal(size=(draws, len(beams))) + UNKNOWN * rng.normal(size=(draws, 3)) @ beams.T
    noise[:, of] += bias
    found = [outlier(gate, len(beams), spread.copy(), look) for look in noise]
    noticed = [beam != NONE or most > 1.0 for beam, most in found]
    return np.array([beam for beam, _ in found]), np.mean(noticed)


def test_healthy_beams_exceed_the_gate_as_rarely_as_normal_numbers_and_are_named_more_rarely():
    """Each of eight squares exceeds the gate with the probability of a normal number; two together seldom."""
    draws, gate = 20_000, 3.0
    (found, noticed), one = named(TWO, 0.0, draws, gate), erfc(gate / np.sqrt(2.0))
    assert 0.8 < noticed / (8.0 * one) < 1.0 + 4.0 / np.sqrt(8.0 * one * draws)
    assert np.mean(found != NONE) < 0.1 * noticed


@pytest.mark.parametrize("bias", [5.0, 8.0, 12.0])
@pytest.mark.parametrize("of", [0, 5])
def test_a_biased_beam_of_two_radars_is_named_as_often_as_its_square_and_no_other_is(bias, of):
    """The square of the wrong beam is that of a normal number about bias sqrt(5/8): three of eight readings
    give the velocity.
    """
    draws = 4_000
    found, noticed = named(TWO, bias, draws, of=of)
    above = 0.5 * erfc((4.0 - bias * np.sqrt(5.0 / 8.0)) / np.sqrt(2.0))
    assert noticed == pytest.approx(above, abs=4.0 * np.sqrt(above * (1.0 - above) / draws) + 1e-3)
    right, wrong = np.mean(found == of), np.mean((found != of) & (found != NONE))
    assert wrong < np.exp(-0.5 * DISTINCT) * right
    assert right > (0.3 if bias == 5.0 else 0.9) * noticed


@pytest.mark.parametrize("bias", [10.0, 100.0])
def test_of_four_beams_on_one_cone_none_is_named_and_the_noise_of_all_grows(bias):
    """Their only parity is b1 - b2 + b3 - b4: every beam explains it equally well."""
    assert np.all(named(ONE, bias, 200)[0] == NONE)
    spread, innovation = UNKNOWN**2 * ONE @ ONE.T + np.eye(4), np.array([0.0, bias, 0.0, 0.0])
    assert outlier(4.0, 4, spread, innovation)[1] == pytest.approx(bias**2 / 4.0, rel=1e-4)


def test_a_wrong_beam_is_noticed_though_the_prior_would_let_it_pass():
    """Four beams on a cone see an unsure velocity; by itself the wrong one lies within two deviations."""
    spread = ONE @ ONE.T + 0.05**2 * np.eye(4)
    innovation = np.array([0.0, 0.0, 1.5, 0.0])
    assert np.all(np.abs(innovation) < 2.0 * np.sqrt(np.diag(spread)))
    found, most = outlier(4.0, 4, spread, innovation)
    assert found == NONE and most > (1.5 / 2.0 / 0.05) ** 2
