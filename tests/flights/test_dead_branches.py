"""Verifies: a flow meter that fails costs no thruster, and a dead branch is not taken for one. All flights
carry flow meters.
"""

import pytest

import edl6dof

THRUSTERS = {"A13": {"A1", "A3"}, "P34": {"P3", "P4"}, "F56": {"F5", "F6"}, "F34": {"F3", "F4"}}


def fly(component, kind, branch, phase, seed=1):
    """A flight in which a branch or its meter fails one second into a phase."""
    fault = f"{{kind: {kind}, {component}: {branch}, at: {{phase: {phase}, plus_s: 1}}}}"
    return edl6dof.fly("tianwen1_meters", [f"faults=[{fault}]", "simulation.log_every=50", f"seed={seed}"])


def meters(flight):
    """Flow meters that are not believed any more."""
    return {one.instrument for one in flight.exclusions if one.component == "flow_meter"}


@pytest.mark.parametrize(("branch", "phase"), [("A13", "parachute"), ("P34", "parachute"), ("F34", "lift")])
def test_all_thrusters_of_a_dead_branch_are_named_and_its_meter_is_not(branch, phase):
    flight = fly("branch", "branch_dead", branch, phase)
    assert flight.success and meters(flight) == set()
    assert {one.thruster for one in flight.isolated_faults} == THRUSTERS[branch]


def test_the_thruster_of_a_dead_branch_that_is_used_is_named_and_its_meter_is_not():
    """Under power the branch A13 is hardly used once A3 is out."""
    flight = fly("branch", "branch_dead", "A13", "powered_deceleration")
    assert flight.success and meters(flight) == set()
    assert {"A3"} <= {one.thruster for one in flight.isolated_faults} <= THRUSTERS["A13"]


@pytest.mark.parametrize(
    ("kind", "branch", "phase", "seed"),
    [
        ("reading_stuck", "F56", "trim_aoa", 1),  # stands at half the flow of a thruster
        ("reading_stuck", "F34", "slow_descent", 1),
        ("reading_outage", "A13", "powered_deceleration", 1),
        ("reading_outage", "P34", "parachute", 1),
        ("reading_outage", "F34", "lift", 3),  # while a thruster of its branch fires
        ("reading_outage", "F34", "powered_deceleration", 7),  # likewise
    ],
)
def test_a_failed_meter_is_named_and_costs_no_thruster(kind, branch, phase, seed):
    flight = fly("flow_meter", kind, branch, phase, seed)
    assert flight.success and meters(flight) == {branch} and flight.isolated_faults == []


def test_half_a_thruster_lost_within_a_pulse_is_no_failed_meter():
    """The first reading shows a quarter lost, and the next are taken with another thruster of the branch."""
    fault = "{kind: degraded, thruster: D2, at: {time_s: 180}}"
    flight = edl6dof.fly("tianwen1_meters", [f"faults=[{fault}]", "simulation.time_limit_s=185"])
    assert meters(flight) == set()
    assert [one.thruster for one in flight.isolated_faults] == ["D2"]


@pytest.mark.parametrize(
    ("meter", "thruster", "at"),
    [
        ("A24", "A2", 63.2),
        ("A24", "A4", 63.2),
        ("P12", "P1", 63.2),
        ("P12", "P2", 70.0),
        ("F12", "F1", 100.0),
    ],
)
def test_a_leak_behind_a_meter_that_has_failed_unnoticed_is_isolated(meter, thruster, at):
    """Before, A2 and A4 were not noticed, and P1 was taken for dead: the vehicle lost its attitude."""
    outage = f"{{kind: reading_outage, flow_meter: {meter}, at: {{time_s: 20}}}}"
    leak = f"{{kind: stuck_on, thruster: {thruster}, at: {{time_s: {at}}}}}"
    flight = edl6dof.fly("tianwen1_meters", [f"faults=[{outage}, {leak}]", "simulation.time_limit_s=185"])
    assert [(one.thruster, one.kind) for one in flight.isolated_faults] == [(thruster, "stuck on")]
    assert flight.isolated_faults[0].t_s < at + 3.0
