"""Verifies: a backshell that is released late.  No law that plans comes down faster than the gravity turn,
and what a law gives up is an event, a figure and, before a crash, a cause.
"""

from functools import cache

import pytest

import edl6dof
from edl6dof.fsw.guidance import guidance_command
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS

PLANNING = [name for name in POWERED_LAWS.names if name != "gravity_turn"]


@cache
def released(law, height, late_s=0.0):
    """A flight whose backshell leaves at a height (m) and whose engine lights late."""
    settings = [f"mission.phases.parachute.until.value={height}", "simulation.log_every=50"]
    if late_s:
        delay = f"ignition_delay: {{delay_s: {late_s}}}"
        settings.append(f"faults=[{{kind: ignition_delay, {delay}, at: {{phase: powered_deceleration}}}}]")
    return edl6dof.fly("tianwen1", [f"flight_software.guidance.powered.law={law}", *settings])


@pytest.mark.parametrize("height", [300.0, 400.0, 450.0, 550.0, 600.0])
@pytest.mark.parametrize("law", PLANNING)
def test_no_law_that_plans_comes_down_faster_than_the_gravity_turn(law, height):
    """300 m are too low for any; 450 m were lost by convex alone (30 m/s), 600 m by constant_thrust."""
    speed, reference = (
        released(name, height).figures["touchdown_vertical_m_s"] for name in (law, "gravity_turn")
    )
    assert speed < reference + 0.5
    assert height < 350.0 or speed < 3.0


@pytest.mark.parametrize("height", [375.0, 475.0, 600.0])
def test_a_gravity_turn_is_over_at_rest_and_leaves_the_descent_to_the_hover(height):
    """It was never over: it hung at 97 m until its time was out, or rose from 100 m to 333 m (475 m)."""
    flight = released("gravity_turn", height)
    assert flight.figures["touchdown_vertical_m_s"] < 3.0
    begun, over = (
        next(event["t_s"] for event in flight.events if event["name"] == f"phase {name}")
        for name in ("powered_deceleration", "hover_imaging")
    )
    assert over - begun < 30.0


@pytest.mark.parametrize(("height", "late_s"), [(700.0, 0.0), (1200.0, 0.0), (700.0, 2.0), (900.0, 4.0)])
@pytest.mark.parametrize("law", PLANNING)
def test_all_laws_land_from_higher_and_after_late_ignition(law, height, late_s):
    assert released(law, height, late_s).figures["touchdown_vertical_m_s"] < 3.0


@pytest.mark.parametrize(("height", "late_s"), [(450.0, 2.0), (650.0, 4.0)])
@pytest.mark.parametrize("law", PLANNING)
def test_a_late_ignition_that_no_law_survives_is_no_worse_with_a_plan(law, height, late_s):
    speed, reference = (
        released(name, height, late_s).figures["touchdown_vertical_m_s"] for name in (law, "gravity_turn")
    )
    assert 20.0 < speed < reference + 0.5


def test_what_convex_gives_up_is_an_event_a_figure_and_a_cause():
    flight = released("convex", 300.0)
    events = [event for event in flight.events if event["key"] == "relaxed"]
    assert [event["name"] for event in events] == ["powered guidance: braking at full thrust"]
    assert flight.figures["constraints_relaxed"] == guidance_command.EVERYTHING
    assert 20.0 < flight.figures["landing_error_m"] < 300.0
    assert ": braking at full thrust from " in flight.outcome
    kept = released("convex", 1200.0)
    assert "constraints_relaxed" not in kept.figures and all(e["key"] != "relaxed" for e in kept.events)
