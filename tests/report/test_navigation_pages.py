"""What a report says of navigation: made-up errors at known times, and a real flight on instruments."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

import edl6dof
from edl6dof.manifest import seal
from edl6dof.report import terminal
from edl6dof.report.catalogue import STATES
from edl6dof.report.flight import common, navigation_errors
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.runs.run import Run, write_run
from edl6dof.telemetry.channels import CHANNELS
from edl6dof.telemetry.columns import EXCLUDED, IN_USE, NOT_USED, SATURATED, USED

FLOWN_WITH = (
    "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]",
    "flight_software.navigation.filter=error_state",
)


class MadeUp(dict):
    """100 s of telemetry, zero where nothing is said, of a vehicle with two gyros, one accelerometer and two
    beams.
    """

    def __init__(self) -> None:
        self.t = np.arange(0.0, 100.01, 0.5)
        super().__init__({channel.name: np.zeros(len(self.t)) for channel in CHANNELS})
        self["t_s"] = self.t
        self.when = {"mortar": 20.0, "ignition": 60.0, "touchdown": 90.0}
        self.scenario = {
            "sensors": {
                "carried": ["inertial_unit", "radar"],
                "inertial_unit": {
                    "gyros": {"axes": [{"name": "g1"}, {"name": "g2"}]},
                    "accelerometers": {"axes": [{"name": "a1"}]},
                },
                "radar": {"beams": [{"name": "left"}, {"name": "right"}]},
            },
            "flight_software": {"navigation": {"filter": "error_state", "error_state": {"gate": 4.5}}},
        }

    def between(self, since: str = "", until: str = "") -> np.ndarray:
        return (self.t >= self.when.get(since, -np.inf)) & (self.t <= self.when.get(until, np.inf))

    def at(self, name: str, t: float) -> float:
        return float(np.interp(t, self.t, self[name]))


@pytest.fixture
def made_up():
    run = MadeUp()
    t = run.t
    for plot, _ in navigation_errors.ERRORS:
        for k, one in enumerate(plot.apart(), 1):
            error, sigma = one.channels
            run[error], run[sigma] = k * (100.0 - t), np.full(len(t), 50.0 * k)
    run["nav.error_height_m"], run["nav.sigma_height_m"] = 0.01 * t, np.full(len(t), 1.0)
    run["nav.range_innovation"], run["nav.speed_innovation"] = np.full(len(t), 2.0), np.full(len(t), 3.0)
    run["sensed.gyros_saturated"] = np.where((t >= 21.0) & (t < 22.0), 0b11, 0)
    run["nav.gyros_in_use"] = np.where(t < 30.0, 0b11111111, 0b11111101)
    run["nav.accelerometers_in_use"] = run["nav.beams_in_use"] = np.full(len(t), 255.0)
    run["range.left_m"] = np.where((t >= 40.0) & (t < 85.0), 500.0, 0.0)
    run["range.right_m"] = np.where((t >= 50.0) & (t < 85.0), 500.0, 0.0)
    run["nav.beams_used"] = np.where(t < 55.0, 1.0, 3.0)
    return run


def found(run):
    return {block.key: block for block in navigation_errors.figures(run) if hasattr(block, "key")}


def test_perfect_sensors_have_no_such_pages():
    assert [*navigation_errors.figures(MadeUp())] == []


def test_table_holds_error_and_three_sigma_at_each_moment(made_up):
    table = navigation_errors.at_moments(made_up)
    assert table.columns == ["error", "unit", "mortar fire>", "ignition>", "touchdown>"]
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["position east"] == ["m", "160.0 ± 300.0", "80.0 ± 300.0", "21.0 ± 300.0"]
    assert rows["height above the ground"] == ["m", "0.20 ± 3.00", "0.60 ± 3.00", "0.90 ± 3.00"]
    assert len(rows) == 10
    del made_up.when["touchdown"]
    assert navigation_errors.at_moments(made_up).columns[-1] == "ignition>", "only what the flight came to"


def test_velocity_before_the_radar_ends_with_its_first_echo(made_up):
    figure = found(made_up)["nav_velocity"]
    assert all(trace.x[-1] == 39.5 and trace.x[0] == 0.0 for panel in figure.panels for trace in panel.traces)
    assert found(made_up)["nav_landing"].panels[0].traces[0].x[0] == 60.0
    assert found(made_up)["nav_touchdown"].panels[0].traces[0].x[0] == 50.5


def test_bounds_are_symmetrical_and_scales_too(made_up):
    panel = found(made_up)["nav_position"].panels[1]
    upper, lower, error = panel.traces
    assert np.all(upper.y == 300.0) and np.all(lower.y == -300.0)
    assert upper.name == lower.name and error.y[0] == 200.0
    assert panel.y.range == pytest.approx((-324.0, 324.0))


def test_a_bound_far_beyond_the_error_does_not_flatten_it(made_up):
    made_up["nav.sigma_east_m"][:] = 1e6
    assert found(made_up)["nav_position"].panels[1].y.range[1] == pytest.approx(1.08 * common.FAR * 200.0)


def test_innovations_are_shown_while_there_are_echoes_with_the_gate_of_the_filter(made_up):
    figure = found(made_up)["nav_innovation"]
    for panel, value in zip(figure.panels, (2.0, 3.0), strict=True):
        (trace,) = panel.traces
        assert (trace.x[0], trace.x[-1]) == (40.0, 84.5) and np.all(trace.y == value)
        assert [mark.at for mark in panel.marks if mark.label == "gate"] == [4.5]
    made_up.scenario["flight_software"]["navigation"]["filter"] = "of_a_plugin"
    assert not any(
        mark.label == "gate" for panel in found(made_up)["nav_innovation"].panels for mark in panel.marks
    )


def test_echoes_that_the_filter_never_used_make_no_figure(made_up):
    for name in ("nav.range_innovation", "nav.speed_innovation"):
        made_up[name] = np.zeros(len(made_up.t))
    assert "nav_innovation" not in found(made_up) and "nav_landing" in found(made_up)


def test_without_a_radar_nothing_is_said_of_one(made_up):
    for name in ("left", "right"):
        del made_up[f"range.{name}_m"]
    made_up.scenario["sensors"]["carried"] = ["inertial_unit"]
    assert not {"nav_innovation", "nav_landing"} & set(found(made_up))
    figure = found(made_up)["nav_instruments"]
    assert [panel.y.title for panel in figure.panels] == ["gyros", "accelerometers"]


def stretches(panel, lane, state):
    """Beginning and end of each stretch of a state in a lane."""
    traces = [trace for trace in panel.traces if trace.name == state and trace.colour == STATES[state]]
    points = [(x, y) for trace in traces for x, y in zip(trace.x, trace.y, strict=True) if y == lane]
    return [(begin, end) for (begin, _), (end, _) in zip(points[::2], points[1::2], strict=True)]


def test_a_lane_is_what_was_made_of_its_instrument(made_up):
    figure = found(made_up)["nav_instruments"]
    gyros, accelerometers, beams = figure.panels
    assert [panel.y.names for panel in figure.panels] == [["g1", "g2"], ["a1"], ["left", "right"]]
    assert gyros.y.range == (1.5, -0.5), "the first on top"
    assert stretches(gyros, 0, SATURATED) == stretches(gyros, 1, SATURATED) == [(21.0, 22.0)]
    assert stretches(gyros, 0, IN_USE) == [(0.0, 21.0), (22.0, 100.0)]
    assert stretches(gyros, 1, EXCLUDED) == [(30.0, 100.0)] and stretches(gyros, 0, EXCLUDED) == []
    assert stretches(accelerometers, 0, IN_USE) == [(0.0, 100.0)]
    assert stretches(beams, 0, USED) == [(40.0, 85.0)]
    assert stretches(beams, 1, NOT_USED) == [(50.0, 55.0)] and stretches(beams, 1, USED) == [(55.0, 85.0)]


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    fault = "{kind: reading_bias, gyro: g3, at: {phase: lift, plus_s: 30}, reading_bias: {rate_deg_s: 0.5}}"
    flight = edl6dof.fly("tianwen1", [*FLOWN_WITH, f"faults=[{fault}]"])
    folder = tmp_path_factory.mktemp("runs") / "instruments"
    folder.mkdir()
    write_run(flight, folder)
    seal(folder, "flight")
    return flight, Run(folder)


def test_a_flight_with_a_failed_gyro_says_so(flown):
    flight, run = flown
    figures = {figure.key: figure for figure in flight_report(run).figures()}
    assert {"nav_position", "nav_velocity", "nav_attitude", "nav_landing", "nav_touchdown"} <= set(figures)
    gyros = figures["nav_instruments"].panels[0]
    ((begin, end),) = stretches(gyros, gyros.y.names.index("g3"), EXCLUDED)
    failed = next(event["t_s"] for event in run.events if event["key"] == "fault")
    assert 0.0 < begin - failed < 5.0 and end == run.t[-1]
    for panel in (
        panel for key, figure in figures.items() if key.startswith("nav_") for panel in figure.panels
    ):
        assert panel.y.names or "(" in panel.y.title, panel.y.title


def test_table_of_the_flight_agrees_with_its_figures(flown):
    flight, run = flown
    rows = {row[0]: row for row in navigation_errors.at_moments(run).rows}
    height = flight.figures["ignition_nav_height_m"]
    assert float(rows["height above the ground"][3].split(" ± ")[0]) == pytest.approx(height, abs=0.006)
    speed = [float(rows[f"velocity {axis}"][4].split(" ± ")[0]) for axis in ("north", "east", "down")]
    assert np.linalg.norm(speed) == pytest.approx(flight.figures["touchdown_nav_velocity_m_s"], abs=0.002)


def test_terminal_has_the_figures_of_navigation_of_a_flight_on_instruments_only(flown):
    def told(flight):
        console = Console(width=100, record=True, file=io.StringIO())
        terminal.show_flight(console, flight, verbose=True)
        return console.export_text()

    flight, text = flown[0], told(flown[0])
    height = flight.figures["touchdown_nav_height_m"]
    row = next(line for line in text.splitlines() if "estimated height at touchdown" in line)
    assert row.split()[-2:] == ["m", f"{height:,.2f}"]
    perfect = edl6dof.fly("tianwen1", ["sensors.set=perfect", "mission.goal=deployment"])
    assert "Navigation" not in told(perfect)
