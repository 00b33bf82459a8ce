"""``edl6dof faults``: a small matrix flown, its files, its words, and what it refuses."""

import json

import pyarrow.parquet as pq
import pytest
from cli_run import run, spawn


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    target = tmp_path_factory.mktemp("faults") / "matrix"
    words = [
        "faults",
        "tianwen1",
        "--thrusters",
        "D7,P1",
        "--phases",
        "hazard_avoidance",
        "--kinds",
        "all",
        "--out",
        str(target),
    ]
    program = spawn(words, target.parent)
    out, err = program.communicate(timeout=600)
    return program.returncode, out, err, target


def test_matrix_is_flown_and_exit_status_says_that_all_survived(flown):
    code, out, err, target = flown
    assert code == 0, err
    assert "6 flights landed within limits" in out
    assert sorted(path.name for path in target.iterdir()) == [
        "faults.parquet",
        "manifest.json",
        "summary.json",
    ]


def test_table_has_a_row_for_each_flight_with_fault_and_isolation(flown):
    rows = pq.read_table(flown[3] / "faults.parquet").to_pylist()
    assert {(row["component"], row["kind"]) for row in rows} == {
        (t, k) for t in ("D7", "P1") for k in ("stuck_off", "stuck_on", "degraded")
    }
    d7 = next(row for row in rows if row["component"] == "D7" and row["kind"] == "stuck_off")
    assert d7["named"] == "D7" and d7["named_kind"] == "stuck off" and 0.1 < d7["time_to_detect_s"] < 1.5
    assert (
        d7["peak_attitude_error_deg"] < 20.0
        and d7["landing_distance_m"] < 10000.0
        and d7["false_alarms"] == 0.0
    )


def test_summary_counts_what_the_rows_say(flown):
    summary = json.loads((flown[3] / "summary.json").read_text(encoding="utf-8"))
    assert summary["flights"] == summary["survived"] == 6 and len(summary["groups"]) == 3
    rows = pq.read_table(flown[3] / "faults.parquet").to_pylist()
    right = sum(row["named"] == row["component"] for row in rows)
    assert sum(group["named_right"] for group in summary["groups"]) == right
    assert all(group["named_wrong"] == 0 for group in summary["groups"])


def test_kinds_of_other_components_fail_each_of_theirs(tmp_path, capsys, monkeypatch):
    target = tmp_path / "matrix"
    words = ("--kinds", "engine_shortfall,wing_lost", "--phases", "slow_descent", "--out", str(target))
    code, out, err = run(capsys, monkeypatch, "faults", "tianwen1", *words)
    assert code == 0, err
    assert "engine shortfall" in out and "2 flights landed within limits" in out
    rows = pq.read_table(target / "faults.parquet").to_pylist()
    assert [(row["component"], row["kind"]) for row in rows] == [
        ("trim_wing", "wing_lost"), ("main", "engine_shortfall"),
    ]  # fmt: skip


def test_a_kind_of_which_the_vehicle_has_no_component_is_refused(capsys, monkeypatch, tmp_path):
    words = ("--kinds", "engine_shortfall", "--out", str(tmp_path / "x"))
    code, _, err = run(capsys, monkeypatch, "faults", "msl", *words)
    assert code == 2 and "there is no engine that could fail" in err and not (tmp_path / "x").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--kinds", "stuckoff"), "--kinds: no 'stuckoff'; did you mean 'stuck_off'?"),
        (("--phases", "lifts"), "--phases: no 'lifts'; did you mean 'lift'?"),
        (("--thrusters", "D1,D99"), "--thrusters: no 'D99'"),
        (("--after", "-1"), "--after: must be a time in s, 0 or more"),
    ],
)
def test_what_does_not_exist_is_refused(words, message, tmp_path, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", *words, "--out", str(tmp_path / "x"))
    assert code == 2 and message in err and not (tmp_path / "x").exists()


def test_an_existing_folder_is_not_replaced_unasked(flown, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", "--out", str(flown[3]))
    assert code == 2 and "exists" in err
