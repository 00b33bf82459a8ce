"""Verifies: convex guidance in the flight of Tianwen-1: it plans, lands, and diverts."""

import numpy as np
import pytest

import edl6dof

LAW = "flight_software.guidance.powered.law=convex"
DIVERT = "flight_software.guidance.powered.target.divert_m=600"


def hover_start(flight):
    """Time at which powered deceleration is over."""
    return next(event["t_s"] for event in flight.events if event["key"] == "phase.hover_imaging")


@pytest.fixture(
    scope="module",
    params=[(), pytest.param((DIVERT,), marks=pytest.mark.long), (DIVERT, "sensors.set=perfect")],
    ids=len,
)
def flight(request):
    return edl6dof.fly("tianwen1", [LAW, *request.param])


def test_it_ends_where_it_was_told_to(flight):
    """By what the flight computer knows of its place, as the target is given in that; with perfect sensors
    that is the true one.
    """
    assert flight.outcome == "landed within limits"
    guidance = flight.fsw[0]["guidance"]
    target, memory = guidance["target"], guidance["powered"]["convex"]
    names = (
        "truth.site_east_m",
        "truth.site_north_m",
        "truth.height_m",
        "nav.error_east_m",
        "nav.error_north_m",
    )
    east, north, up, *error = flight.telemetry.at(hover_start(flight), *names)
    known = np.array([east + error[0], north + error[1]])
    assert np.linalg.norm(known - target["point_L"]) < 2.0
    assert up == pytest.approx(float(target["height"]), abs=2.0)
    assert memory["plans"] > 20
    assert memory["landing_error"] < 1.0


@pytest.mark.parametrize(
    "left", [*(pytest.param(left, marks=pytest.mark.long) for left in (0.85, 0.75)), 0.7]
)
def test_it_lands_on_an_engine_that_gives_less_than_it_is_told(left):
    """The flight computer is not told: it sees the specific force, and plans anew with what is left."""
    weak = f"{{kind: engine_shortfall, engine_shortfall: {{thrust_factor: {left}}}"
    weak = f"faults=[{weak}, at: {{phase: powered_deceleration}}}}]"
    flight = edl6dof.fly("tianwen1", [LAW, weak])
    assert flight.outcome == "landed within limits"
