"""The study of Lu & Bayard: convergence, the L2 inequality, theta in its set, and the range along the
profile.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import simpson

from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import load_scenario
from edl6dof.studies import lu_bayard
from edl6dof.studies.drag_model import respond


@pytest.fixture(scope="module")
def report():
    return lu_bayard.run(1, lambda done, total: None)


@pytest.fixture(scope="module")
def design():
    scenario = load_scenario(lu_bayard.SCENARIO, lu_bayard.SETTINGS).scenario
    return lu_bayard._design(build_onboard(scenario))


def finding(report, label):
    return next(found.computed for found in report.findings if found.label == label)


def test_every_claim_of_the_paper_is_kept(report):
    assert [found.label for found in report.findings if not found.ok] == []
    assert sum(bool(found.bound) for found in report.findings) == 10


def test_error_converges_without_disturbance_and_adaptation_is_why(report):
    end, still = (
        finding(report, "design model, w = 0: |e| at the end"),
        finding(report, "the same without adaptation"),
    )
    assert end < 1e-3 * lu_bayard.START_ERROR
    assert still > 10.0 * end


def test_range_along_the_profile_is_that_of_the_integrated_flight(report):
    predicted = finding(report, "range predicted along the profile")
    assert predicted == pytest.approx(finding(report, "range of an integrated flight held on it"), rel=0.005)


def steady(t):
    """A reference that stands still."""
    return 60.0, 0.0, 0.0


def test_worst_disturbance_of_the_theory_comes_near_the_bound_and_not_past_it(design):
    """With theta known, w of one frequency at the peak of the gain: energy ratio close to lambda squared of
    that frequency.
    """
    frequency = 0.05

    def push(t):
        return 0.02 * np.sin(frequency * t)

    known = np.zeros(5)
    told = type(design)(
        design.gain, design.weight, 1e9, known - 1e-12, known + 1e-12, 0.0, design.radius, design.scale_height
    )
    reply = respond(told, steady, known, push, (0.0, 0.0, 50e3), 600.0)
    ratio = simpson(reply.error**2, x=reply.t) / simpson(reply.disturbance**2, x=reply.t)
    a = np.array([[0.0, 1.0], [-0.5 * 32.02563 / 625.0, -0.5 * 256.3078 / 625.0]])  # A + B F by hand
    gain = abs(np.linalg.solve(1j * frequency * np.eye(2) - a, [0.0, 1.0])[0])
    assert ratio == pytest.approx(gain**2, rel=0.1)
    assert 0.7 * design.gain**2 < ratio < design.gain**2


def test_estimates_stay_in_the_set_under_a_disturbance_far_too_large(design):
    reply = respond(
        design, steady, lu_bayard.THETA, lambda t: 3.0 * np.sin(0.2 * t), (0.0, 0.0, 4000.0), 40.0
    )
    assert np.all((reply.theta >= design.low) & (reply.theta <= design.high))
    assert np.any(reply.theta == design.low) or np.any(reply.theta == design.high)


def test_figures_are_drawn(report):
    assert [drawing.key for drawing in report.drawings] == [
        "fig1_corridor_and_profile",
        "design_model",
        "flights",
    ]
    for drawing in report.drawings:
        for panel in drawing.panels:
            assert all(
                len(curve.x) and np.isfinite(curve.x).all() and np.isfinite(curve.y).all()
                for curve in panel.traces
            )
