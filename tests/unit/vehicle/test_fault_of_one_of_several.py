"""Of two engines, surfaces or parachutes, the one that a fault names fails, and no other."""

import json

import numpy as np
import pytest
from broken_vehicle import broken
from given_functions import actuate

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interface.capacities import MAX_ENGINES
from edl6dof.interface.effectors import DEPLOY
from edl6dof.vehicle.motion.balance import engines
from edl6dof.vehicle.plant import THRUST


def doubled(items, *names):
    """Override: the only one of a list of the vehicle as often as there are names."""
    one = getattr(edl6dof.load("tianwen1").scenario.vehicle, items)[0].model_dump(mode="json")
    return f"vehicle.{items}={json.dumps([{**one, 'name': name} for name in names])}"


def mission(change):
    """Override: the events of the phases with ``change(event)``, one or several, in the place of each."""
    phases = edl6dof.load("tianwen1").scenario.mission.phases
    table = [phase.model_dump(mode="json", exclude_none=True) for phase in phases]
    for phase in table:
        phase["events"] = [new for event in phase.get("events", []) for new in change(event)]
    return f"mission.phases={json.dumps(table)}"


def of_first_engine(event):
    return [{**event, "component": "left"} if event["action"] in ("ignite", "cut_off") else event]


TWO_ENGINES = (doubled("engines", "left", "right"), mission(of_first_engine))


@pytest.mark.parametrize(
    "kind, lost",
    [("engine_shortfall, engine_shortfall: {thrust_factor: 0.7}", 0.3), ("engine_dead", 1.0)],
    ids=["shortfall", "dead"],
)
def test_only_the_engine_that_is_named_loses_thrust(tables, kind, lost):
    fault = f"{{engine: right, at: {{time_s: 0}}, kind: {kind}}}"
    case, plant, command = broken(tables, fault, others=TWO_ENGINES)
    actuate(case, command, plant)
    assert plant["thrust_lost"] == pytest.approx([0.0, lost] + [0.0] * (MAX_ENGINES - 2))


def test_the_balance_counts_the_thrust_that_is_left(tables):
    """Sum of the engines' forces: all of the first, 0.7 of the second; both push along -x."""
    fault = "{kind: engine_shortfall, engine: right, engine_shortfall: {thrust_factor: 0.7}, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=TWO_ENGINES)
    actuate(case, command, plant)
    thrusts = np.zeros(MAX_ENGINES)
    thrusts[:2] = 2000.0, 3000.0
    force, _ = engines(case, plant, thrusts, 0)
    assert force == pytest.approx((-2000.0 - 0.7 * 3000.0, 0.0, 0.0), abs=1e-9)


def test_only_the_throttle_that_is_named_is_stuck(tables):
    fault = "{kind: throttle_stuck, engine: right, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=TWO_ENGINES)
    plant["running"][:2], plant["y"][THRUST : THRUST + 2] = 1, (3000.0, 3300.0)
    command["thrust"][:2] = 2000.0
    actuate(case, command, plant)
    assert plant["thrust_command"] == pytest.approx([2000.0, 3300.0] + [0.0] * (MAX_ENGINES - 2))


@pytest.mark.parametrize("kind", ["wing_lost", "wing_stuck"])
def test_only_the_surface_that_is_named_fails(tables, kind):
    two = doubled("surfaces", "trim_wing", "other")
    case, plant, command = broken(
        tables, f"{{kind: {kind}, surface: other, at: {{time_s: 0}}}}", others=[two]
    )
    actuate(case, command, plant)
    assert list(plant["wing_lost"][:2]) == [0.0, 1.0]


def test_only_the_parachute_that_is_named_is_late(tables):
    def two_mortars(event):
        first = {**event, "name": "first", "component": "drogue"}
        return [first, event] if event["action"] == "deploy" else [event]

    others = [doubled("parachutes", "drogue", "main"), mission(two_mortars)]
    fault = "{kind: parachute_delay, parachute: main, parachute_delay: {delay_s: 2.5}, at: {time_s: 0}}"
    case, plant, command = broken(tables, fault, others=others)
    command["request"][[0, 1, 2]] = 1
    actuate(case, command, plant)
    deployed = case["events"]["events"]["action"][:3] == DEPLOY
    assert plant["due"][:3][deployed] == pytest.approx([0.015, 0.015 + 2.5])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("kind: engine_shortfall", "faults.0: engine_shortfall must name its engine; names: left, right"),
        ("kind: throttle_stuck, engine: main", "faults.0.engine: no engine named 'main'; names: left, right"),
    ],
)
def test_one_of_several_must_be_named(fault, words):
    with pytest.raises(ConfigError) as refusal:
        edl6dof.load("tianwen1", [*TWO_ENGINES, f"faults=[{{{fault}, at: {{time_s: 1}}}}]"])
    assert words in str(refusal.value)


def test_a_surface_must_be_there_to_fail():
    with pytest.raises(ConfigError) as refusal:
        edl6dof.load(
            "tianwen1",
            ["vehicle.surfaces=[]", mission(without_wing), "faults=[{kind: wing_lost, at: {time_s: 1}}]"],
        )
    assert "faults.0: wing_lost must name its surface; names: none" in str(refusal.value)


def without_wing(event):
    return [] if event["component"] == "trim_wing" else [event]
