"""The vehicle in two views: scale, names, arrows, legibility; its section of the report."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

import edl6dof
from edl6dof.config.document.source import parse_document
from edl6dof.design.thruster_authority import configurations
from edl6dof.report.document import Table, Text
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.flight.flight_report import vehicle_section
from edl6dof.report.label_layout import sides
from edl6dof.report.matplotlib_figure import matplotlib_figure
from edl6dof.report.page import plotly_figure
from edl6dof.report.vehicle_drawing import SIDE, TOP, authority_tables, exhausts, half_axes, vehicle_figure
from edl6dof.sim.flight import resolved_text
from edl6dof.vehicle.vehicle import VehicleParams

DRAWN = (
    *("tianwen1", "msl", "mars2020", "viking1", "phoenix", "schiaparelli", "pathfinder"),
    *("titan_probe", "stardust", "genesis", "earth_drop", "nesc/case03", "nesc/case04", "nesc/case17"),
)


def vehicle_of(name: str, *sets: str) -> VehicleParams:
    return edl6dof.load(name, sets).scenario.vehicle


def drawn(vehicle: VehicleParams) -> Figure:
    return vehicle_figure(vehicle, configurations(vehicle))


def words_of(panel: Panel) -> list[str]:
    return [words for trace in panel.traces for words in trace.labels if words]


@pytest.mark.parametrize("name", DRAWN)
def test_picture_has_one_scale_and_legible_words(name):
    """Metres are as long along both axes of both views; no words cover others or leave their panel."""
    canvas = matplotlib_figure(drawn(vehicle_of(name)))
    canvas.set_dpi(200)
    canvas.draw_without_rendering()
    unit = np.array([[0.0, 0.0], [1.0, 1.0]])
    scales = [np.diff(axes.transData.transform(unit), axis=0)[0] for axes in canvas.axes]
    np.testing.assert_allclose(scales, scales[0][0], rtol=1e-6)
    for axes in canvas.axes:
        boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
        frame = axes.get_window_extent()
        for box in boxes:
            assert min(box.x0 - frame.x0, frame.x1 - box.x1, box.y0 - frame.y0, frame.y1 - box.y1) > -6.0
        for one, two in combinations(boxes, 2):
            wide = min(one.x1, two.x1) - max(one.x0, two.x0)
            high = min(one.y1, two.y1) - max(one.y0, two.y0)
            assert min(wide, high) < 0.25 * one.height  # ascenders and descenders may meet


@pytest.mark.parametrize("name", DRAWN)
def test_every_nozzle_is_named_in_the_top_view(name):
    vehicle = vehicle_of(name)
    top, side = (
        [one for words in words_of(panel) for one in words.split(", ")] for panel in drawn(vehicle).panels
    )
    nozzles = [one.name for one in (*vehicle.rcs.thrusters, *vehicle.own_engines)]
    assert set(nozzles) <= set(top) and {"x", "y", "z"} <= set(top) & set(side)
    ahead = [jet.name for jet in vehicle.rcs.thrusters if abs(jet.direction[0]) > 0.9]
    assert set(ahead) <= set(side)


def test_arrows_point_with_the_exhaust():
    """A1 of tianwen1 pushes backwards: its exhaust leaves forwards, to the right of the side view."""
    vehicle = vehicle_of("tianwen1")
    for arrows in exhausts(vehicle, 1.0):
        forces = {one.name: one.direction for one in (*vehicle.rcs.thrusters, *vehicle.own_engines)}
        for name, along in zip(arrows.names, arrows.directions, strict=True):
            np.testing.assert_allclose(along, np.negative(forces[name]))
    (line,) = [t for t in drawn(vehicle).panels[1].traces if t.name == "axial"]
    np.testing.assert_allclose([line.x[0], line.y[0]], [-0.45, -0.75])  # A1: z is down
    assert line.x[1] > line.x[0] and line.y[1] == line.y[0]
    top = [t.symbol for t in drawn(vehicle).panels[0].traces if t.name == "axial"]
    assert top == ["x"]  # away from a reader behind the vehicle
    assert [t.symbol for t in drawn(vehicle_of("viking1")).panels[0].traces if t.name == "attitude"] == [
        "circle",
        "circle",
    ]


def test_views_are_right_handed():
    for view in (TOP, SIDE):
        np.testing.assert_allclose(np.cross(view.right, view.up), view.reader)


@pytest.mark.parametrize(
    "name, top, side",
    [
        ("tianwen1", ["diameter 3.40 m"], ["length 2.49 m"]),
        ("nesc/case03", ["width 0.10 m"], ["length 0.20 m", "height 0.06 m"]),
    ],
)
def test_dimensions_are_those_of_the_outline(name, top, side):
    panels = drawn(vehicle_of(name)).panels
    assert [[words for words in words_of(panel) if words.endswith(" m")] for panel in panels] == [top, side]


def test_lander_without_aeroshell_is_drawn_from_its_mesh():
    figure = drawn(vehicle_of("tianwen1", "vehicle.appearance.body=none"))
    assert all(len(panel.traces[0].x) > 8 for panel in figure.panels)
    assert not any(words.endswith(" m") for panel in figure.panels for words in words_of(panel))


def test_tank_is_the_ellipsoid_of_its_inertia():
    """A solid ellipsoid: I_x = m (b^2 + c^2) / 5."""
    a, b, c = axes = np.array([0.3, 0.5, 0.7])
    inertia = 40.0 / 5.0 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    np.testing.assert_allclose(half_axes(40.0, inertia), axes)
    assert not half_axes(40.0, (0.0, 0.0, 0.0)).any()


def test_figure_for_the_page_names_every_group_in_its_legend():
    """plotly leaves out a legend's entry whose first trace is empty."""
    data = plotly_figure(drawn(vehicle_of("tianwen1")))["data"]
    shown = {trace["name"] for trace in data if trace["showlegend"] and len(trace["x"])}
    assert {"horizontal", "axial", "attitude", "fine", "engines", "tank"} <= shown


def run_of(name: str, *sets: str) -> SimpleNamespace:
    """The resolved scenario of a run, without its flight."""
    text = resolved_text(edl6dof.load(name, sets))
    return SimpleNamespace(scenario=parse_document(text, "scenario.yaml").data)


def test_report_draws_the_vehicle_that_was_flown():
    vehicle = vehicle_of("tianwen1", "vehicle.mass.entry_centre_m=[-0.9, 0, 0]")
    figure, *tables, note = vehicle_section(run_of("tianwen1", "vehicle.mass.entry_centre_m=[-0.9, 0, 0]"))
    assert isinstance(figure, Figure) and isinstance(note, Text)
    assert tables == authority_tables(vehicle, configurations(vehicle))
    assert "(-0.900, 0.000, 0.000)" in tables[0].caption
    assert isinstance(tables[0], Table) and all(len(row) == len(tables[0].columns) for row in tables[0].rows)


def test_report_of_what_cannot_be_drawn():
    assert [*vehicle_section(run_of("wu2013"))] == []
    assert [type(block) for block in vehicle_section(run_of("titan_probe"))] == [Figure]
    run = run_of("tianwen1")
    run.scenario["vehicle"]["engines"][0]["model"] = "of_a_plugin"
    (words,) = vehicle_section(run)
    assert "plugin" in words.words


def placed(*others: Trace) -> list[str]:
    point = Trace(np.array([5.0]), np.array([5.0]), kind="points", labels=["W"])
    panel = Panel(Axis("x", (0.0, 10.0)), Axis("y", (0.0, 10.0)), [point, *others])
    return sides(panel, ((0.0, 10.0), (0.0, 10.0)), 300.0, 300.0)[0]


def test_words_keep_off_markers_and_ignore_the_gap_of_a_curve():
    above = np.array([5.4])
    assert placed() == ["above"]
    assert placed(Trace(np.array([5.0]), above, kind="points")) == ["below"]
    across = np.array([0.0, 10.0])
    assert placed(Trace(across, np.array([5.4, 5.4]))) == ["below"]
    broken = Trace(np.array([0.0, 1.0, np.nan, 9.0, 10.0]), np.full(5, 5.4))
    assert placed(broken) == ["above"]
    lines = (Trace(across, np.full(2, y)) for y in (5.0, 4.6))
    assert placed(*lines, Trace(np.array([4.73, 5.0, 5.27]), np.full(3, 5.4), kind="points")) == ["below"]
