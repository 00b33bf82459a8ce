"""Direction of the unexplained force: its angle from the axis, and how it is smoothed."""

from math import atan2, exp, hypot, radians

import pytest

from edl6dof.fsw.estimation.registry import force_angle

DT, LAG = 0.04, 1.0


def after(seconds, force, last=0.0):
    for _ in range(round(seconds / DT)):
        last = force_angle(LAG, force, DT, last)
    return last


def test_a_force_along_the_axis_has_no_angle_and_one_across_it_has_that_of_their_ratio():
    assert after(20.0, (-7600.0, 0.0, 0.0)) == 0.0
    assert after(20.0, (-7600.0, 75.0, -80.0)) == pytest.approx(atan2(hypot(75.0, 80.0), 7600.0))


def test_the_angle_follows_with_its_lag_at_any_rate():
    there = atan2(140.0, 7600.0)
    assert after(LAG, (-7600.0, 0.0, 140.0)) == pytest.approx(there * (1.0 - exp(-1.0)))


def test_a_leak_of_four_control_cycles_stays_below_the_threshold_of_the_guard():
    """250 N across at the drag of the mortar."""
    assert after(4 * DT, (-7600.0, 250.0, 0.0)) < radians(0.5)
