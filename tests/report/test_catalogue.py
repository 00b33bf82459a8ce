"""The catalogue of plots: what is declared once must hold for all who draw it."""

from __future__ import annotations

import numpy as np
import pytest

from edl6dof.replay.pages import PAGES
from edl6dof.report import catalogue
from edl6dof.report.catalogue import BOUND, CATALOGUE, STACKS, Plot, Stack, chosen
from edl6dof.telemetry.channels import CHANNELS

CHANNEL = {channel.name: channel for channel in CHANNELS}
ALL_STACKS = [one for one in vars(catalogue).values() if isinstance(one, Stack)]
ALL_STACKS += [stack for stacks in STACKS.values() for stack in stacks]
DRAWN = [
    *(plot for page in PAGES.values() for plot in page),
    *(p for stack in ALL_STACKS for p in stack.plots),
]


@pytest.mark.parametrize("plot", DRAWN, ids=lambda plot: plot.key)
def test_a_plot_is_of_channels_of_one_unit(plot):
    assert {CHANNEL[name].unit for name in plot.channels} == {CHANNEL[next(iter(plot.curves))].unit}
    assert len(plot.lines) == len(plot.channels) + bool(plot.sigma)


def test_a_key_names_one_plot():
    by_key = {}
    for plot in DRAWN:
        # on a page of powered descent an error begins with it
        # and a replay shows all in the units of its readout
        same = {"since": "", "kilo": False}
        assert by_key.setdefault(plot.key, plot)._replace(**same) == plot._replace(**same)


def test_no_figure_of_a_report_comes_twice():
    keys = [stack.key for stack in ALL_STACKS]
    assert len(set(keys)) == len(keys)


def test_values_are_in_the_unit_that_stands_on_the_axis():
    plot = Plot("k", "height", {"truth.height_m": "above the ground"}, kilo=True)
    (value,) = plot.values({"truth.height_m": np.array([1500.0, 2000.0])}, slice(1, None))
    assert plot.label == "height (km)" and value.tolist() == [2.0]
    assert catalogue.LOAD.label == "load (Earth g)" and catalogue.MACH.label == "Mach number (1)"


def test_bounds_stand_on_both_sides_of_an_error_that_is_alone():
    columns = {f"nav.{name}_height_m": np.array([value]) for name, value in (("error", 2.0), ("sigma", 5.0))}
    assert [float(one[0]) for one in catalogue.HEIGHT_ERROR.values(columns, slice(None))] == [
        2.0, 5.0 * BOUND, -5.0 * BOUND,
    ]  # fmt: skip
    assert catalogue.POSITION_ERROR.sigma == ""
    assert [one.sigma for one in catalogue.POSITION_ERROR.apart()] == [
        f"nav.sigma_{axis}_m" for axis in ("north", "east", "down")
    ]


def test_a_plot_of_the_catalogue_can_be_asked_for_by_its_key():
    parts = {one.key for plot in CATALOGUE.values() for one in plot.apart()}
    assert {plot.key for plot in DRAWN} <= CATALOGUE.keys() | parts
    columns = {name: np.ones(3) for name in CHANNEL}
    assert chosen(columns, ["bank_deg"], "run") == ["truth.bank_deg", "guide.bank_deg"]
    assert chosen(columns, ["truth.mach", "engine_thrust"], "run")[0] == "truth.mach"


def test_equal_true_quantities_are_one_curve_but_an_estimate_is_drawn_beside_the_truth():
    """On a round planet without relief the three heights are one."""
    height = np.linspace(1e5, 0.0, 50)
    columns = dict.fromkeys(catalogue.ALTITUDE.curves, height)
    assert list(catalogue.ALTITUDE.shown(columns).curves.values()) == ["above the ellipsoid"]
    columns["truth.height_m"] = height + 100.0
    names = list(catalogue.ALTITUDE.shown(columns).curves.values())
    assert names == ["above the ellipsoid", "above the ground"]
    estimated = Plot("k", "height", {"truth.height_m": "true", "nav.height_m": "estimated"})
    assert len(estimated.shown({"truth.height_m": height, "nav.height_m": height}).curves) == 2
    missing = dict.fromkeys(catalogue.ALTITUDE.curves, np.full(50, np.nan))
    assert catalogue.ALTITUDE.shown(missing) is None
    assert catalogue.ALTITUDE.shown(dict.fromkeys(missing, np.empty(0))) is None
