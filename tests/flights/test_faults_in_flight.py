"""Faults in the nominal flight: same bits before, the right consequence after, and in the timeline and the
telemetry.
"""

import numpy as np
import pytest

import edl6dof


def flown(*faults, scenario="tianwen1"):
    return edl6dof.fly(scenario, [f"faults=[{', '.join(faults)}]"])


def keys(flight):
    return {event["key"]: event["t_s"] for event in flight.events}


@pytest.fixture(scope="module")
def dead_d7():
    return flown("{thruster: D7, kind: stuck_off, at: {phase: hazard_avoidance, plus_s: 2}}")


def test_flight_computer_flies_as_if_nothing_were_until_the_fault(nominal, dead_d7):
    since = next(event["t_s"] for event in dead_d7.events if event["key"] == "fault")
    before = dead_d7.log["t"] < since
    assert before.sum() > 20000
    assert nominal.log[: before.sum()].tobytes() == dead_d7.log[before].tobytes()


def test_fault_is_in_the_timeline_and_the_telemetry(dead_d7):
    event = next(event for event in dead_d7.events if event["key"] == "fault")
    start = next(event for event in dead_d7.events if event.get("role") == "hazard_avoidance")
    assert event["name"] == "fault: D7 stuck off" and event["t_s"] == pytest.approx(start["t_s"] + 2.0)
    after = dead_d7.telemetry["t_s"] > event["t_s"] + 0.03
    assert np.all(dead_d7.telemetry["fault.D7"][after] == 1) and np.all(
        dead_d7.telemetry["rcs.D7"][after] == 0.0
    )
    assert not np.any(dead_d7.telemetry["fault.D7"][~after][:-2]) and not np.any(
        dead_d7.telemetry["fault.D8"]
    )


def test_lost_wing_leaves_the_moment_of_the_offset_centre_of_mass_to_the_thrusters(nominal):
    """The wing cancels it in the nominal: about 255 N m at 500 Pa (reference data, section 1.4)."""
    flight = flown("{kind: wing_lost, at: {phase: lift}}")
    assert np.all(flight.telemetry["truth.trim_wing"] == 0.0)
    assert keys(flight)["trim_wing"] == flight.figures["trim_wing_s"] and "trim_wing_open" not in keys(flight)

    def alpha(one):
        t = one.telemetry["t_s"] - one.figures["trim_wing_s"]
        return np.mean(one.telemetry["truth.alpha_deg"][(t > 3.0) & (t < 10.0)])

    assert alpha(flight) < alpha(nominal) - 3.0


def test_wing_that_fails_after_it_opened_was_open(nominal):
    """The command and the end of the way are two events; the second is when the telemetry first shows the
    wing open.
    """
    table, opened = nominal.telemetry, keys(nominal)["trim_wing_open"]
    first = np.argmax(table["truth.trim_wing"] == 1.0)
    assert table["t_s"][first - 1] < opened <= table["t_s"][first]
    assert keys(nominal)["trim_wing"] == nominal.figures["trim_wing_s"] < opened
    late = flown("{kind: wing_lost, at: {time_s: %.1f}}" % (opened + 5.0))
    assert keys(late)["trim_wing_open"] == opened
    stuck = flown("{kind: wing_stuck, wing_stuck: {opening: 0.5}, at: {time_s: 0}}")
    assert "trim_wing_open" not in keys(stuck) and stuck.telemetry["truth.trim_wing"].max() == 0.5


def test_late_parachute_opens_lower_and_slower(nominal):
    flight = flown("{kind: parachute_delay, parachute_delay: {delay_s: 4.0}, at: {time_s: 0}}")
    assert flight.figures["parachute_s"] == pytest.approx(nominal.figures["parachute_s"] + 4.0, abs=0.03)
    assert flight.figures["parachute_mach"] < nominal.figures["parachute_mach"]


def test_engine_shortfall_takes_away_its_share_of_thrust():
    flight = flown(
        "{kind: engine_shortfall, engine_shortfall: {thrust_factor: 0.9}, at: {phase: powered_deceleration}}"
    )
    assert flight.telemetry["truth.engine_thrust_n"].max() == pytest.approx(0.9 * 7500.0, rel=1e-3)


@pytest.mark.parametrize(
    ("thruster", "kind", "phase"),
    [
        ("D7", "stuck_off", "hazard_avoidance"),
        pytest.param("P4", "stuck_off", "powered_deceleration", marks=pytest.mark.long),
        pytest.param("D1", "stuck_on", "lift", marks=pytest.mark.long),
        ("P4", "stuck_on", "parachute"),
        pytest.param("A3", "stuck_on", "hazard_avoidance", marks=pytest.mark.long),
        ("P4", "degraded", "powered_deceleration"),
    ],
)
def test_faulty_thruster_is_named_and_the_vehicle_lands(thruster, kind, phase):
    flight = flown(f"{{thruster: {thruster}, kind: {kind}, at: {{phase: {phase}, plus_s: 1}}}}")
    assert flight.outcome == "landed within limits"
    assert [fault.thruster for fault in flight.isolated_faults] == [thruster]
    assert flight.figures["false_alarms"] == 0.0 and flight.figures["time_to_detect_s"] > 0.0
    assert [event["isolated"] for event in flight.events if event["key"] == "diagnosis"] == [
        flight.isolated_faults[0].label
    ]


@pytest.mark.parametrize(("scenario", "most_s"), [("tianwen1", 3.6), ("tianwen1_meters", 1.0)])
@pytest.mark.parametrize(
    ("thruster", "after_s"),
    [
        pytest.param(
            f"P{number}", after_s, marks=[] if number == place and number in (1, 4) else pytest.mark.long
        )
        for number in (1, 2, 3, 4)
        for place, after_s in enumerate((0.5, 1.0, 3.0, 6.0, 8.0))
    ],
)
def test_stuck_pitch_thruster_is_named_and_not_the_sound_opposite_that_fires_against_it(
    scenario, most_s, thruster, after_s
):
    """Whenever in hazard avoidance it happens; every thruster of another branch is in use at the end."""
    flight = flown(
        f"{{thruster: {thruster}, kind: stuck_on, at: {{phase: hazard_avoidance, plus_s: {after_s}}}}}",
        scenario=scenario,
    )
    assert flight.outcome == "landed within limits"
    assert [(fault.thruster, fault.kind) for fault in flight.isolated_faults] == [(thruster, "stuck on")]
    assert flight.figures["false_alarms"] == 0.0 and flight.figures["time_to_detect_s"] < most_s
    names, branches = flight.scenario.thruster_names, flight.scenario.vehicle.rcs.branches
    shut = next(branch.thrusters for branch in branches if thruster in branch.thrusters)
    # while no branch is verified, after touchdown for example
    in_use = flight.telemetry["diagnosis.in_use"][flight.telemetry["diagnosis.leaking"] < 0.0]
    assert in_use[-1] == 2.0**22 - 1.0 - sum(2.0 ** names.index(k) for k in shut)


def test_no_thruster_is_isolated_in_the_nominal_flight(nominal):
    assert nominal.isolated_faults == [] and nominal.figures["false_alarms"] == 0.0
    # a branch is closed to verify it, and used again: two thrusters, for less than 1.5 s
    aloft = nominal.telemetry["t_s"] < nominal.figures["touchdown_s"]
    t, closed = nominal.telemetry["t_s"][aloft], nominal.telemetry["diagnosis.leaking"][aloft] >= 0.0
    begun, ended = (np.flatnonzero(np.diff(closed.astype(int)) == step) for step in (1, -1))
    assert np.all(nominal.telemetry["diagnosis.in_use"][aloft][~closed] == 2.0**22 - 1.0)
    assert 10 < len(begun) < 80 and np.max(t[ended] - t[begun[: len(ended)]]) < 1.5


def test_stuck_thruster_costs_propellant_when_nobody_diagnoses_it():
    """265 N m about the roll axis and 250 N sideways.  Torque and force are fed forward, so the others hold
    against it, on propellant; the movements of the latch valve that identify the thruster disturb roll about
    as much as the thruster does.
    """
    fault = "faults=[{thruster: D1, kind: stuck_on, at: {phase: hazard_avoidance, plus_s: 1}}]"
    known = edl6dof.fly("tianwen1_meters", [fault])
    unknown = edl6dof.fly("tianwen1_meters", [fault, "flight_software.diagnosis.enabled=false"])
    assert known.outcome == "landed within limits" and unknown.isolated_faults == []
    assert unknown.figures["propellant_used_kg"] > known.figures["propellant_used_kg"] + 4.0


def test_diagnosis_rests_on_the_ground():
    """Tested there, a thruster seems dead and a valve shut."""
    simulation = edl6dof.Simulation("tianwen1", telemetry=False)
    while simulation.phase != "landed":
        assert simulation.step()
    fsw, cycles = simulation.running.fsw[0], 0
    before = fsw["command"]["latch_closed"].tolist()
    simulation.step(cycles=10)  # pulses of the descent end
    while simulation.step():
        cycles += 1
        assert fsw["command"]["latch_closed"].tolist() == before
        assert not np.any(fsw["modulation"]["close_time"] > fsw["modulation"]["open_time"])
    assert cycles > 50
