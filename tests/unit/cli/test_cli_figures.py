"""``edl6dof figures``: mean and spread over neighbouring flights."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli_run import run

import edl6dof
from edl6dof.campaign.ensemble import SPEED_STEP_M_S, fly_neighbours, neighbours, sample_means
from edl6dof.metrics.published import PublishedFigure

FEW = 3


@pytest.fixture(scope="module")
def loaded():
    return edl6dof.load("msl")


def test_neighbours_differ_in_entry_speed_by_their_number_and_the_first_is_the_scenario_itself(loaded):
    speeds = [case.truth["initial.speed_m_s"] for case in neighbours(loaded, 4)]
    assert np.diff(speeds) == pytest.approx(SPEED_STEP_M_S, rel=1e-2)
    (row,) = fly_neighbours(loaded, 1)
    own = edl6dof.fly("msl").figures
    assert {name: row[name] for name in own} == own


def test_a_velocity_given_by_components_grows_by_as_much():
    loaded = edl6dof.load("nesc/case09")
    first, _, third = (
        np.linalg.norm(case.truth["initial.velocity_ned_m_s"]) for case in neighbours(loaded, 3)
    )
    assert third - first == pytest.approx(2.0 * SPEED_STEP_M_S, rel=1e-3)


def test_means_and_deviations_are_those_of_the_rows_and_of_sizes_where_no_sign_is_published():
    rows = [{"roll_error_at_ignition_deg": x, "touchdown_s": 10.0 + x} for x in (-2.0, 2.0, 5.0)]
    rows.append({"touchdown_s": None})
    found = sample_means(rows, {"roll_error_at_ignition_deg": PublishedFigure(magnitude=7.7)})
    assert found["roll_error_at_ignition_deg"] == pytest.approx((3.0, np.sqrt(3.0), 3))
    assert found["touchdown_s"].mean == pytest.approx(10.0 + 5.0 / 3.0)
    assert sample_means(rows, {})["roll_error_at_ignition_deg"].mean == pytest.approx(5.0 / 3.0)


def test_command_prints_what_the_flights_gave(capsys, monkeypatch):
    code, out, _ = run(capsys, monkeypatch, "figures", "msl", "-n", str(FEW), "--json")
    data = json.loads(out)
    table = sample_means(fly_neighbours(edl6dof.load("msl"), FEW), {})
    assert code == 0 and data["flights"] == data["within_limits"] == FEW
    assert data["figures"]["parachute_s"]["mean"] == table["parachute_s"].mean
    code, out, _ = run(capsys, monkeypatch, "figures", "msl", "-n", str(FEW))
    assert code == 0 and "3 flights that differ by 1e-06 m/s" in " ".join(out.split())


def test_flights_outside_limits_are_status_1_and_too_few_are_refused(capsys, monkeypatch):
    outside = ("--set", "limits.parachute_mach_max=0.5")
    assert run(capsys, monkeypatch, "figures", "msl", "-n", "2", *outside)[0] == 1
    code, _, err = run(capsys, monkeypatch, "figures", "msl", "-n", "1")
    assert code == 2 and "a spread needs 2 flights" in err
