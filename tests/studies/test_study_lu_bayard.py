"""The study of Lu & Bayard: the L2 inequality where lift is free, and what must break it.  The theorem in its
own setting: tests/unit/fsw/test_hinf_theorem.py.
"""

from __future__ import annotations

import numpy as np
import pytest

import edl6dof
from edl6dof.studies import lu_bayard


@pytest.fixture(scope="module")
def report():
    return lu_bayard.STUDY.fly()


def motion_with(errors):
    """The point mass with the settings that are flown."""
    return lu_bayard.Motion(edl6dof.load(lu_bayard.SCENARIO, lu_bayard.FLOWN), errors)


def finding(report, label):
    return next(found for found in report.findings if found.label == label)


def test_every_figure_is_as_the_study_says(report):
    assert [found.label for found in report.findings if not found.ok] == []
    assert {found.published for found in report.findings} == {None, 1.0}  # the claim, and no bound of ours


def remainder(errors, u):
    """What D'' of an integrated flight has beyond eq. 12, and w of its errors, in the middle of 7 rows."""
    motion, y, rows = motion_with(errors), (32e3, 4500.0, -0.15), []
    design = motion.design
    for _ in range(7):
        drag, rate = motion.sensed(y)
        rows.append((*y, drag, rate, errors.excess(y[0], y[1])))
        y = motion.step(y, u)
    height, speed, path, drag, rate, excess = np.array(rows).T
    t = lu_bayard.CALL_S * np.arange(7)
    w = lu_bayard.disturbance_of(design, t, drag, speed, excess, np.full(7, errors.lift * u))[3]
    r, angle = design.radius / (design.radius + height[3]), path[3]
    theta = np.array([0.0, 0.0, 1.0 - r * np.cos(angle) ** 2, 1.0 - np.cos(angle), np.sin(angle) ** 2])
    free, unknown, per_u = design.dynamics(drag[3], rate[3], speed[3])
    model = per_u * u - free - (np.array(unknown) + [0.0, 0.0, 0.0, per_u * u, 0.0]) @ theta
    return np.gradient(rate, t)[3] - model, w


@pytest.mark.parametrize("name", ["density +-5 %", "head wind 30 m/s", "lift 10 % low", "all three"])
def test_given_errors_make_the_disturbance_that_the_drag_shows(name):
    """w against D'' of an integrated flight less eq. 12, which leaves what g loses with height."""
    shown, w = remainder(lu_bayard.ERRORS[name], 0.1)
    still, nothing = remainder(lu_bayard.Errors(), 0.1)
    assert nothing == 0.0 and abs(w) > 1e-4
    assert shown - still == pytest.approx(w, rel=0.05, abs=5e-5)


@pytest.mark.parametrize("errors", ["no error", "all three"])
def test_the_law_keeps_the_bound_where_lift_is_free_and_constant_bank_angles_break_it(errors):
    motion, full = motion_with(lu_bayard.ERRORS[errors]), 0.24
    kept, _ = lu_bayard.fly_free(motion)
    assert kept.over_bound < 1.0
    for bank in lu_bayard.BANKS.values():
        broken, _ = lu_bayard.fly_free(motion, constant=full * np.cos(np.radians(bank)))
        assert broken.over_bound > 50.0


def test_limited_lift_is_why_the_bound_is_broken_in_flight(report):
    for name in ("own lift: least", "flight, flown:", "flight, as printed:"):
        broken = next(found for found in report.findings if found.label.startswith(name))
        assert broken.computed > 1.0 and "free lift" in broken.why
    assert finding(report, "free lift: largest |u| over L/D, flown").computed > 5.0


def test_trial_and_flight_agree_where_both_have_the_same_limits(report):
    """An integration in the study and a flight of the simulator, same law and no error, other start."""
    trial = next(row for row in report.grids[0].rows if row[0] == "flown, no error")
    flight = next(row for row in report.grids[1].rows if row[0] == "flown")
    assert trial[2] == pytest.approx(flight[4], rel=0.4)
