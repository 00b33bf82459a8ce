"""Rounds of ``check`` until a file is right, if each round corrects every mistake that it reports."""

from __future__ import annotations

import json
from copy import deepcopy
from itertools import count

import pytest

from edl6dof.cli.inspection import check_files
from edl6dof.config.document.source import read_document, resolve_scenario
from edl6dof.config.document.yamltree import dotted
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import load_document

#: Mistakes laid over tianwen1 (over tianwen1_mc if there is a campaign), each with the key of its message.
PAIRS = {
    "no capsule, a wrong key in the vehicle": [
        ({"vehicle": {"parts": []}}, "vehicle.parts:"),
        ({"vehicle": {"rcs": {"tresh": 0.01}}}, "vehicle.rcs.tresh:"),
        ({"initial": {"speed_m_s": "fast"}}, "initial.speed_m_s:"),
    ],
    "step, lag and a unit": [
        ({"simulation": {"step_s": 0.013}}, "simulation.step_s:"),
        ({"limits": {"slope": 5}}, "limits.slope:"),
        ({"vehicle": {"engines": {"main": {"throttle_min_n": 8000.0}}}}, "engines.0.throttle_min_n:"),
    ],
    "components of events": [
        (
            {"mission": {"phases": {"lift": {"events": {"trim_wing": {"component": "x"}}}}}},
            "events.0.component:",
        ),
        ({"mission": {"phases": {"parachute": {"thrusters": ["axiall"]}}}}, "mission.phases.3.thrusters.0:"),
        ({"terrain": {"site_latitude_deg": 300}}, "terrain.site_latitude_deg:"),
        ({"flight_software": {"check_out": {"thrusters": ["Z9"]}}}, "check_out.thrusters.0:"),
    ],
    "files": [
        ({"atmosphere": {"table": "nowhere.csv"}}, "atmosphere.table:"),
        ({"planet": {"gravity": {"j2": "none"}}}, "planet.gravity.j2:"),
        ({"vehicle": {"appearance": {"meshes": [{"file": "no.glb"}]}}}, "appearance.meshes.0.file:"),
    ],
    "a tank, a part and a parachute": [
        ({"vehicle": {"engines": {"main": {"draws_from": ["tank9"]}}}}, "engines.0.draws_from.0:"),
        ({"vehicle": {"parachutes": {"main": {"pack": "bag"}}}}, "parachutes.0.pack:"),
        ({"vehicle": {"mass": {"entry_kgs": 1300}}}, "vehicle.mass.entry_kgs:"),
        ({"sensors": {"imu": {"delay_cycles": 9}}, "limits": {"rest": 1}}, "limits.rest:"),
    ],
    "truth": [
        ({"truth": {"vehicle.mass.entry_kgs": 1300}}, "vehicle.mass.entry_kgs:"),
        ({"mission": {"goal": "landng"}}, "mission.goal:"),
        ({"simulation": {"step_s": 0.013}}, "simulation.step_s:"),
    ],
    "campaign": [
        ({"campaign": {"cases": "many"}}, "campaign.cases:"),
        ({"campaign": {"truth": {"vehicle.mass.entry_kgs": {"kind": "normal", "sigma": 1}}}}, "entry_kgs:"),
        ({"campaign": {"truth": {"wind.scale": {"kind": "uniforme", "sigma": 1}}}}, "wind.scale.kind:"),
        ({"terrain": {"model": "plain"}}, "terrain.model:"),
    ],
    "no such vehicle": [
        ({"vehicle": "tianwen"}, "vehicle: no such file"),
        ({"planet": "marss"}, "planet: no such file"),
        ({"simulation": {"step_s": 0.013}}, "simulation.step_s:"),
        ({"seed": -1}, "seed:"),
    ],
    "thrusters": [
        ({"vehicle": {"rcs": {"thrusters": [{"name": "P1x", "thrust_n": 30}]}}}, "thrusters.22.name:"),
        ({"vehicle": {"rcs": {"branches": {"P12": {"thrusters": ["P1", "P2", "P9"]}}}}}, "thrusters.2: no"),
        ({"faults": [{"kind": "stuck_off", "thruster": "D99", "at": {"time_s": 1}}]}, "faults.0.thruster:"),
        ({"simulation": {"time_limit": 5}}, "simulation.time_limit:"),
    ],
    "phases": [
        ({"mission": {"phases": {"lift": {"hold_alpha": True, "control": "off"}}}}, "phases.1.hold_alpha:"),
        ({"mission": {"goal": "event", "goal_event": "touch"}}, "mission.goal_event:"),
        ({"flight_software": {"hazard": {"detection": "plane_fitt"}}}, "hazard.detection:"),
        ({"wind": {"gusts": 3}}, "wind.gusts:"),
    ],
}  # fmt: skip
#: Pairs that need a second round: which branch a fault may name is not known while the branches are wrong.
TWO_ROUNDS = {"thrusters"}


def laid(one: dict, other: dict) -> dict:
    """``other`` over ``one``."""
    merged = deepcopy(one)
    for key, value in other.items():
        both = isinstance(value, dict) and isinstance(merged.get(key), dict)
        merged[key] = laid(merged[key], value) if both else deepcopy(value)
    return merged


def rounds(mistakes, folder, capsys) -> int:
    campaign = any("campaign" in wrong for wrong, _ in mistakes)
    left = list(mistakes)
    for number in count():
        data = {"extends": "tianwen1_mc" if campaign else "tianwen1", "name": "bad"}
        for wrong, _ in left:
            data = laid(data, wrong)
        file = folder / "bad.yaml"
        file.write_text(json.dumps(data, indent=1), encoding="utf-8")
        good = check_files([str(file)], []) == 0
        lines = capsys.readouterr().err.splitlines()
        if not left:
            assert good, lines
            return number
        reported = [one for one in left if any(one[1] in line for line in lines)]
        assert reported, "\n".join([*lines, *(key for _, key in left)])
        left = [one for one in left if one not in reported]
    raise AssertionError


@pytest.mark.parametrize("name", PAIRS)
def test_all_mistakes_are_reported_in_one_round(name, tmp_path, capsys):
    assert rounds(PAIRS[name], tmp_path, capsys) == (2 if name in TWO_ROUNDS else 1)


def test_a_check_that_needs_a_refused_value_waits(tmp_path, capsys):
    """The step does not divide the cycle, but with a wrong rate the cycle is not known."""
    wrong = {"simulation": {"step_s": 0.013}, "flight_software": {"rates": {"base_hz": "fifty"}}}
    file = tmp_path / "bad.yaml"
    file.write_text(json.dumps({"extends": "tianwen1", "name": "bad", **wrong}), encoding="utf-8")
    assert check_files([str(file)], []) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "flight_software.rates.base_hz: must be" in line


def test_a_refused_value_has_no_message_elsewhere():
    """Every tenth number of tianwen1 in turn is text."""
    base = read_document(resolve_scenario("tianwen1"))
    del base.data["calibration"]
    numbers = [keys for keys in base.marks if isinstance(value_at(base.data, keys), float)]
    assert len(numbers) > 300
    for keys in numbers[::10]:
        document = base.copy()
        value_at(document.data, keys[:-1])[keys[-1]] = "text"
        with pytest.raises(ConfigError) as caught:
            load_document(document)
        assert {problem.path for problem in caught.value.problems} == {dotted(keys)}


def value_at(data, keys):
    for key in keys:
        data = data.get(key) if isinstance(data, dict) else data[key] if isinstance(data, list) else None
    return data
