"""Axes of figures: numbers of a logarithmic one, bars from naught."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace
from edl6dof.report.flight import common
from edl6dof.report.page import plotly_figure


@pytest.mark.parametrize(
    "span, written",
    [
        ((1.0, 100.0), [1, 2, 5, 10, 20, 50, 100]),
        ((0.8, 12.0), [1, 2, 5, 10]),
        ((1e-6, 1e3), [10.0**k for k in range(-6, 4)]),
        ((3.0, 4.0), []),
    ],
)
def test_logarithmic_axis_counts_one_two_five(span, written):
    assert Axis("", log=True).decades(span) == pytest.approx(written)


def test_numbers_of_a_logarithmic_axis_are_written_out():
    x = np.geomspace(1.0, 100.0, 30)
    panel = Panel(Axis("flights", range=(1.0, 100.0), log=True), Axis("share"), [Trace(x, x, "share")])
    axis = plotly_figure(Figure("one", "One", [panel]))["layout"]["xaxis"]
    assert axis["ticktext"] == ["1", "2", "5", "10", "20", "50", "100"]
    wide = Panel(Axis("", range=(1.0, 1e7), log=True), Axis(""), [Trace(x, x, "share")])
    axis = plotly_figure(Figure("one", "One", [wide]))["layout"]["xaxis"]
    assert axis["ticktext"][-2:] == ["10<sup>6</sup>", "10<sup>7</sup>"]


def test_a_single_peak_leaves_the_rest_of_a_torque_to_be_seen():
    torque = np.sin(np.arange(5000.0))
    assert common._clipped([torque]) is None
    assert common._clipped([2.9 * torque]) is None
    torque[-1] = 6000.0
    first, last = common._clipped([torque, np.zeros(5000)])
    assert -first == last == pytest.approx(1.1, abs=0.01)


def test_bars_are_drawn_whole():
    """All of the first and last bar lies between the ends of x, all of their height between those of y."""
    bars = Trace(np.array([1.0, 2.0, 3.0]), np.array([5.0, 9.0, 4.0]), "flights", "bars")
    panel = Panel(Axis("mass"), Axis("flights"), [bars])
    assert panel.span("x")[0] <= 0.5 and panel.span("x")[1] >= 3.5
    assert panel.span("y")[0] == 0.0 and panel.span("y")[1] > 9.0


def test_cells_are_drawn_whole():
    heat = Heat(np.array([0.0, 1.0, 3.0]), np.array([40.0, 60.0]), np.zeros((2, 3)), "s", 0.0, 1.0)
    panel = Panel(Axis("wind"), Axis("speed"), heat=heat)
    assert panel.span("x") == (-0.5, 4.0) and panel.span("y") == (30.0, 70.0)
