"""``edl6dof faults``: a small matrix flown, its files, its words, and what it refuses."""

import io
import json

import pyarrow.parquet as pq
import pytest
from chance import fewest
from cli_run import run
from in_process import called
from rich.console import Console

from edl6dof.cli.campaign_flight import _LEGEND, _shares, _times
from edl6dof.cli.group import NOT_WITHIN_LIMITS
from edl6dof.vehicle.faults.fault import FAULT_KINDS


def rows_of(folder):
    return pq.read_table(folder / "cases.parquet").to_pylist()


def assert_told(code, out, rows):
    """Exit status and words say how many flights are within limits: nearly always all."""
    good, count = sum(row["success"] for row in rows), len(rows)
    assert good >= fewest(count, 0.95)
    assert code == (NOT_WITHIN_LIMITS if good < count else 0)
    assert (
        f"{count} flights within limits" if good == count else f"{count - good} of {count} flights not"
    ) in out


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    target = tmp_path_factory.mktemp("faults") / "matrix"
    words = [
        *("faults", "tianwen1", "--components", "D7", "--phases", "hazard_avoidance"),
        *("--kinds", "all", "--workers", "1", "--out", str(target)),
    ]
    done = called(*words, cwd=target.parent)
    return done.returncode, done.stdout, done.stderr, target


def test_matrix_is_flown_and_exit_status_says_whether_all_survived(flown):
    code, out, _, target = flown
    assert len(rows_of(target)) == 3 and "required: at least 99.5 %" in out
    assert_told(code, out, rows_of(target))
    assert sorted(path.name for path in target.iterdir()) == [
        "campaign.json", "campaign.yaml", "cases.parquet", "made.json", "report.html", "summary.json",
    ]  # fmt: skip


def test_table_has_a_row_for_each_flight_with_fault_and_isolation(flown):
    rows = rows_of(flown[3])
    assert {(row["component"], row["kind"]) for row in rows} == {
        ("D7", k) for k in ("stuck_off", "stuck_on", "degraded")
    }
    d7 = next(row for row in rows if row["component"] == "D7" and row["kind"] == "stuck_off")
    assert d7["moment"] == "hazard_avoidance" and d7["regime"] == "powered"
    assert d7["named"] == "D7 stuck_off" and d7["name_right"] and d7["kind_right"]
    assert d7["wrongly_named"] is None and 0.1 < d7["isolation_s"] < 3.0
    assert d7["isolation_from_use_s"] == pytest.approx(d7["isolation_s"] + d7["fault_s"] - d7["first_use_s"])
    assert d7["peak_attitude_error_deg"] < 20.0 and d7["landing_distance_m"] < 10000.0


def test_summary_counts_what_the_rows_say(flown):
    faults = json.loads((flown[3] / "summary.json").read_text(encoding="utf-8"))["faults"]
    rows = rows_of(flown[3])
    assert faults["all"]["flights"] == len(faults["groups"]) == 3
    assert faults["all"]["within_limits"] == sum(row["success"] for row in rows)
    assert faults["all"]["kind_right"] == sum(row["kind_right"] for row in rows)
    assert faults["all"]["with_wrong_isolations"] == sum(row["wrongly_named"] is not None for row in rows)


@pytest.mark.long
def test_kinds_of_other_components_fail_each_of_theirs(tmp_path, capsys, monkeypatch):
    target = tmp_path / "matrix"
    words = ("--kinds", "engine_shortfall,wing_lost", "--phases", "slow_descent", "--out", str(target))
    code, out, err = run(capsys, monkeypatch, "faults", "tianwen1", *words)
    assert "engine shortfall" in out, err
    assert_told(code, out, rows_of(target))
    assert [(row["component"], row["kind"]) for row in rows_of(target)] == [
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
    words = ["faults", "tianwen1", *SENSORS, "--phases", "parachute", "--kinds", "false_lock,reading_outage"]
    words += ["--components", "b1,b4,c2,c3,s1"]
    done = called(*words, "--workers", "1", "--out", target, cwd=target.parent)
    return done.returncode, done.stdout, done.stderr, target


@pytest.mark.long
def test_every_beam_that_fails_is_named_and_the_flight_lands(sensors_flown):
    code, out, _, target = sensors_flown
    assert_told(code, out, rows_of(target))
    beams = [row for row in rows_of(target) if row["kind"] == "false_lock"]
    assert [row["component"] for row in beams] == ["b1", "b4", "c2", "c3"]
    for row in beams:
        assert (
            row["named"] == f"beam {row['component']}" and row["name_right"] and row["wrongly_named"] is None
        )
        assert row["instrument_false_alarms"] == 0.0
        assert 0.0 < row["isolation_from_use_s"] < 7.0
        assert abs(row["touchdown_nav_height_m"]) < 0.5


@pytest.mark.long
def test_instrument_that_is_not_used_any_more_is_not_named(sensors_flown):
    """Below the air no stars are looked for."""
    _, _, _, target = sensors_flown
    (row,) = (row for row in rows_of(target) if row["component"] == "s1")
    assert row["named"] is None and row["first_use_s"] is None
    groups = json.loads((target / "summary.json").read_text(encoding="utf-8"))["faults"]["groups"]
    assert [(one["name_right"], one["never_used"]) for one in groups] == [(4, 0), (4, 1)]


def test_sensor_matrix_as_json(tmp_path, capsys, monkeypatch):
    words = (
        *SENSORS,
        "--phases",
        "trim_aoa",
        "--kinds",
        "reading_outage",
        "--components",
        "s2",
        "--json",
        "--out",
        str(tmp_path / "x"),
    )
    code, out, err = run(capsys, monkeypatch, "faults", "tianwen1", *words)
    (row,) = json.loads(out)["rows"]
    assert code == (0 if row["success"] else NOT_WITHIN_LIMITS), err
    assert row["named"] == "star_tracker s2" and 2.0 < row["isolation_s"] < 8.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((*SENSORS, "--kinds", "stuck_off"), "--kinds: no 'stuck_off'"),
        ((*SENSORS, "--kinds", "false_locks"), "did you mean 'false_lock'?"),
        ((*SENSORS, "--components", "D7"), "--components: no 'D7'"),
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
        (("--components", "D1,D99"), "--components: no 'D99'"),
        (("--after", "-1"), "--after: must be a time in s, 0 or more"),
        (("--at", "60,mortars"), "--at: no 'mortars'; did you mean 'mortar'?"),
        (("--at", "every 0"), "--at: 'every 0': the interval must be at least"),
        (("--at", "-5"), "--at: no '-5' (a time in s, 'every 10 s', or an event: "),
        (("--at", ","), "--at: names no moment"),
        (("--at", "nan"), "--at: no 'nan'"),
        (("--at", "60", "--phases", "lift"), "--at: names the moments itself; leave out --phases"),
        (("--at", "60", "--after", "2"), "--at: names the moments itself; leave out --phases"),
        (("--at", "propellant_exhausted"), "--at: no 'propellant_exhausted'"),
        (("--pairs", "--components", "D1"), "--kinds stuck_off: there are not two of thruster to fail"),
        (("--pairs", "--kinds", "wing_lost"), "--kinds wing_lost: there are not two of surface to fail"),
        (("--pairs", "--at", "every 1"), "cells on 1 vehicle; at most 100,000 cells"),
        (("-n", "2"), "has no campaign: section that would disperse it; try tianwen1_mc"),
        (("--seed", "2"), "--seed: is that of dispersed vehicles: give -n N too"),
        (
            ("--set", "faults=[{thruster: D7, kind: stuck_off, at: {time_s: 1}}]"),
            "the scenario has faults of its own",
        ),
    ],
)
def test_what_does_not_exist_is_refused(words, message, tmp_path, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", *words, "--out", str(tmp_path / "x"))
    assert code == 2 and message in err and not (tmp_path / "x").exists()


def test_every_mistake_is_named_at_once(tmp_path, capsys, monkeypatch):
    words = ("--kinds", "stuckoff", "--components", "D99", "--at", "mortars,ignitions", "--phases", "lift")
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", *words, "--out", str(tmp_path / "x"))
    assert code == 2 and not (tmp_path / "x").exists()
    for message in (
        "--kinds: no",
        "--components: no",
        "--at: no 'mortars'",
        "'ignitions'",
        "leave out --phases",
    ):
        assert message in err


def test_an_existing_folder_is_not_replaced_unasked(flown, capsys, monkeypatch):
    code, _, err = run(capsys, monkeypatch, "faults", "tianwen1", "--out", str(flown[3]))
    assert code == 2 and "exists" in err


def test_tables_fit_a_terminal_of_80_columns():
    """For the fault of the longest name, in a matrix of thousands."""
    kind = max(FAULT_KINDS.names, key=len)
    times = {"median": 100.0, "p95": 100.0, "worst": 100.0}
    counts = ("flights", "within_limits", "can_be_known", "name_right", "kind_right", "with_wrong_isolations")
    group = {"kind": kind, "regime": "powered", "from_use_s": times} | dict.fromkeys(counts, 3564)
    for table in (_shares([group]), _times([group], "from_use_s", "")):
        console = Console(width=200, file=io.StringIO())
        console.print(table)
        assert max(map(len, console.file.getvalue().splitlines())) <= 80
    assert max(map(len, _LEGEND.splitlines())) <= 80
