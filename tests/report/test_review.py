"""What the review shows, against the telemetry, the flight software's own functions and closed forms."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import plotly.graph_objects as go
import pytest

import edl6dof
from edl6dof.fsw.control.phase_plane import switch_axis
from edl6dof.fsw.control.phase_plane_zones import target_rate
from edl6dof.manifest import seal
from edl6dof.report import label_layout
from edl6dof.report.figure import Axis, Panel, Trace
from edl6dof.report.flight import landing, phase_planes, thrusters, trajectory
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.flight.phase_planes import aimed_rate, firing_error
from edl6dof.report.page import plotly_figure
from edl6dof.runs.run import Run, write_run


@pytest.fixture(scope="module")
def figures(run):
    return {figure.key: figure for figure in flight_report(run).figures()}


def radians(gains, *names):
    return {name.rsplit("_deg", 1)[0]: np.radians(gains[name]) for name in names}


def test_zone_border_is_the_rate_the_controller_steers_for(run):
    gains = run.scenario["flight_software"]["control"]["thrust_vector"]["pitch_yaw"]
    plain = {name: gains[name] for name in ("proportional", "derivative")}
    zone = SimpleNamespace(
        **plain, **radians(gains, "near_deg", "far_deg", "rate_deg_s", "deceleration_deg_s2")
    )
    for error in (7.0, 10.0, 20.0, 24.9, 25.1, 90.0):
        own = np.degrees(target_rate.py_func(zone, np.radians(error), 1.0))
        assert aimed_rate(gains, np.array([error]))[0] == pytest.approx(own, rel=1e-12)


def test_firing_border_is_where_the_law_begins_to_fire(run):
    gains = run.scenario["flight_software"]["control"]["phase_plane"]
    names = ("deadband_deg", "rate_limit_deg_s", "acceleration_deg_s2")
    law = SimpleNamespace(hysteresis=gains["hysteresis"], lead=gains["lead_s"], **radians(gains, *names))
    for rate in np.linspace(-4.3, 3.9, 23):
        border = float(firing_error(gains, np.array([rate]))[0])
        before, after = (
            switch_axis.py_func(law, 0, np.radians(border + d), np.radians(rate)) for d in (-1e-6, 1e-6)
        )
        assert (before, after) == (0, 1), rate


def test_error_moves_with_the_rate_beside_it(run):
    """In a phase plane dx/dt = -y; the lift phase turns fast enough to see it."""
    lift = run["guide.phase"] == run.phase_names.index("lift")
    rate = phase_planes.control_rates(run, "bank_to_steer")[0]
    error = np.unwrap(np.radians(run["control.error_roll_deg"]))
    command = np.gradient(np.unwrap(np.radians(run["guide.bank_deg"])), run.t)
    steady = lift & (np.abs(command) < 1e-9) & (np.abs(rate) > 5.0)
    seen = -np.degrees(error[2:] - error[:-2]) / (run.t[2:] - run.t[:-2])
    both = steady[1:-1] & steady[:-2] & steady[2:]
    assert both.sum() > 200
    assert np.median(np.abs(seen[both] - rate[1:-1][both])) < 0.5


def test_path_rate_is_gravity_and_lift_over_speed(run):
    """Before the air: the velocity turns down with g cos(gamma) / v, seen from the inertial frame."""
    rate = np.linalg.norm(phase_planes.path_rate(run), axis=0)
    i = int(np.searchsorted(run.t, 20.0))
    radius = np.linalg.norm([run[f"truth.r_I_{axis}_m"][i] for axis in "xyz"])
    g = run.scenario["planet"]["gravity"]["mu_m3_s2"] / radius**2
    expected = g * np.cos(np.radians(run["truth.flight_path_angle_deg"][i])) / run["truth.speed_m_s"][i]
    # the rotating planet's share is left out here
    assert rate[i] == pytest.approx(np.degrees(expected), rel=0.12)


def test_borders_of_the_corridor_hold_the_limits_they_stand_for(run):
    """Put the drag of each border back into density: there the limited quantity must be the limit."""
    entry = trajectory.entry_state(run)
    limit = run.scenario["limits"]
    borders = {border.name.partition(" ")[0]: border.y for border in trajectory.borders(run, entry)}
    pressure = borders["dynamic"] / entry.drag_per_pressure
    assert pressure == pytest.approx(limit["entry_dynamic_pressure_pa"])
    density = 2.0 * borders["heat"] / entry.drag_per_pressure / entry.speed**2
    flux = run["truth.heat_flux_w_cm2"] / np.sqrt(run["truth.density_kg_m3"]) / run["truth.airspeed_m_s"] ** 3
    i = int(np.argmax(run["truth.heat_flux_w_cm2"]))
    assert flux[i] * np.sqrt(density) * entry.speed**3 == pytest.approx(
        limit["entry_heat_flux_w_cm2"], rel=1e-3
    )
    load = borders["load"] * entry.load_per_pressure / entry.drag_per_pressure / trajectory.G0
    assert load == pytest.approx(limit["entry_load_g0"])


def test_drag_from_forces_is_what_the_flight_computer_measures(run):
    drag, _ = trajectory.aerodynamic_accelerations(run)
    hot = run["truth.dynamic_pressure_pa"] > 1500.0
    assert np.median(np.abs(drag[hot] / run["nav.drag_m_s2"][hot] - 1.0)) < 0.01


def test_thruster_map_holds_the_mean_duty(run, figures):
    heat = figures["thrusters"].panels[0].heat
    names = figures["thrusters"].panels[0].y.names
    for lane, name in enumerate(names):
        assert heat.values[lane].mean() == pytest.approx(run[f"rcs.{name}"].mean(), rel=0.02, abs=1e-4)


def test_thruster_propellant_is_what_the_tank_lost_before_the_engine(run):
    table = thrusters.use(run)
    before = run.t < run.when["ignition"]
    share = sum(
        float(row[-1]) * run[f"rcs.{row[0]}"][before].sum() / max(run[f"rcs.{row[0]}"].sum(), 1e-12)
        for row in table.rows
    )
    lost = run["truth.propellant_kg"][0] - run["truth.propellant_kg"][before][-1]
    assert share == pytest.approx(lost, rel=0.05)


def test_table_of_branches_sums_up_what_thrusters_drew(run):
    (table,) = thrusters.branch_use(run)
    assert table.columns == ["branch", "thrusters", "propellant (kg)>"]
    assert [row[:2] for row in table.rows][:2] == [["D16", "D1, D6"], ["D25", "D2, D5"]]
    by_thruster = sum(float(row[-1]) for row in thrusters.use(run).rows)
    assert sum(float(row[2]) for row in table.rows) == pytest.approx(by_thruster, rel=0.05)


def test_every_axis_is_titled_with_its_unit(figures):
    for figure in figures.values():
        for panel in figure.panels:
            for axis in (panel.x, panel.y):
                assert axis.names or "(" in axis.title, (
                    figure.key,
                    axis.title,
                )


@pytest.fixture(scope="module")
def faulty(tmp_path_factory):
    """D2 stops in the thick of the lift phase."""
    flight = edl6dof.fly("tianwen1", ["faults=[{thruster: D2, kind: stuck_off, at: {time_s: 110}}]"])
    folder = tmp_path_factory.mktemp("runs") / "faulty"
    folder.mkdir()
    write_run(flight, folder)
    seal(folder, "flight")
    return Run(folder)


def test_failed_thruster_is_marked_from_its_failure_on(faulty):
    panel = {figure.key: figure for figure in flight_report(faulty).figures()}["thrusters"].panels[0]
    (band,) = panel.bands
    assert panel.y.names[round(sum(band.y) / 2)] == "D2"
    assert band.x[0] == pytest.approx(110.0, abs=0.03)
    after = panel.heat.x > 111.0
    assert not panel.heat.values[panel.y.names.index("D2"), after].any()


def test_diagnosis_shows_the_torque_that_never_came(faulty):
    """D2 pushes 250 N on an arm of 1.06 m about roll: named at once, it leaves part of that and no more."""
    figure = {figure.key: figure for figure in flight_report(faulty).figures()}["diagnosis"]
    roll = next(trace for trace in figure.panels[0].traces if trace.name == "roll")
    missing = (roll.x > 110.0) & (roll.x < faulty.when["diagnosis"])
    assert 60.0 < np.nanmax(np.abs(roll.y[missing])) < 330.0
    assert np.nanmax(np.abs(roll.y[roll.x < 109.0])) < 60.0
    found = figure.panels[-1].traces[0]
    assert found.x[np.argmax(found.y > 0.0)] == pytest.approx(faulty.when["diagnosis"], abs=0.05)


def test_flow_of_a_valve_that_stays_open_is_shown_also_where_nobody_diagnoses_it(tmp_path):
    """D2 at 270 s draws 250 N / (270 s x 9.80665 m/s2) = 94.4 g/s."""
    fault = "faults=[{thruster: D2, kind: stuck_on, at: {time_s: 40}}]"
    others = ("simulation.time_limit_s=42", "flight_software.diagnosis.enabled=false")
    flight = edl6dof.fly(edl6dof.load("tianwen1_meters", [fault, *others]))
    write_run(flight, tmp_path)
    seal(tmp_path, "flight")
    (table,) = thrusters.branch_use(Run(tmp_path))
    # three standard deviations of the zero offset over 42 s
    assert float(table.rows[1][3]) == pytest.approx(float(table.rows[1][2]), abs=0.05)
    figures = {figure.key: figure for figure in flight_report(Run(tmp_path)).figures()}
    (panel,) = figures["flows"].panels
    assert "diagnosis" not in figures and "D25: D2, D5" in panel.y.title
    true, metered = panel.traces
    open_ = true.x > 40.15
    assert true.y[open_].min() == pytest.approx(94.4, abs=0.1)
    assert metered.y[open_] == pytest.approx(true.y[open_], abs=8.0)
    assert true.y[true.x < 40.0].max() < 50.0


def test_subtitle_names_what_was_made_to_fail(faulty):
    assert "D2 stuck off at 110.0 s" in flight_report(faulty).subtitle


def test_flight_without_flight_software_has_a_report_too(tmp_path):
    flight = edl6dof.fly("nesc/case06")
    write_run(flight, tmp_path)
    seal(tmp_path, "flight")
    report = flight_report(Run(tmp_path))
    assert {section.key for section in report.sections} >= {
        "limits",
        "events",
        "trajectory",
        "configuration",
        "software",
    }
    for figure in report.figures():
        go.Figure(plotly_figure(figure))


def test_point_mass_is_shown_without_an_attitude(tmp_path):
    write_run(edl6dof.fly("zheng2015"), tmp_path)
    seal(tmp_path, "flight")
    report = flight_report(Run(tmp_path))
    keys = {section.key for section in report.sections}
    assert {"trajectory", "guidance"} <= keys and not {"attitude", "phase_planes", "landing"} & keys


def test_planned_ellipse_is_drawn_to_scale_where_the_scenario_has_one(run, figures):
    planned, *others = figures["landing_site"].panels
    (outline,) = (trace for trace in planned.traces if trace.name == "planned ellipse, 56 x 22 km")
    radius = np.hypot(outline.x, outline.y)
    assert (2.0 * radius.max(), 2.0 * radius.min()) == pytest.approx((56.0, 22.0), rel=1e-3)
    assert planned.equal and outline.border and len(others) == 2
    terrain = {**run.scenario["terrain"], "ellipse_length_m": 0.0}
    plain = Run(run.folder)
    plain.scenario = {**run.scenario, "terrain": terrain}
    (without,) = landing.landing_site(plain)
    assert [panel.title for panel in without.panels] == ["from the parachute on", "powered descent"]
    assert "allowed distance" in [trace.name for trace in without.panels[0].traces]


def test_captions_of_phase_planes_speak_of_the_lines_that_are_drawn(run):
    """Where firing begins is not what the controller steers for."""
    captions = {figure.key: figure.caption for figure in phase_planes.figures(run)}
    trim = captions["phase_plane_phase_plane"]
    assert "; green: where it begins to fire. Axes" in trim and "aims for" not in trim
    lift = captions["phase_plane_bank_to_steer"]
    assert lift.startswith("Grey: zone borders of the controller; green: the rate that it aims for. Axes")


def test_words_of_a_point_do_not_stand_on_other_points():
    """A footprint of many flights: the name of a case is not written over its neighbours."""
    named = Trace(np.array([5.0]), np.array([5.0]), "case", "points", labels=("case 1",))
    above = Trace(np.linspace(4.5, 5.5, 11), np.full(11, 5.4), "others", "points")
    panel = Panel(Axis("x"), Axis("y"), [named, above])
    assert label_layout.sides(panel, ((0.0, 10.0), (0.0, 10.0)), 600.0, 300.0)[0] == ["below"]
