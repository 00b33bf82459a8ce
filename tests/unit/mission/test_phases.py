"""The mission sequencer: order, time windows, events once, conditions on every watched quantity."""

from math import radians

import numpy as np
import pytest
from sequencing import DT, VEHICLE, Sequencer, last, plan, trigger

from edl6dof.fsw.mission import GUIDANCE, Event, MissionParams, Phase
from edl6dof.interface.effectors import ACTIONS
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.mission_events import event_problems


def test_phases_follow_in_order_and_the_last_goes_on_for_ever():
    mission = plan(
        Phase(name="a", until=trigger("mach", "below", 2.0)),
        Phase(name="b", until=trigger("height_m", "below", 100.0)),
        Phase(name="c", until=trigger("footpad_contact", "above", 0.5)),
        last(),
    )
    s = Sequencer(mission)
    s.run(1.0, mach=3.0, height=50.0, footpad_contact=1)  # later conditions already true do not matter yet
    assert s.fsw["phase"] == 0
    s.run(5.0, mach=1.5, height=50.0, footpad_contact=1)
    assert [phase for _, phase in s.entered] == [0, 1, 2, 3]
    times = [t for t, _ in s.entered]
    assert times[2] == pytest.approx(times[1] + DT)  # at most one change a cycle
    s.run(50.0)
    assert s.fsw["phase"] == 3
    assert s.fsw["entered"][1:4] == pytest.approx(times[1:])


@pytest.mark.parametrize("start", [0.0, 317.34])
def test_trigger_cannot_fire_before_its_earliest_time_in_the_phase(start):
    s = Sequencer(plan(Phase(name="a", until=trigger("mach", "below", 2.0, earliest_s=3.0)), last()), start)
    s.run(10.0, mach=1.0)
    assert s.entered[1][0] == pytest.approx(start + 3.0, abs=1e-6)


def test_trigger_fires_at_its_latest_time_whatever_the_quantity():
    s = Sequencer(plan(Phase(name="a", until=trigger("mach", "below", 2.0, latest_s=4.0)), last()))
    s.run(10.0, mach=25.0)
    assert s.entered[1][0] == pytest.approx(4.0, abs=DT + 1e-9)


def test_hover_waits_for_the_choice_of_a_spot_but_not_for_ever():
    hover = Phase(name="a", guidance="hover", until=trigger("spot_chosen", "above", 0.5, latest_s=20.0))
    s = Sequencer(plan(hover, last()))
    s.run(5.0, spot_chosen=0)
    s.run(1.0, spot_chosen=1)
    assert s.entered[1][0] == pytest.approx(5.0, abs=1e-6)
    assert Sequencer(plan(hover, last())).run(30.0, spot_chosen=0).entered[1][0] == pytest.approx(
        20.0, abs=DT
    )


def test_window_counts_from_the_start_of_the_phase_and_not_of_the_flight():
    s = Sequencer(
        plan(
            Phase(name="a", until=trigger("phase_time_s", "above", 2.0)),
            Phase(name="b", until=trigger("mach", "below", 2.0, earliest_s=3.0, latest_s=5.0)),
            last(),
        )
    )
    s.run(20.0, mach=9.0)
    assert s.entered[1][0] == pytest.approx(2.0, abs=2 * DT)
    assert s.entered[2][0] == pytest.approx(s.entered[1][0] + 5.0, abs=DT + 1e-9)


def test_quantity_crossing_inside_the_window_fires_at_the_crossing():
    s = Sequencer(
        plan(Phase(name="a", until=trigger("mach", "below", 2.0, earliest_s=1.0, latest_s=50.0)), last())
    )
    s.run(20.0, mach=lambda t: 4.0 - 0.2 * t)
    assert s.entered[1][0] == pytest.approx(10.0, abs=1.01 * DT)


def test_each_event_is_requested_once_and_again_in_no_later_phase():
    events = [
        Event(name="mortar", action="deploy", component="main", when=trigger("phase_time_s", "above", -1.0)),
        Event(
            name="heat_shield",
            action="jettison",
            component="heat_shield",
            when=trigger("mach", "below", 0.8, earliest_s=1.0, latest_s=6.0),
        ),
        Event(
            name="landing_legs",
            action="extend",
            component="landing_gear",
            when=trigger("phase_time_s", "above", 3.0),
        ),
    ]
    s = Sequencer(plan(Phase(name="a", events=events, until=trigger("phase_time_s", "above", 10.0)), last()))
    s.run(30.0, mach=lambda t: 0.7 + 0.2 * np.sin(20.0 * t))
    assert sorted(name for _, name in s.events) == ["heat_shield", "landing_legs", "mortar"]
    when = dict((name, t) for t, name in s.events)
    assert when["mortar"] == 0.0
    assert 1.0 <= when["heat_shield"] < 2.0
    assert when["landing_legs"] == pytest.approx(3.0, abs=2 * DT)


def test_same_event_slot_works_in_the_next_phase():
    first = [
        Event(name="mortar", action="deploy", component="main", when=trigger("phase_time_s", "above", 0.5))
    ]
    second = [
        Event(
            name="backshell",
            action="jettison",
            component="backshell",
            when=trigger("phase_time_s", "above", 0.5),
        )
    ]
    s = Sequencer(
        plan(
            Phase(name="a", events=first, until=trigger("phase_time_s", "above", 2.0)),
            Phase(name="b", events=second, until=trigger("phase_time_s", "above", 2.0)),
            last(),
        )
    )
    s.run(10.0)
    assert [name for _, name in s.events] == ["mortar", "backshell"]


def test_event_outside_its_phase_is_not_requested():
    events = [
        Event(name="trim_wing", action="extend", component="trim_wing", when=trigger("mach", "below", 2.8))
    ]
    s = Sequencer(
        plan(Phase(name="a", until=trigger("phase_time_s", "above", 5.0)), Phase(name="b", events=events))
    )
    s.run(5.0, mach=1.0)
    assert s.events == []
    s.run(1.0, mach=1.0)
    assert [name for _, name in s.events] == ["trim_wing"]
    assert s.events[0][0] > 5.0


@pytest.mark.parametrize(
    "quantity, field, below, above",
    [
        ("time_s", "t", None, None),
        ("mach", "mach", 1.0, 3.0),
        ("speed_m_s", "speed", 1.0, 3.0),
        ("height_m", "height", 1.0, 3.0),
        ("altitude_m", "altitude", 1.0, 3.0),
        ("drag_m_s2", "drag", 1.0, 3.0),
        ("dynamic_pressure_pa", "dynamic_pressure", 1.0, 3.0),
        ("descent_rate_m_s", "descent_rate", 1.0, 3.0),
        ("time_to_go_s", "time_to_go", 1.0, 3.0),
        ("total_alpha_deg", "total_alpha", radians(1.9), radians(2.1)),
        ("downrange_to_go_m", "downrange_to_go", -1.0, 3.0),
        ("footpad_contact", "footpad_contact", 0, 3),
    ],
)
def test_each_quantity_is_watched_on_both_sides_of_its_threshold(quantity, field, below, above):
    if quantity == "time_s":
        s = Sequencer(plan(Phase(name="a", until=trigger("time_s", "above", 102.0)), last()), 100.0).run(5.0)
        assert s.entered[1][0] == pytest.approx(102.0, abs=2 * DT)
        return
    threshold = 0.5 if quantity == "footpad_contact" else 2.0
    for goes, quiet, fires in (("below", above, below), ("above", below, above)):
        s = Sequencer(plan(Phase(name="a", until=trigger(quantity, goes, threshold)), last()))
        s.run(0.5, **{field: quiet})
        assert s.fsw["phase"] == 0
        s.run(0.1, **{field: fires})
        assert s.fsw["phase"] == 1


def test_time_of_the_trim_wing_counts_from_its_command():
    s = Sequencer(plan(Phase(name="a", until=trigger("wing_time_s", "above", 2.0)), last())).run(5.0)
    s.vehicle["wing_commanded"], s.vehicle["wing_time"] = 1, 4.0
    assert s.run(5.0).entered[1][0] == pytest.approx(6.0, abs=1.01 * DT)


def test_force_angle_is_watched_in_degrees():
    s = Sequencer(plan(Phase(name="a", until=trigger("force_angle_deg", "above", 0.4)), last()))
    s.vehicle["force_angle"] = radians(0.39)
    assert s.run(1.0).fsw["phase"] == 0
    s.vehicle["force_angle"] = radians(0.41)
    assert s.run(0.1).fsw["phase"] == 1


def test_empty_mission_does_nothing():
    s = Sequencer(plan()).run(1.0)
    assert s.fsw["phase"] == 0
    assert s.events == []


def test_tianwen_sequence_flown_on_a_plausible_profile_passes_all_phases_and_deploys_each_thing_once():
    mission = load_scenario("tianwen1").scenario.mission
    s = Sequencer(plan(*mission.phases))
    s.run(
        280.0, drag=lambda t: 0.03 * t, mach=lambda t: max(25.0 - 0.09 * t, 0.4), height=2e4, time_to_go=9.0
    )
    s.run(
        120.0,
        drag=5.0,
        mach=lambda t: max(1.7 - 0.02 * (t - 280.0), 0.4),
        height=lambda t: 12e3 - 90.0 * (t - 280.0),
    )
    s.run(60.0, mach=0.2, height=500.0, time_to_go=lambda t: 440.0 - t)
    s.run(40.0, height=60.0)
    s.run(10.0, height=15.0)
    s.run(5.0, footpad_contact=1)
    names = [phase.name for phase in mission.phases]
    straight_on = [name for name in names if name not in ("alpha_held", "coast", "last_burn")]
    assert [names[phase] for _, phase in s.entered] == straight_on
    names = [name for _, name in s.events]
    order = ["trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off"]
    assert names == order
    assert set(mission.events) - set(names) == {"cut_off_high", "relight"}  # of a throttle that stands


def test_names_in_the_table_are_those_the_record_counts():
    for index, name in enumerate(GUIDANCE):
        record, _ = plan(Phase(name="x", guidance=name))
        assert record["phases"][0]["guidance"] == index
    record, mission = plan(*load_scenario("tianwen1").scenario.mission.phases)
    assert record["n_events"] == len(mission.events) == 9
    for row, event in zip(record["events"], mission.events.values(), strict=False):
        assert ACTIONS[row["action"]] == event.action and row["delay"] == event.delay_s
    assert [int(row["component"]) for row in record["events"][:9]] == [0, 0, 0, -1, 1, 0, 0, 0, 0]


def test_the_same_event_in_two_phases_is_one_and_a_name_with_two_meanings_is_refused():
    now = trigger("phase_time_s", "above", -1.0)
    shield = Event(name="off", action="jettison", component="heat_shield", when=now)
    later = Event(name="off", action="jettison", component="heat_shield", when=trigger("mach", "below", 1.0))
    record, _ = plan(Phase(name="a", events=[shield], until=now), Phase(name="b", events=[later]))
    assert record["n_events"] == 1 and record["number"][1, 0] == 0
    other = Event(name="off", action="jettison", component="backshell", when=now)
    mission = MissionParams(phases=[Phase(name="a", events=[shield, other])])
    assert "does something else" in dict(event_problems(mission, VEHICLE))["mission.phases.0.events.1.name"]


def test_an_event_with_a_thing_that_is_not_there_is_refused():
    event = Event(name="x", action="jettison", component="ballast", when=trigger("mach", "below", 1.0))
    words = dict(event_problems(MissionParams(phases=[Phase(name="a", events=[event])]), VEHICLE))
    assert words == {
        "mission.phases.0.events.0.component": "nothing to jettison named 'ballast'; names: heat_shield, "
        "backshell, parachute_pack"
    }


def test_an_event_of_two_phases_happens_once():
    now = trigger("phase_time_s", "above", -1.0)
    shield = Event(name="off", action="jettison", component="heat_shield", when=now)
    again = Phase(name="b", events=[shield])
    s = Sequencer(plan(Phase(name="a", events=[shield], until=trigger("phase_time_s", "above", 1.0)), again))
    assert [name for _, name in s.run(3.0).events] == ["off"] and s.fsw["phase"] == 1
