"""The mission sequencer: order, time windows, events once, conditions on every watched quantity."""

import numpy as np
import pytest

from edl6dof.config.dtype import fill
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.mission.phases import GUIDANCE, MISSION, Event, MissionParams, Phase, Trigger
from edl6dof.fsw.mission.sequencer import SEQUENCE, sequence
from edl6dof.fsw.navigation import NAV
from edl6dof.interface.events import EVENTS
from edl6dof.scenario.schema import load_scenario

DT = 0.02


def trigger(quantity, goes, value, **window):
    return Trigger(quantity=quantity, goes=goes, value=float(value), **window)


def plan(*phases):
    record = np.zeros(1, MISSION)
    fill(record[0], MissionParams(phases=list(phases)))
    return record[0]


class Sequencer:
    """Runs the sequencer over a history of navigated quantities; keeps (time, event) and (time, phase)."""

    def __init__(self, mission, start=0.0):
        self.mission, self.k, self.start = mission, 0, start
        self.nav, self.guide, self.fsw = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0], np.zeros(1, SEQUENCE)[0]
        self.fsw["phase_start"] = start
        self.events, self.entered = [], [(start, 0)]

    def run(self, duration, **quantities):
        for _ in range(round(duration / DT)):
            t = self.start + self.k * DT
            self.nav["t"] = t
            for name, value in quantities.items():
                self.set(name, value(t) if callable(value) else value)
            request, before = np.zeros(7, np.int64), int(self.fsw["phase"])
            sequence(self.mission, self.nav, self.guide, self.fsw, request)
            self.events += [(t, EVENTS[i]) for i in np.flatnonzero(request)]
            if self.fsw["phase"] != before:
                self.entered.append((t, int(self.fsw["phase"])))
            self.k += 1
        return self

    def set(self, name, value):
        if name == "time_to_go":
            self.guide[name] = value
        elif name == "descent_rate":
            self.nav["v_N"][2] = value
        else:
            self.nav[name] = value


def last(name="last"):
    return Phase(name=name)


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
        Event(do="mortar", when=trigger("phase_time_s", "above", -1.0)),
        Event(do="heat_shield", when=trigger("mach", "below", 0.8, earliest_s=1.0, latest_s=6.0)),
        Event(do="landing_legs", when=trigger("phase_time_s", "above", 3.0)),
    ]
    s = Sequencer(plan(Phase(name="a", events=events, until=trigger("phase_time_s", "above", 10.0)), last()))
    s.run(30.0, mach=lambda t: 0.7 + 0.2 * np.sin(20.0 * t))
    assert sorted(name for _, name in s.events) == ["heat_shield", "landing_legs", "mortar"]
    when = dict((name, t) for t, name in s.events)
    assert when["mortar"] == 0.0
    assert 1.0 <= when["heat_shield"] < 2.0
    assert when["landing_legs"] == pytest.approx(3.0, abs=2 * DT)


def test_same_event_slot_works_in_the_next_phase():
    first = [Event(do="mortar", when=trigger("phase_time_s", "above", 0.5))]
    second = [Event(do="backshell", when=trigger("phase_time_s", "above", 0.5))]
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
    events = [Event(do="trim_wing", when=trigger("mach", "below", 2.8))]
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


def test_empty_mission_does_nothing():
    s = Sequencer(plan()).run(1.0)
    assert s.fsw["phase"] == 0
    assert s.events == []


def test_tianwen_sequence_flown_on_a_plausible_profile_passes_all_phases_and_deploys_each_thing_once():
    mission = load_scenario("tianwen1").scenario.mission
    record = np.zeros(1, MISSION)
    fill(record[0], mission)
    s = Sequencer(record[0])
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
    assert [phase for _, phase in s.entered] == list(range(len(mission.phases)))
    names = [name for _, name in s.events]
    assert sorted(names) == sorted(EVENTS)
    order = ["trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off"]
    assert names == order


def test_names_in_the_table_are_those_the_record_counts():
    for index, name in enumerate(GUIDANCE):
        record = plan(Phase(name="x", guidance=name))
        assert record["phases"][0]["guidance"] == index
    for index, name in enumerate(EVENTS):
        record = plan(Phase(name="x", events=[Event(do=name, when=trigger("mach", "below", 1.0))]))
        assert record["phases"][0]["events"][0]["do"] == index
