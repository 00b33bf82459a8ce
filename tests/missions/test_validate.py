"""Missions that flew: what is one, what counts as predicted, and the command on a body that is dropped."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from math import inf

import numpy as np
import pytest
from in_process import called

import edl6dof
from edl6dof.calibration.problem import load_calibration
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import fly_rows
from edl6dof.cli.evidence_tables import show_missions
from edl6dof.config.errors import ConfigError
from edl6dof.metrics.published import PublishedFigure, PublishedPair, published_problems
from edl6dof.missions.agreement import is_calibrated
from edl6dof.missions.mission import Mission, compare, load_mission, percentiles, shipped_missions
from edl6dof.missions.write import causes, cells, failures, outcome, to_csv

#: A dropped body: the campaign draws its entry mass and the density; true speed after 2 s is about 52 m/s.
DROP = """\
name: {name}
planet: mars
vehicle: tianwen1
terrain: {{model: none, site_elevation_m: -4099.4, site_latitude_deg: 25.066, site_longitude_deg: 109.925}}
atmosphere: {{table: marsgram2010_jezero_feb2021_winds.csv}}
simulation: {{time_limit_s: 2.0}}
mission: {{goal: time}}
initial:
  {{altitude_m: 9000.0, latitude_deg: 25.0, longitude_deg: 110.0, speed_m_s: 50.0,
   flight_path_angle_deg: -80.0, azimuth_deg: 0.0}}
published:
  peak_dynamic_pressure_pa: {{value: {pressure}, sigma: 0.5, because: "a made-up value"}}   # [P] nowhere
  touchdown_s: 100.0                                                                   # [D] never reached
  heat_load_j_cm2: {{at_most: 1000.0}}                                                  # [P] a requirement
campaign:
  cases: 5
  truth: {{atmosphere.density_factor: {{kind: normal, three_sigma: 0.3}}}}
"""


@pytest.fixture
def drop(tmp_path):
    """Writes the scenario file of a drop whose published pressure may be chosen."""

    def written(pressure=12.5, name="drop"):
        path = tmp_path / f"{name}.yaml"
        path.write_text(DROP.format(pressure=pressure, name=name))
        return path

    return written


def made_up(drop, *values, cause=""):
    """A mission's comparison over flights with these peak pressures."""
    rows = [
        {
            "peak_dynamic_pressure_pa": value,
            "heat_load_j_cm2": 2000.0 * k,
            "success": not cause,
            "cause": cause,
        }
        for k, value in enumerate(values)
    ]
    return compare(load_mission(str(drop(9.7))), rows)


def test_a_mission_disperses_what_is_published_in_its_own_file():
    found = shipped_missions()
    assert {"tianwen1_mc", "msl_landing_mc", "mars2020_mc", "viking1_mc", "pathfinder_mc"} <= set(found)
    # those inherit what is published of the flight that they are not, or have taken it back
    others = {"tianwen1", "tianwen1_range_trigger", "tianwen1_hazards", "schiaparelli", "msl_mc"}
    assert not others & set(found)
    for name in found:
        mission = load_mission(name, 2)
        assert mission.plan.count == 2 and all(mission.status.values()), name


def test_figures_that_a_scenario_was_calibrated_on_are_told():
    mission = load_mission("tianwen1_mc")
    assert {"lift_start_s", "touchdown_s"} <= mission.fitted and "max_bank_rate_deg_s" not in mission.fitted
    assert load_mission("mars2020_mc").fitted == frozenset()


def test_shipped_missions_count_no_value_that_was_planned_or_commanded_or_that_repeats_another():
    what = {
        name: {figure.name: published.evidence for figure, published in load_mission(name, 2).compared}
        for name in ("insight_mc", "msl_landing_mc", "mars2020_mc", "phoenix_mc", "tianwen1_mc")
    }
    assert what["insight_mc"]["powered_duration_s"] == "planned"
    assert what["msl_landing_mc"]["parachute_height_m"] == "planned"
    assert what["mars2020_mc"]["parachute_mach"] == "reconstructed"
    assert what["phoenix_mc"]["parachute_height_m"] == "reconstructed"
    for name in ("msl_landing_mc", "mars2020_mc"):
        assert (what[name]["backshell_s"], what[name]["engines_start_s"]) == ("flown", "duplicate")
        assert (what[name]["four_engines_s"], what[name]["rover_release_s"]) == ("flown", "duplicate")
    # the balance masses of MSL go by the speed of 13.1 s before its mortar, those of Mars 2020 by their own
    assert what["msl_landing_mc"]["ballast_1_s"] == "duplicate"
    assert what["mars2020_mc"]["ballast_1_s"] == "flown"
    assert what["tianwen1_mc"]["parachute_mach"] == "commanded"
    assert what["tianwen1_mc"]["parachute_s"] == "flown"


def test_what_is_no_evidence_is_shown_and_not_counted(drop):
    path = drop(9.7)
    text = path.read_text()
    path.write_text(text.replace("touchdown_s: 100.0 ", "parachute_mach: {value: 5.0, evidence: commanded} "))
    rows = [{"peak_dynamic_pressure_pa": 19.0, "parachute_mach": 0.2, "success": True, "cause": ""}] * 2

    def told(evidence):
        path.write_text(path.read_text().replace("sigma: 0.5", f"sigma: 0.5, evidence: {evidence}"))
        return compare(load_mission(str(path)), rows)

    planned = told("planned")
    pressure, mach, required = planned.predicted
    assert cells(pressure)[2:] == ("", "", "9.7 +- 0.5", "[P]", "", "", "planned")
    assert cells(mach)[2:] == ("5", "", "", "[D]", "-inf", "", "commanded")
    assert cells(required)[2:5] == ("<= 1000", "", "")
    assert planned.counted == [] and causes(planned) == [] and percentiles([planned]) == []
    assert outcome([planned]) == "no flown value counts; not counted: 1 planned, 1 commanded"
    table = list(csv.DictReader(to_csv([planned]).splitlines()))
    assert [one["evidence"] for one in table] == ["planned", "commanded", ""]
    assert {one["inside"] for one in table} == {""} and table[0]["sigmas"] == ""


def test_a_reconstructed_value_counts_in_a_column_of_its_own(drop):
    path = drop(9.7)
    path.write_text(path.read_text().replace("sigma: 0.5", "sigma: 0.5, evidence: reconstructed"))
    rows = [{"peak_dynamic_pressure_pa": x, "success": True, "cause": ""} for x in (9.0, 11.0)]
    found = compare(load_mission(str(path)), rows)
    assert cells(found.predicted[0])[2:6] == ("", "9.7 +- 0.5", "", "[P]")
    assert found.counted[0].evidence == "reconstructed" and "not counted" not in outcome([found])
    path.write_text(path.read_text().replace("# [P] nowhere", "# [R] from memory"))
    assert compare(load_mission(str(path)), rows).predicted[0].evidence == "recalled"


def test_dispersions_of_made_up_missions_are_judged_by_flights_whose_truth_is_known(drop):
    """Real flights of a mission whose dispersions are right give uniform percentiles; those of missions with
    half and twice the standard deviation fail.
    """
    path = drop()
    text = path.read_text()

    def flown(three_sigma, flights, seed):
        own = text.replace("three_sigma: 0.3", f"three_sigma: {three_sigma}")
        path.write_text(own.replace("cases: 5", f"cases: 5\n  seed: {seed}"))
        mission = load_mission(str(path), flights)
        return mission, mission.fly(None, lambda done, count: None)

    truth = [row["peak_dynamic_pressure_pa"] for row in flown(0.3, 80, seed=2)[1]]

    def judged(three_sigma):
        mission, rows = flown(three_sigma, 100, seed=1)
        figure = mission.compared[0].figure
        found = []
        for value in truth:
            one = PublishedPair(figure, PublishedFigure(value=value))
            found.append(compare(replace(mission, compared=(one,)), rows))
        return percentiles(found)

    right = judged(0.3)
    counts, _ = np.histogram(right, bins=5, range=(0.0, 1.0))
    assert is_calibrated(right)
    assert np.sum((counts - 16.0) ** 2) / 16.0 < 18.5  # chi-squared with 4 d.o.f., 0.1 %
    assert not is_calibrated(judged(0.15)) and not is_calibrated(judged(0.6))


def test_a_value_quoted_from_memory_does_not_count(drop):
    path = drop(9.7)
    path.write_text(path.read_text().replace("# [P] nowhere", "# [R] from memory"))
    recalled = compare(
        load_mission(str(path)), [{"peak_dynamic_pressure_pa": 19.0, "success": True, "cause": ""}]
    )
    assert cells(recalled.predicted[0])[5:] == ("[R]", "+18.6", "", "recalled")
    assert [one.figure.name for one in recalled.counted] == ["touchdown_s"]
    assert outcome([recalled]).endswith("; not counted: 1 recalled")


def test_a_requirement_is_no_evidence():
    own = "published={heat_load_j_cm2: {at_most: 5.0, evidence: planned}}"
    with pytest.raises(ConfigError, match="a requirement is never counted: leave it out"):
        edl6dof.load("earth_drop", [own])


def test_a_calibration_explains_no_plan():
    plan = "published={lift_start_s: {value: 67.9, sigma: 0.1, evidence: planned}}"
    with pytest.raises(ConfigError, match="is no flown value with a sigma"):
        load_calibration("tianwen1", (plan,))


def test_distance_to_a_flown_value_counts_its_own_sigma_and_that_of_one_flight():
    assert PublishedFigure(value=10.0, sigma=0.3).away(12.0, 0.4) == pytest.approx(4.0)
    assert PublishedFigure(value=10.0).away(12.0, 0.5) == pytest.approx(4.0)
    assert PublishedFigure(magnitude=10.0, sigma=0.3).away(-9.0, 0.4) == pytest.approx(-2.0)
    assert (
        PublishedFigure(value=4.0).away(4.0, 0.0) == 0.0 and PublishedFigure(value=4.0).away(3.0, 0.0) == -inf
    )


def test_a_value_is_predicted_within_three_standard_deviations(drop):
    near, far = made_up(drop, 9.0, 11.0), made_up(drop, 19.0, 19.1)
    pressure = near.predicted[0]
    assert (pressure.mean, pressure.flights) == (10.0, 2)
    # the flown 9.7 has a standard deviation of 0.5: it lies 1.4 above one flight and 2.6 below the other
    assert pressure.share == pytest.approx(0.5 * (0.9192 + 0.0047), abs=1e-4)
    assert pressure.score == pytest.approx(0.5 * (0.7 + 1.3) - 0.5 * 1.0) and cells(pressure)[7] == "46"
    assert pressure.deviation == pytest.approx(2.0**0.5) and pressure.inside
    assert pressure.sigmas == pytest.approx(0.3 / (2.0 + 0.25) ** 0.5)
    assert not far.predicted[0].inside and cells(far.predicted[0])[-1] == "outside"
    # a figure that no flight reached is not predicted; a requirement is no flown value
    assert [one.inside for one in near.counted] == [True, False] and len(percentiles([near])) == 2
    assert cells(near.predicted[2])[-1] == "50 % meet"
    assert outcome([near]) == (
        "2 flown values not fitted: 50 % (9 to 91) in the central 50 %, 50 % (9 to 91) in the central 68 %, "
        "50 % (9 to 91) in the central 95 %; 1 within 3 sigma"
    )
    assert causes(far) == [
        "drop, peak dynamic pressure: a made-up value",
        "drop, touchdown: no cause is known",
    ]
    assert failures(made_up(drop, 9.0, 11.0, cause="crashed")) == ["drop: 2 flights: crashed"]


def test_the_table_has_whole_words_in_80_columns(monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("COLUMNS", "80")
    missions = []
    for name in ("tianwen1_mc", "msl_landing_mc", "schiaparelli_mc"):
        mission = load_mission(name, 2)
        near = [
            {figure.name: factor * published.number for figure, published in mission.compared}
            for factor in (0.97, 1.03)
        ]
        missions.append(compare(mission, [{**row, "success": True, "cause": ""} for row in near]))
    show_missions(missions, tmp_path)
    printed = capsys.readouterr().out.splitlines()
    table = printed[: next(k for k, line in enumerate(printed) if line.startswith(f"{tmp_path}: "))]
    assert max(map(len, table)) <= 80
    figures = [row.figure for one in missions for row in one.predicted]
    words = {word for figure in figures for word in figure.meaning.split()} | {"commanded", "duplicate"}
    assert words <= {word for line in table for word in line.split()}


def test_the_command_writes_table_and_picture_and_tells_the_goal_by_its_status(drop, tmp_path):
    done = called("validate", drop(), "-n", "12", "--jobs", "1", cwd=tmp_path)
    folder = tmp_path / "runs" / "validation"
    assert done.returncode == 0 and "drop, touchdown: no cause is known" in done.stdout, done.stderr
    names = {path.name for path in folder.iterdir()}
    assert names == {
        *(
            "prediction.json",
            "validation.md",
            "validation.csv",
            "validation.json",
            "validation.png",
            "drop.parquet",
            "manifest.json",
        )
    }
    rows = list(csv.DictReader((folder / "validation.csv").open(encoding="utf-8")))
    assert [row["figure"] for row in rows] == ["peak_dynamic_pressure_pa", "touchdown_s", "heat_load_j_cm2"]
    assert [row["status"] for row in rows] == ["published", "derived", "published"]
    found = json.loads((folder / "validation.json").read_text(encoding="utf-8"))
    figures = {one["figure"]: one for one in found["missions"][0]["figures"]}
    assert (found["flown_values"], found["calibrated"]) == (2, True)
    assert [one["inside"] for one in found["central_intervals"]] == [1, 1, 1]
    assert found["missions"][0]["mahalanobis"]["values"] == 1
    assert figures["touchdown_s"]["sigmas"] is None and figures["heat_load_j_cm2"]["share"] == 1.0
    mean = float(rows[0]["mean"])
    assert mean == pytest.approx(12.5, abs=1.5)
    assert f"| {mean:.1f} ± " in (folder / "validation.md").read_text(encoding="utf-8")
    foretold = (folder / "prediction.json").read_bytes()
    forecast = json.loads(foretold)["missions"][0]
    assert forecast["figures"][0]["mean"] == mean and forecast["figures"][1]["mean"] is None
    assert forecast["covariance"][0][0] == pytest.approx(forecast["figures"][0]["deviation"] ** 2)
    assert forecast["covariance"][0][1] is None and forecast["covariance"][0][2] > 0.0
    other = called("validate", drop(40.0), "-n", "12", "--out", "other", cwd=tmp_path)
    assert other.returncode == 1 and (tmp_path / "other" / "prediction.json").read_bytes() == foretold
    again = called("validate", drop(), "-n", "12", "--jobs", "2", "--force", cwd=tmp_path)
    assert again.stdout == done.stdout
    before = (folder / "validation.csv").read_bytes()
    assert (
        called("validate", drop(), "-n", "12", cwd=tmp_path).returncode == 0
    )  # the folder is there: beside it
    assert (folder / "validation.csv").read_bytes() == before
    assert (tmp_path / "runs" / "validation-2" / "validation.csv").read_bytes() == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("msl",), "is no mission: it has no campaign: section (shipped missions: "),
        (("earth_drop",), "has no published: and no campaign: section"),
        (("viking1_mc", "viking1_mc"), "viking1_mc: named twice"),
        (("viking1_mc", "-n", "1"), "-n 1: a spread needs 2 flights"),
        (("no_such",), "no such scenario file"),
    ],
)
def test_what_is_no_mission_is_refused(words, message, tmp_path):
    done = called("validate", *words, cwd=tmp_path)
    assert done.returncode == 2 and message in done.stderr and not any(tmp_path.iterdir())


def test_figures_at_any_event_of_the_mission_are_formed_where_they_are_published():
    own = "published={trim_wing_height_m: 12000, mortar_s: 259.0, mortar_mach: {value: 1.7, sigma: 0.1}}"
    loaded = edl6dof.load("msl", [own])
    (row,) = fly_rows(loaded, [Case(0)])
    assert row["mortar_s"] == row["parachute_s"] and row["mortar_mach"] == row["parachute_mach"]
    assert row["parachute_height_m"] < row["trim_wing_height_m"] < row["parachute_height_m"] + 6000.0
    assert list(published_problems(["mortar_s", "mortar_colour", "morta_s"], {"mortar": None})) == [
        "published.mortar_colour",
        "published.morta_s",
    ]
    with pytest.raises(ConfigError, match="no figure of a flight has this name, nor is it an event"):
        edl6dof.load("msl", ["published={no_event_s: 1.0}"])
    assert isinstance(load_mission("mars2020_mc", 2), Mission)


def test_a_flight_may_end_with_an_event_of_its_mission():
    """MSL's entry ended as its wing opens, by an event that is found by its name."""
    goal = ["mission.goal=event", "mission.goal_event=trim_wing"]
    flight = edl6dof.fly("msl", [*goal, "sensors.set=perfect"])
    assert flight.success and flight.outcome == "trim wing commanded"
    assert flight.events[-2]["key"] == "trim_wing" and "parachute_s" not in flight.figures
    with pytest.raises(ConfigError, match="no event named 'no_such' with which the flight ends"):
        edl6dof.load("msl", ["mission.goal_event=no_such"])
    with pytest.raises(ConfigError, match="name the event with which the flight ends"):
        edl6dof.load("msl", goal[:1])


@pytest.fixture(scope="module")
def sky_crane():
    """MSL to the release of its rover."""
    return edl6dof.fly("msl_landing")


def test_balance_masses_take_the_lift_away_and_the_rover_is_let_out_under_four_engines(sky_crane):
    assert sky_crane.success and sky_crane.outcome == "rover jettisoned within limits"
    t = sky_crane.telemetry
    alpha = t["truth.alpha_deg"]
    when = {one["key"]: one["t_s"] for one in sky_crane.events}
    before, after = (
        np.searchsorted(t["t_s"], when["ballast_1"] - 1.0),
        np.searchsorted(t["t_s"], when["mortar"]),
    )
    assert alpha[before] < -12.0 and abs(alpha[after]) < 4.0
    mass = t["truth.mass_kg"]
    gone = np.searchsorted(t["t_s"], when["ballast_3"] + 0.1)
    assert mass[before] - mass[gone] == pytest.approx(150.0, abs=1.0)
    # it stands in the air on what four canted engines can give
    weight = 3.72 * mass[-2]
    assert t["truth.engine_thrust_n"][-2] == pytest.approx(weight / np.cos(np.radians(25.0)), rel=0.05)
    assert t["truth.speed_m_s"][-2] < 1.5 and 15.0 < t["truth.height_m"][-2] < 25.0


def test_pathfinder_stops_above_the_ground_and_viking_stands_on_it():
    pathfinder, viking = edl6dof.fly("pathfinder"), edl6dof.fly("viking1")
    assert pathfinder.success and 5.0 < pathfinder.figures["bridle_cut_height_m"] < 30.0
    spin = pathfinder.telemetry["truth.rate_p_deg_s"]
    assert spin[np.searchsorted(pathfinder.telemetry["t_s"], 150.0)] == pytest.approx(12.0, abs=1.0)
    assert viking.outcome == "landed within limits"
    t = viking.telemetry
    steady = (t["truth.mach"] > 10.0) & (t["truth.dynamic_pressure_pa"] > 1000.0)
    assert np.mean(t["truth.alpha_deg"][steady]) == pytest.approx(-11.2, abs=1.0)
