"""Star trackers: which one is excluded, which comes back, and the fix that they give together."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.fsw.navigation.star_fixes import DISAGREE, STAR_WATCH, read_stars
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.interface.sensed import SENSED
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard

DT, TRUE = 0.1, Rotation.from_rotvec([0.4, -1.0, 0.7])
SIGMA = 1e-4  # rad: of a fix about each axis, noise and bias together


class Trackers:
    """Two star trackers of a vehicle at rest, high above the air, with the true solution."""

    def __init__(self, altitude=125e3, rate=0.0, until=0, requested=(), **watch):
        sets = [f"flight_software.navigation.star_watch.{name}={value}" for name, value in watch.items()]
        self.onboard = build_onboard(load_scenario("tianwen1", sets).scenario)[0]
        known = self.onboard["instruments"]
        known["star_sigma"] = known["star_bias"] = SIGMA * np.sqrt(0.5)
        known["star_until"], self.flags = until, np.zeros(MAX_EVENTS, "i8")
        self.flags[list(requested)] = 1
        kinds = (SENSED, SOLUTION, INSTRUMENT_HEALTH, STAR_WATCH, MOTION)
        self.sensed, self.solution, self.health, self.memory, self.motion = (
            np.zeros(1, kind)[0] for kind in kinds
        )
        self.health["star_tracker"], self.solution["started"] = 1, 1
        self.solution["r_I"][0] = self.onboard["planet"]["equatorial_radius"] + altitude
        self.solution["q_I2B"] = TRUE.as_quat(scalar_first=True)
        self.motion["dt"], self.motion["rate"][0] = DT, rate

    def look(self, seconds, *errors):
        """Read for some seconds two trackers with these errors (rad, B), ``None`` for one without a fix."""
        for _ in range(round(seconds / DT)):
            self.sensed["t"] = self.solution["t"] = self.sensed["t"] + DT
            for k, error in enumerate(errors):
                self.sensed["stars"]["valid"][k] = error is not None
                if error is not None:
                    q = TRUE * Rotation.from_rotvec(error)
                    self.sensed["stars"]["q_I2B"][k] = q.as_quat(scalar_first=True)
            read_stars(self.onboard, self.flags, self.sensed, self.solution, self.health, self.memory,
                       self.motion)  # fmt: skip
        return list(self.health["star_tracker"])

    @property
    def error(self):
        """Error of the fix (rad, B)."""
        fix = Rotation.from_quat(self.motion["fix_q_I2B"], scalar_first=True)
        return (TRUE.inv() * fix).as_rotvec()


#: Errors that a fix may have, and one that none has.
SMALL, OTHER, LARGE = np.array([SIGMA, 0, 0]), np.array([0, -SIGMA, 0]), np.array([0, 0, 20.0 * SIGMA])


def test_a_tracker_without_fixes_is_excluded_and_its_next_fix_brings_it_back():
    stars = Trackers(patience_s=3.0)
    assert stars.look(2.9, None, SMALL) == [1, 1] and stars.look(0.3, None, SMALL) == [0, 1]
    assert stars.look(0.1, SMALL, None) == [1, 1]
    assert Trackers().look(100.0, SMALL, SMALL) == [1, 1]


@pytest.mark.parametrize("how", [{"altitude": 118.2e3}, {"rate": np.radians(2.5)}])
def test_no_fix_is_missed_where_none_is_expected(how):
    assert Trackers(**how).look(100.0, None, None) == [1, 1]


def test_no_fix_is_missed_after_the_event_that_ends_the_view():
    assert Trackers(until=3, requested=[2]).look(100.0, None, None) == [1, 1]
    assert Trackers(until=3, requested=[1, 3]).look(100.0, None, None) == [0, 0]
    assert Trackers(until=0, requested=range(MAX_EVENTS)).look(100.0, None, None) == [0, 0]


def test_the_fix_is_the_mean_of_the_trackers_and_that_of_one_alone():
    stars = Trackers()
    stars.look(DT, SMALL, OTHER)
    assert stars.motion["fixes"] == 2 and stars.motion["fix_doubt"] == 0.0
    np.testing.assert_allclose(stars.error, 0.5 * (SMALL + OTHER), atol=1e-10)
    stars.look(DT, None, OTHER)
    assert stars.motion["fixes"] == 1
    np.testing.assert_allclose(stars.error, OTHER, atol=1e-12)
    stars.look(DT, None, None)
    assert stars.motion["fixes"] == 0


def test_healthy_fixes_disagree_once_in_a_million():
    assert chi2.sf(DISAGREE, 3) == pytest.approx(1e-6, rel=0.01)
    limit = np.sqrt(2.0 * DISAGREE) * SIGMA
    for size, doubtful in ((0.99 * limit, False), (1.01 * limit, True)):
        stars = Trackers()
        stars.look(DT, np.zeros(3), np.array([0, size, 0]))
        assert (stars.motion["fix_doubt"] > 0.0) == doubtful


@pytest.mark.parametrize("wrong", [0, 1])
def test_after_they_have_agreed_the_one_that_leaves_the_solution_is_excluded_for_good(wrong):
    stars = Trackers(apart_fixes=3)
    errors = [LARGE, SMALL] if wrong == 0 else [SMALL, LARGE]
    assert stars.look(1.0, SMALL, OTHER) == [1, 1]
    assert stars.look(2 * DT, *errors) == [1, 1] and stars.motion["fix_doubt"] > 0.0
    assert stars.look(DT, *errors) == [wrong, 1 - wrong]
    assert stars.motion["fix_doubt"] == 0.0
    np.testing.assert_allclose(stars.error, SMALL, atol=1e-10)
    assert stars.look(5.0, SMALL, SMALL) == [wrong, 1 - wrong]


def test_of_trackers_that_never_agreed_none_is_excluded_and_the_fix_is_unsure():
    stars = Trackers()
    assert stars.look(10.0, LARGE, SMALL) == [1, 1]
    np.testing.assert_allclose(stars.error, 0.5 * (LARGE + SMALL), atol=1e-8)
    apart = (LARGE - SMALL) @ (LARGE - SMALL)
    assert stars.motion["fix_doubt"] == pytest.approx(0.25 * apart, rel=1e-3)


def test_nothing_is_excluded_if_nobody_watches():
    stars = Trackers(enabled="false")
    stars.look(1.0, SMALL, OTHER)
    assert stars.look(10.0, LARGE, SMALL) == [1, 1] == stars.look(10.0, None, SMALL)
