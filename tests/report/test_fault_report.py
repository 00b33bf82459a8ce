"""Figures of a fault matrix, and the maps of its report, from rows that are written down here."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from edl6dof.campaign.executor import table_of
from edl6dof.campaign.faults import fault_figures
from edl6dof.report.campaign.faults import became, blocks, headline
from edl6dof.report.document import Table
from edl6dof.report.figure import Figure
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.page import plotly_figure

FOUND = {"name_right": True, "kind_right": True}


def row(
    case, component, moment, kind="stuck_off", regime="air", success=True, use=None, isolation=None, **more
):
    """A fault at 10 s, first used ``use`` s and named ``isolation`` s after it."""
    found = {
        "case": case, "component": component, "kind": kind, "moment": moment, "success": success,
        "cause": "" if success else "lost", "outcome": "landed within limits" if success else "lost",
        "fault_s": 10.0, "first_use_s": None if use is None else 10.0 + use, "used_s": 0.5, "regime": regime,
        "named": None, "name_right": False, "kind_right": False, "isolation_s": isolation,
        "isolation_from_use_s": None if isolation is None else isolation - use, "wrongly_named": None,
        "sound_named": None,
    }  # fmt: skip
    return found | more


ROWS = [
    row(0, "A1", "10 s", use=2.0, isolation=5.0, named="A1 stuck_off", **FOUND),
    row(1, "A2", "10 s", use=0.0),
    row(2, "A3", "10 s"),
    row(3, "A1", "20 s", regime="powered", use=1.0, isolation=1.5, named="A1 stuck_off", **FOUND),
    row(4, "A2", "20 s", use=0.0, isolation=3.0, name_right=True, named="A2 degraded",
        wrongly_named="A2 degraded", success=False),
    row(5, "A3", "20 s", use=0.0, named="A1 stuck_on", wrongly_named="A1 stuck_on",
        sound_named="A1 stuck_on"),
    row(6, "A1", "30 s", use=0.0, isolation=7.0, named="A1 stuck_off", **FOUND),
    row(7, "A1", "30 s", use=0.0, isolation=20.0, named="A1 stuck_off", success=False, **FOUND),
    {"case": 8, "component": "A2", "kind": "stuck_off", "moment": "30 s", "success": False,
     "cause": "could not fly", "outcome": "could not fly"},
]  # fmt: skip


def results(rows):
    return SimpleNamespace(has_faults=True, table=table_of(rows))


def test_largest_effect_is_that_of_faults_in_use_that_were_not_named():
    sized = dict(kind="reading_bias", use=0.0, success=True)
    effect = "touchdown_nav_velocity_m_s"
    rows = [
        row(0, "b1", "10 s", size="speed_m_s=0.2", **sized, **{effect: 0.3}),
        row(1, "b2", "10 s", size="speed_m_s=0.1", **(sized | {"success": False}), **{effect: -0.4}),
        row(2, "b1", "10 s", size="speed_m_s=2", isolation=1.0, **sized, **{effect: 9.0}, **FOUND),
        row(3, "b1", "10 s", size="speed_m_s=5", **(sized | {"use": None}), **{effect: 9.0}),
        row(4, "b1", "10 s", size="range_m=5", isolation=1.0, **sized, **FOUND),
        row(5, "b1", "10 s", **sized),
    ]
    speed, range_ = fault_figures(table_of(rows).to_pylist())["undetected"]
    assert (speed["parameter"], speed["flights"], speed["undetected"]) == ("speed_m_s", 3, 2)
    assert (speed["largest"], speed[effect], speed["not_within_limits"]) == (0.2, 0.4, 1)
    assert (range_["undetected"], range_["largest"], range_[effect]) == (0, None, None)


def test_shares_are_of_what_can_be_known_and_times_of_what_is_right():
    figures = fault_figures(table_of(ROWS).to_pylist())
    every, (air, powered, neither) = figures["all"], figures["groups"]
    assert (every["flights"], every["within_limits"], every["not_begun"]) == (9, 6, 1)
    assert (every["can_be_known"], every["never_used"]) == (7, 1)
    assert (every["name_right"], every["kind_right"], every["with_wrong_isolations"]) == (5, 4, 2)
    assert (air["regime"], air["flights"], air["kind_right"]) == ("air", 7, 3)
    assert air["from_use_s"] == {"median": 7.0, "p95": pytest.approx(18.7), "worst": 20.0}
    assert powered["from_use_s"]["worst"] == 0.5 and powered["from_fault_s"]["worst"] == 1.5
    assert (neither["regime"], neither["flights"], neither["not_begun"]) == ("not begun", 1, 1)
    required = {one["meaning"]: (one["value"], one["met"]) for one in figures["acceptance"]}
    assert required == {
        "within limits": (pytest.approx(100 * 6 / 9), False),
        "right name and kind, if it fires or leaks": (pytest.approx(100 * 4 / 7), False),
        "flights with a wrong isolation": (pytest.approx(100 * 2 / 9), False),
        "median time to isolation in the air": (7.0, False),
        "median time to isolation in powered flight": (0.5, True),
        "longest time to isolation": (20.0, False),
    }


def test_of_pairs_only_the_limits_are_required_and_nothing_of_other_components():
    (one,) = fault_figures([row(0, "A1 + A2", "10 s"), row(1, "A1 + A3", "10 s", success=False)])[
        "acceptance"
    ]
    assert one == {
        "meaning": "within limits", "value": 50.0, "unit": "%", "limit": "at least 100 %", "met": False,
    }  # fmt: skip
    assert fault_figures([row(0, "main", "10 s", kind="engine_shortfall")])["acceptance"] == []


def test_map_shows_what_became_of_each_fault_the_worst_of_several(tmp_path):
    found = list(blocks(results(ROWS)))
    (figure,) = (one for one in found if isinstance(one, Figure))
    became, taken = figure.panels
    assert (became.x.names, became.y.names) == (["10 s", "20 s", "30 s"], ["A3", "A2", "A1"])
    names = [trace.name for trace in became.traces]
    assert names == [
        "never used after it: cannot be known", "right name and kind", "not named, or not all",
        "named with a wrong kind", "a healthy one named", "not within limits",
    ]  # fmt: skip
    colours = {trace.name: trace.colour for trace in became.traces}
    assert [colours[name] for name in names[:5]] == list(became.heat.colours)
    assert np.nan_to_num(became.heat.values, nan=-1).tolist() == [[0, 4, -1], [2, 3, 0], [1, 1, 1]]
    assert np.nan_to_num(taken.heat.values, nan=-1).tolist() == [[-1, -1, -1], [-1, -1, -1], [3.0, 0.5, 13.5]]
    crosses = became.traces[-1]
    assert sorted(zip(crosses.x, crosses.y, strict=True)) == [(1, 1), (2, 1), (2, 2)]
    words = became.heat.labels[2][2]
    assert (
        "A1 stuck_off at 30 s" in words
        and "case 6: landed within limits; A1 stuck_off named, 7.00 s" in words
    )
    assert "case 7: lost" in words
    drawn = plotly_figure(figure)
    cells = next(item for item in drawn["data"] if item["type"] == "heatmap")
    kinds = drawn["layout"][cells["coloraxis"]]
    assert kinds["showscale"] is False and kinds["colorscale"][2:4] == [
        [0.2, colours[names[1]]],
        [0.4, colours[names[1]]],
    ]
    assert (kinds["cmin"], kinds["cmax"]) == (-0.5, 4.5) and cells["text"][2][2] == words
    write_figure(figure, tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 5000


def test_what_is_lost_wrong_or_missed_is_listed_by_its_case():
    tables = {one.caption: one for one in blocks(results(ROWS)) if isinstance(one, Table)}
    cases = {name: [line[0] for line in table.rows] for name, table in tables.items()}
    assert cases["Not within limits"] == ["4", "7", "8"]
    assert cases["Wrong isolations"] == ["4", "5"]
    assert cases["In use, and not named"] == ["1", "5"]
    words = "6 of 9 flights within limits; 4 of 7 faults that can be known rightly named"
    assert headline(results(ROWS)) == (words, "warn")
    assert headline(results(ROWS[3:4]))[1] == "good"


def test_a_sound_one_named_beside_the_right_one_spoils_the_cell():
    right = row(0, "A1", "10 s", use=0.0, isolation=1.0, named="A1 stuck_off, A2 stuck_on", **FOUND)
    assert (
        became(right) == 1
        and became(right | dict.fromkeys(("wrongly_named", "sound_named"), "A2 stuck_on")) == 4
    )


def test_pairs_are_a_map_of_one_by_the_other_for_each_moment(tmp_path):
    pairs = ["A1 + A2", "A1 + A3", "A2 + A3"]
    rows = [row(k, pair, moment) for moment in ("10 s", "20 s") for k, pair in enumerate(pairs)]
    first, second = (one for one in blocks(results(rows)) if isinstance(one, Figure))
    assert (first.title, second.title) == ("stuck off, pairs at 10 s", "stuck off, pairs at 20 s")
    assert first.key != second.key
    shown = first.panels[0]
    assert shown.x.names == shown.y.names == ["A1", "A2", "A3"]
    assert np.isfinite(shown.heat.values).tolist() == [[False] * 3, [True, False, False], [True, True, False]]


def test_names_along_a_long_axis_are_thinned():
    rows = [row(k, "A1", f"{10 * k} s") for k in range(54)]
    (figure,) = (one for one in blocks(results(rows)) if isinstance(one, Figure))
    shown = [name for name in figure.panels[0].x.names if name]
    assert len(figure.panels[0].x.names) == 54 and shown[:2] == ["0 s", "60 s"] and len(shown) == 9


def test_a_map_of_one_colour_says_what_it_means():
    (figure,) = (one for one in blocks(results([row(0, "A1", "10 s")])) if isinstance(one, Figure))
    assert len(figure.entries) == 1
    assert plotly_figure(figure)["layout"]["showlegend"]
