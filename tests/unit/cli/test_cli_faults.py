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


SENSORS = (
    "--sensors",
    *("--set", "sensors.carried=[inertial_unit,star_tracker,ground_tracking,radar,switches]"),
    *("--set", "flight_software.navigation.filter=error_state"),
)


@pytest.fixture(scope="module")
def sensors_flown(tmp_path_factory):
    target = tmp_path_factory.mktemp("faults") / "matrix"
    words = ["faults", "tianwen1", *SENSORS, "--phases", "parachute", "--kinds", "false_lock,stars_lost"]
    program = spawn([*words, "--out", str(target)], target.parent)
    out, err = program.communicate(timeout=600)
    return program.returncode, out, err, target


def test_every_beam_that_fails_is_named_and_the_flight_lands(sensors_flown):
    code, out, err, target = sensors_flown
    assert code == 0, err
    assert "5 flights landed within limits" in out and "another instrument was named" in out
    rows = pq.read_table(target / "faults.parquet").to_pylist()
    beams = [row for row in rows if row["kind"] == "false_lock"]
    assert [row["component"] for row in beams] == ["b1", "b2", "b3", "b4"]
    for row in beams:
        assert row["named"] == row["excluded"] == row["component"]
        assert row["instrument_false_alarms"] == 0.0
        assert row["unused_s"] < row["time_to_exclude_s"] < row["unused_s"] + 7.0
        assert abs(row["touchdown_nav_height_m"]) < 0.5


def test_instrument_that_is_not_used_any_more_is_not_named(sensors_flown):
    """Below the air no stars are looked for."""
    _, out, _, target = sensors_flown
    (row,) = (
        row for row in pq.read_table(target / "faults.parquet").to_pylist() if row["kind"] == "stars_lost"
    )
    assert row["named"] is None and row["unused_s"] is None and row["success"]
    summary = json.loads((target / "summary.json").read_text(encoding="utf-8"))
    beams, stars = summary["groups"]
    assert (beams["named_right"], stars["named_right"], stars["never_used"]) == (4, 0, 1)
    assert 0.0 < beams["worst_nav_velocity_m_s"] < 0.3


def test_sensor_matrix_as_json(tmp_path, capsys, monkeypatch):
    words = (
        *SENSORS,
        "--phases",
        "trim_aoa",
        "--kinds",
        "stars_lost",
        "--json",
        "--out",
        str(tmp_path / "x"),
    )
    code, out, err = run(capsys, monkeypatch, "faults", "tianwen1", *words)
    assert code == 0, err
    (row,) = json.loads(out)["rows"]
    assert row["named"] == "star_tracker" and 2.0 < row["time_to_exclude_s"] < 8.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*SENSORS, "--kinds", "stuck_off"), "--kinds: no 'stuck_off'"),
        ((*SENSORS, "--kinds", "false_locks"), "did you mean 'false_lock'?"),
        ((*SENSORS, "--thrusters", "D7"), "--thrusters: instruments fail with --sensors"),
        (("--sensors", "--set", "sensors.set=perfect"), "--sensors: navigation takes the word of ideal"),
        (("--kinds", "hardover"), "--kinds: no 'hardover'"),
    ],
)
def test_faults_of_instruments_and_of_the_vehicle_are_kept_apart(
    words, message, tmp_path, capsys, monkeypatch
):
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", *words, "--out", str(tmp_path / "x"))
    assert code == 2 and message in err and "Traceback" not in err and not (tmp_path / "x").exists()


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
