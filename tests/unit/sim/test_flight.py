"""The Flight object against its own log and against pyquaternion."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from pyquaternion import Quaternion

import edl6dof
from edl6dof.sim.flight_state import RunningFlight
from edl6dof.telemetry.channels import CHANNELS
from edl6dof.telemetry.columns import describe


def test_telemetry_has_every_channel_and_thruster(nominal):
    per_thruster = {
        f"{kind}.{name}" for kind in ("rcs", "fault", "valve") for name in nominal.scenario.thruster_names
    }
    per_beam = {f"range.{name}_m" for name in nominal.scenario.beam_names}
    kinds = ("used.{}_kg", "metered.{}_kg", "expected.{}_kg_s")
    per_branch = {kind.format(name) for kind in kinds for name in nominal.scenario.branches}
    names = {channel.name for channel in CHANNELS} | {"t_s"} | per_thruster | per_beam | per_branch
    assert set(nominal.telemetry) == names
    assert all(len(column) == len(nominal.log) for column in nominal.telemetry.values())


def test_branches_use_what_the_tank_loses_until_the_engine_burns_and_meters_count_it():
    flight = edl6dof.fly("tianwen1_meters")
    table = flight.telemetry
    until = int(np.searchsorted(table["t_s"], flight.figures["backshell_s"])) - 1
    lost = table["truth.propellant_kg"][0] - table["truth.propellant_kg"][until]
    used = {name: table[f"used.{name}_kg"][until] for name in flight.scenario.branches}
    assert sum(used.values()) == pytest.approx(lost, abs=1e-9) and lost > 5.0
    full = dict(zip(used, flight.case[0]["branches"]["full_flow"], strict=False))
    for name, kg in used.items():
        # five standard deviations of scale and of bias over the flight
        allowed = 5.0 * np.hypot(0.01 * kg, 0.002 * full[name] * table["t_s"][until])
        assert table[f"metered.{name}_kg"][until] == pytest.approx(kg, abs=allowed)
        called_for = np.sum(table[f"expected.{name}_kg_s"][:until]) * (table["t_s"][1] - table["t_s"][0])
        assert called_for == pytest.approx(kg, rel=0.03, abs=1e-4)
        assert describe(f"metered.{name}_kg")[0] == "kg" and name in describe(f"used.{name}_kg")[1]
        assert describe(f"expected.{name}_kg_s")[0] == "kg/s"


def test_results_outlive_the_released_log():
    flight = edl6dof.fly("tianwen1", ["simulation.time_limit_s=2"])
    outcome = flight.outcome
    flight.release_log()
    assert len(flight.log) == 0
    assert len(flight.telemetry["t_s"]) == 0
    assert flight.outcome == outcome
    assert flight.events[-1]["name"] == outcome


def test_telemetry_is_at_least_fifty_hertz(nominal):
    assert np.max(np.diff(nominal.telemetry["t_s"])) <= 0.02 + 1e-9


def test_attitude_turns_body_axis_to_the_inertial_nose_direction(nominal):
    """At mid entry the nose lies within the angle of attack of the velocity."""
    t = 150.0
    nose = nominal.attitude(t).rotate([1.0, 0.0, 0.0])
    i = int(np.searchsorted(nominal.log["t"], t))
    r = np.array([nominal.log["truth"][f"r_I_{c}"][i] for c in "xyz"])
    v = np.array([nominal.log["truth"][f"v_I_{c}"][i] for c in "xyz"])
    spin = nominal.scenario.planet.rotation_rate_rad_s
    relative = v - spin * np.array([-r[1], r[0], 0.0])
    angle = np.degrees(np.arccos(nose @ relative / np.linalg.norm(relative)))
    assert angle == pytest.approx(abs(nominal.telemetry["nav.alpha_deg"][i]), abs=1.0)


def test_attitude_between_rows_is_on_the_way(nominal):
    before, middle, after = (nominal.attitude(t) for t in (100.0, 100.01, 100.02))
    assert isinstance(middle, Quaternion)
    whole = Quaternion.absolute_distance(before, after)
    assert Quaternion.absolute_distance(before, middle) == pytest.approx(whole / 2, abs=1e-6)


def test_attitude_outside_the_flight_is_refused(nominal):
    with pytest.raises(ValueError, match="must lie in"):
        nominal.attitude(1e4)


def test_data_frame_has_time_as_index(nominal):
    pytest.importorskip("pandas")
    frame = nominal.to_pandas()
    assert frame.index.name == "t_s"
    assert frame["truth.mach"].iloc[0] == nominal.telemetry["truth.mach"][0]


def test_events_are_in_order_of_time_and_end_with_the_outcome(nominal):
    times = [event["t_s"] for event in nominal.events]
    assert times == sorted(times)
    assert nominal.events[-1]["name"] == nominal.outcome


def test_a_step_of_one_cycle_costs_few_calls_in_python():
    """Learning environments fly cycle by cycle. Numba looked up the addresses of all passed functions in each
    step, in 4,000 calls and sixty times the duration of the cycle itself.
    """
    flight = RunningFlight(edl6dof.load("tianwen1"))
    flight.advance(1)
    calls = []
    sys.setprofile(lambda _frame, event, _: calls.append(event) if event == "call" else None)
    try:
        flight.advance(1)
    finally:
        sys.setprofile(None)
    assert flight.cycle == 2
    assert len(calls) < 300
