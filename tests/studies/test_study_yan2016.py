"""The study of Yan, Sun & Guo: a printed disturbance beyond the lift, one within, and the comparison
with other gains.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.studies import yan2016
from edl6dof.studies.samples import last_time
from edl6dof.studies.yan2016 import (
    CORNERS,
    EXPERIMENTS,
    OTHERS,
    PRINTED,
    UNDISTURBED,
    WITHIN,
    settled_s,
)


@pytest.fixture(scope="module", params=["two", pytest.param("all", marks=pytest.mark.long)])
def corners(request):
    """Of the corners of the initial state two that are opposite, or all."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "two":
            patch.setattr(yan2016, "CORNERS", (CORNERS[0], CORNERS[-1]))
        yield len(yan2016.CORNERS)


@pytest.fixture(scope="module")
def yan(corners):
    return yan2016.STUDY.fly()


def of(report, experiment, label):
    return next(f.computed for f in report.findings if (f.experiment, f.label) == (experiment.name, label))


def test_what_is_said_of_yan2016_holds(yan, corners):
    assert [found.label for found in yan.findings if not found.ok] == []
    assert of(yan, PRINTED, "disturbance estimate, largest error") < 4.0
    assert yan.runs == len(yan.rows) == len(EXPERIMENTS) * len(yan2016.LAWS) * corners
    assert yan2016.RUNS == 96


def test_yan2016_says_that_the_printed_disturbance_is_beyond_the_lift(yan):
    """L/V = 0.24 D/V at the peak of drag, by hand, and what that does to the bank angle."""
    assert of(yan, PRINTED, "largest L/V") == pytest.approx(0.0107, abs=1e-4)
    share = {x: of(yan, x, "flight in which L/V is above the amplitude") for x in (PRINTED, WITHIN)}
    assert share[PRINTED] < 15.0 and share[WITHIN] > 80.0
    saturated = [of(yan, x, "bank saturated, FTC+DOB") for x in (PRINTED, WITHIN, UNDISTURBED)]
    assert saturated[0] > 60.0 and saturated[0] > 2.0 * saturated[1] > 2.0 * saturated[2]


def test_finite_time_error_dynamics_end_and_linear_ones_decay():
    """Eq. 21 with one power is a damped oscillator (solved by scipy); with less it is zero after a while."""
    decay = solve_ivp(
        lambda t, x: [x[1], -0.25 * x[0] - 0.8 * x[1]],
        (0.0, 60.0),
        [1.0, 0.0],
        t_eval=np.arange(0.0, 60.0, 0.001),
        rtol=1e-10,
        atol=1e-14,
    )
    for share in (1e-2, 1e-4):
        expected = last_time(decay.t, np.abs(decay.y[0]) > share)
        assert settled_s(1.0, (0.25, 0.8), 1.0, share) == pytest.approx(expected, abs=0.02)
    finite = [settled_s(0.3, (0.25, 0.8), 0.6, share) for share in (1e-2, 1e-4, 1e-6)]
    linear = [settled_s(0.3, (0.25, 0.8), 1.0, share) for share in (1e-2, 1e-4, 1e-6)]
    assert finite[2] - finite[1] < 0.5 * (finite[1] - finite[0]) and linear[2] - linear[1] > 8.0


def test_yan2016_settles_drag_sooner_in_finite_time_whatever_the_gains(yan):
    """Honesty about unprinted gains: no pair flown bears out the text."""
    for experiment in (PRINTED, WITHIN, *OTHERS):
        assert of(yan, experiment, "drag settled, PD less FTC") > 0.1
        assert of(yan, experiment, "RMS altitude error, FTC over PD") < 1.0
