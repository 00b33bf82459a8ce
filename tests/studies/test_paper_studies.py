"""The study of Yan, Sun & Guo on few runs: published bounds, and draws that do not depend on the number of
runs.
"""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.studies import yan2016
from edl6dof.studies.cases import Spread, draw


def silent(done, total):
    pass


@pytest.fixture(scope="module")
def yan():
    return yan2016.run(64, silent)


def finding(report, label):
    return next(found for found in report.findings if found.label == label)


def test_draws_have_the_wanted_spread_and_a_longer_series_begins_like_a_shorter_one():
    spreads = (Spread("a.b", 10.0, 3.0), Spread("c", -1.0, 0.0))
    many = draw(spreads, 4000, 1)
    assert draw(spreads, 3, 1) == many[:3]
    first = np.array([row["a.b"] for row in many])
    assert (first.mean(), first.std()) == (pytest.approx(10.0, abs=0.05), pytest.approx(1.0, abs=0.04))
    assert {row["c"] for row in many} == {-1.0}


def test_yan2016_keeps_the_published_bounds(yan):
    assert [found.label for found in yan.findings if not found.ok] == []
    assert finding(yan, "disturbance estimate, largest error").computed < 4.0


def test_yan2016_shows_the_gains_at_which_the_order_turns(yan):
    """Honesty about an unprinted parameter: the comparison is repeated, and one of the repetitions goes
    against the paper in altitude.
    """
    ratios = [
        found.computed
        for found in yan.findings
        if found.note.startswith("gains") and "altitude" in found.label
    ]
    assert len(ratios) == 3 and max(ratios) > 1.0 > min(ratios)


def test_figures_of_the_paper_are_drawn(yan):
    assert [drawing.key[:4] for drawing in yan.drawings] == [f"fig{n}" for n in range(2, 10)]
    for drawing in yan.drawings:
        for panel in drawing.panels:
            assert all(
                len(curve.x) and np.isfinite(curve.x).all() and np.isfinite(curve.y).all()
                for curve in panel.traces
            )
