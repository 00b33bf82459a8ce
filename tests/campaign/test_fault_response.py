"""What a row of a fault matrix says of a flight, against the flight's own telemetry, events and figures."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

import edl6dof
from edl6dof.campaign.fault_response import Failure, failures, fault_response
from edl6dof.interface.effectors import ThrusterFailure
from edl6dof.metrics.out_of_use import diagnosis_figures
from edl6dof.registry import Member
from edl6dof.vehicle.faults import fault as fault_kinds
from edl6dof.vehicle.faults.component import ThrusterFault
from edl6dof.vehicle.plant import NOT_BEGUN


@pytest.mark.parametrize(
    "fault, failed",
    [
        ("thruster: D7, kind: stuck_on", [Failure("thruster", "D7", "stuck_on")]),
        ("branch: F34, kind: branch_dead", [Failure("thruster", name, "stuck_off") for name in ("F3", "F4")]),
        ("kind: weak_thrusters", [Failure("rcs", "rcs", "weak_thrusters")]),
        ("gyro: g2, kind: reading_bias", [Failure("gyro", "g2", None)]),
        ("kind: engine_dead", [Failure("engine", "main", "engine_dead")]),
    ],
)
def test_a_fault_makes_fail_its_component_or_the_thrusters_behind_it(fault, failed):
    truth = edl6dof.load("tianwen1", [f"faults=[{{{fault}, at: {{time_s: 1}}}}]"]).truth
    assert failures(truth.faults[0], truth) == failed


def made_up(*faults, named=(), begun=None, used=None, excluded=()):
    """A flight of 100 s: faults at 50 s, backshell off at 60 s, touchdown at 90 s; ``used``: intervals (s) in
    which thrusters fire.
    """
    truth = edl6dof.load("tianwen1", [f"faults=[{', '.join(faults)}]"]).truth
    t = np.arange(0.0, 100.0, 0.5)
    zero = np.zeros(len(t))
    table = {"t_s": t, "control.error_pitch_deg": zero + 3.0, "control.error_yaw_deg": zero + 4.0}
    for name in truth.thruster_names:
        first, last = (used or {}).get(name, (0.0, 0.0))
        table[f"valve.{name}"] = (t >= first) & (t < last)
    since = np.full(16, NOT_BEGUN)
    since[: len(truth.faults)] = begun or [50.0] * len(truth.faults)
    return SimpleNamespace(
        scenario=truth,
        loaded=SimpleNamespace(truth=truth),
        telemetry=table,
        plant={"fault_since": since[None]},
        figures={"touchdown_s": 90.0, "backshell_s": 60.0},
        time_s=100.0,
        isolated_faults=[SimpleNamespace(thruster=name, kind=kind, t_s=at) for name, kind, at in named],
        exclusions=[SimpleNamespace(component=a, instrument=b, back=False, t_s=at) for a, b, at in excluded],
    )


DEAD = "{thruster: D1, kind: stuck_off, at: {time_s: 50}}"
OPEN = "{thruster: D1, kind: stuck_on, at: {time_s: 50}}"
ALSO = "{thruster: D2, kind: stuck_off, at: {time_s: 50}}"


def test_a_new_kind_of_fault_is_judged_by_what_it_declares(monkeypatch):
    """A torn valve seat leaks: named open it is named right, in the rows of a matrix and in the figures."""

    class SeatTornParams(ThrusterFault):
        """The valve does not close any more."""

        failure: ClassVar[ThrusterFailure] = "stuck_on"

    flight = made_up(OPEN, named=[("D1", "stuck on", 52.0)])
    truth = flight.loaded.truth
    torn = Member("seat_torn", SeatTornParams, {}, "a test")
    monkeypatch.setattr(fault_kinds, "FAULT_KINDS", SimpleNamespace(member={"seat_torn": torn}.get))
    truth.faults[:] = [truth.faults[0].model_copy(update={"kind": "seat_torn"})]
    row = fault_response(flight)
    assert row["kind_right"] and row["wrongly_named"] is None and row["first_use_s"] == 50.0
    figures = diagnosis_figures(
        flight.isolated_faults, truth.faults, truth.components, truth.branches,
        {"fault_since": flight.plant["fault_since"][0]},
    )  # fmt: skip
    assert figures == {"false_alarms": 0.0, "missed_isolations": 0.0, "time_to_detect_s": 2.0}


def test_times_run_from_the_fault_and_from_the_first_use_after_it():
    row = fault_response(made_up(DEAD, used={"D1": (65.0, 67.0)}, named=[("D1", "stuck off", 68.0)]))
    assert (row["fault_s"], row["first_use_s"], row["used_s"], row["regime"]) == (50.0, 65.0, 2.0, "powered")
    assert (row["isolation_s"], row["isolation_from_use_s"]) == (18.0, 3.0)
    assert row["named"] == "D1 stuck_off" and row["wrongly_named"] is None
    assert row["name_right"] and row["kind_right"] and row["peak_attitude_error_deg"] == 5.0


def test_use_after_the_end_of_a_fault_cannot_reveal_it():
    for duration, used in ((20.0, 60.0), (5.0, None)):
        row = fault_response(made_up(f"{DEAD[:-1]}, duration_s: {duration}}}", used={"D1": (60.0, 62.0)}))
        assert row["first_use_s"] == used and row["fault_s"] == 50.0


def test_what_leaks_is_known_from_the_fault_on():
    row = fault_response(made_up(OPEN))
    assert (row["first_use_s"], row["used_s"], row["regime"]) == (50.0, 40.0, "air")
    assert not row["name_right"] and row["isolation_s"] is None


@pytest.mark.parametrize("used", [{}, {"D1": (10.0, 50.0)}, {"D1": (90.0, 95.0)}, {"D2": (55.0, 60.0)}])
def test_what_is_not_used_between_fault_and_touchdown_cannot_be_known(used):
    row = fault_response(made_up(DEAD, used=used))
    assert row["first_use_s"] is None and row["used_s"] == 0.0 and row["regime"] == "air"


@pytest.mark.parametrize("begun", [NOT_BEGUN, 90.0, 95.0])
def test_a_fault_that_does_not_begin_before_touchdown_says_so(begun):
    row = fault_response(made_up(DEAD, begun=[begun], named=[("D1", "stuck off", 96.0)]))
    assert row["fault_s"] is None and row["regime"] == "not begun" and not row["name_right"]


@pytest.mark.parametrize(
    "named, name_right, kind_right, wrong",
    [
        ([("D1", "degraded", 60.0)], True, False, "D1 degraded"),
        ([("D1", "stuck off", 49.0)], False, False, "D1 stuck_off"),
        ([("D3", "stuck off", 60.0)], False, False, "D3 stuck_off"),
        ([("D3", "stuck on", 60.0), ("D1", "stuck off", 61.0)], True, True, "D3 stuck_on"),
    ],
)
def test_wrong_kinds_sound_thrusters_and_isolations_before_the_fault_are_wrong(
    named, name_right, kind_right, wrong
):
    row = fault_response(made_up(DEAD, used={"D1": (50.0, 60.0)}, named=named))
    assert (row["name_right"], row["kind_right"], row["wrongly_named"]) == (name_right, kind_right, wrong)
    assert row["sound_named"] == (wrong if wrong != "D1 degraded" else None)


def test_a_sound_instrument_excluded_is_a_wrong_isolation_and_saturated_gyros_are_none():
    excluded = [("gyro", "g2", 70.0), ("inertial_unit", "inertial_unit", 71.0)]
    row = fault_response(made_up(DEAD, excluded=excluded))
    assert row["named"] == "gyro g2, inertial_unit" and row["wrongly_named"] == "gyro g2"


def test_every_thruster_of_a_dead_branch_is_to_be_named_and_none_of_a_weak_feed():
    used = {"D1": (55.0, 60.0), "D6": (56.0, 57.0)}
    named = [("D6", "stuck off", 58.0), ("D1", "stuck off", 59.0)]
    dead = "{branch: D16, kind: branch_dead, at: {time_s: 50}}"
    row = fault_response(made_up(dead, used=used, named=named))
    assert row["kind_right"] and (row["first_use_s"], row["isolation_from_use_s"]) == (56.0, 3.0)
    assert not fault_response(made_up(dead, used=used, named=named[:1]))["name_right"]
    weak = "{kind: weak_thrusters, at: {time_s: 50}}"
    row = fault_response(
        made_up(weak, used=used, named=[("D3", "degraded", 58.0), ("D4", "stuck off", 59.0)])
    )
    assert (row["first_use_s"], row["name_right"], row["wrongly_named"]) == (55.0, False, "D4 stuck_off")


def test_of_a_pair_both_are_to_be_named():
    used = {"D1": (55.0, 60.0), "D2": (70.0, 72.0)}
    one = [("D1", "stuck off", 56.0)]
    row = fault_response(made_up(DEAD, ALSO, used=used, named=one))
    assert not row["name_right"] and row["wrongly_named"] is None
    row = fault_response(made_up(DEAD, ALSO, used=used, named=[*one, ("D2", "stuck off", 71.5)]))
    assert row["kind_right"] and (row["first_use_s"], row["used_s"]) == (70.0, 2.0)
    assert (row["isolation_s"], row["isolation_from_use_s"], row["regime"]) == (21.5, 1.5, "powered")
    assert fault_response(made_up(DEAD, ALSO, used={"D1": (55.0, 60.0)}))["first_use_s"] is None
