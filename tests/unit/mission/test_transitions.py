"""Transitions of a phase: conditions joined, which way is taken, and which cannot be."""

import pytest
from sequencing import Sequencer, last, plan, trigger

from edl6dof.fsw.mission import Condition, MissionParams, Phase, Transition
from edl6dof.scenario.mission_events import way_problems


def way(*conditions, **more):
    return Transition(when=[Condition(**condition) for condition in conditions], **more)


LOW = {"quantity": "height_m", "crosses": "below", "value": 100.0}
SLOW = {"quantity": "speed_m_s", "crosses": "below", "value": 50.0}


@pytest.mark.parametrize(
    "join, height, speed, leaves",
    [
        ("all", 50.0, 90.0, False),
        ("all", 50.0, 20.0, True),
        ("any", 50.0, 90.0, True),
        ("any", 500.0, 90.0, False),
    ],
)
def test_conditions_of_a_way_out_are_joined(join, height, speed, leaves):
    table = plan(Phase(name="a", transitions=[way(LOW, SLOW, join=join, next="c")]), last("b"), last("c"))
    s = Sequencer(table).run(0.5, height=height, speed=speed)
    assert [phase for _, phase in s.entered] == ([0, 2] if leaves else [0])


def test_the_first_way_that_is_open_is_taken_and_until_comes_last():
    ways = [way(LOW, earliest_s=2.0, next="low"), way(SLOW, next="slow", latest_s=8.0)]
    phases = (
        Phase(name="a", transitions=ways, until=trigger("mach", "below", 1.0)),
        *(last(name) for name in ("b", "low", "slow")),
    )
    fast_and_low = {"height": 50.0, "speed": 20.0, "mach": 0.5}
    assert Sequencer(plan(*phases)).run(1.0, **fast_and_low).entered[1][1] == 3
    high = {"height": 500.0, "speed": 90.0, "mach": 2.0}
    s = Sequencer(plan(*phases)).run(3.0, **high).run(0.1, **{**high, "height": 50.0})
    assert s.entered[1][1] == 2
    assert Sequencer(plan(*phases)).run(1.0, **{**high, "mach": 0.5}).entered[1][1] == 1
    late = Sequencer(plan(*phases)).run(9.0, **high)
    assert late.entered[1] == (pytest.approx(8.0), 3)


def test_a_way_to_a_phase_that_is_not_there_is_refused():
    phases = [Phase(name="a", transitions=[way(LOW, next="nowhere")]), last()]
    assert dict(way_problems(MissionParams(phases=phases))) == {
        "mission.phases.0.transitions.0.next": "no phase named 'nowhere'; names: a, last"
    }
    lost = dict(way_problems(MissionParams(phases=[Phase(name="a", transitions=[way(LOW)])])))
    assert "name the phase that follows" in lost["mission.phases.0.transitions.0"]
