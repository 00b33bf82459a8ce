"""Unusual values: named by check, terminal, summary and report, and none in what ships."""

import json
from pathlib import Path

import pytest

import edl6dof
from edl6dof.config.model_paths import is_model, numbers, type_slot, usual_range
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario
from tests.in_process import called

SCENARIOS = sorted((Path(__file__).parents[3] / "scenarios").glob("*.yaml"))

IMPLAUSIBLE = {
    "vehicle.engines.main.full_specific_impulse_s": "1e6",
    "vehicle.rcs.thrusters.D1.position_m": "[60, 0, 0]",
    "vehicle.landing_gear.friction": "1e-9",
    "vehicle.parachutes.main.apparent_mass_factor": "135",
    "vehicle.mass.entry_inertia_kg_m2": "[9000, 9000, 9000]",
    "vehicle.mass.entry_kg": "15000",
    "wind.constant.east_m_s": "180",
}


def models(model):
    """A parameter model and all inside it."""
    found, left = set(), [model]
    while left:
        if (one := left.pop()) in found:
            continue
        found.add(one)
        left += [inner for info in one.model_fields.values() for inner in inside(info.annotation)]
    return found


def inside(annotation):
    options = type_slot("", annotation).options
    nested = [arg for option in options for arg in getattr(option, "__args__", ()) if arg is not option]
    return [option for option in options if is_model(option)] + [
        model for arg in nested if not isinstance(arg, str) for model in inside(arg)
    ]


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_nothing_that_ships_is_unusual(path):
    assert load_scenario(path).warnings == []


def test_every_default_is_usual():
    declared = [(one, name, info) for one in models(Scenario) for name, info in one.model_fields.items()]
    ranges = [(one.__name__, name, info, usual_range(info)) for one, name, info in declared]
    assert sum(usual is not None and not usual.of_magnitude for *_, usual in ranges) > 60
    for model, name, info, usual in ranges:
        if usual is not None:
            assert usual.low < usual.high and usual.reason, (model, name)
            defaults = [] if info.is_required() else numbers(info.get_default(call_default_factory=True))
            odd = [value for value in defaults if not usual.low <= abs(value) <= usual.high and value]
            assert usual.of_magnitude or not odd, (model, name, odd)


@pytest.mark.parametrize("path", IMPLAUSIBLE)
def test_each_is_named_with_its_place_and_what_is_usual(path):
    sets = [f"{path}={IMPLAUSIBLE[path]}"]
    found = load_scenario("tianwen1", sets).warnings
    assert found and all(one.startswith(f"--set {sets[0]}: ") and "is unusual" in one for one in found)


def test_what_is_true_alone_counts_too():
    loaded = load_scenario("tianwen1", ["truth={vehicle.landing_gear.friction: 1e-9}"])
    assert [warning for warning in loaded.warnings if "friction: 1e-09 is unusual" in warning]


def test_fnpeg_without_a_chosen_reversal_logic_is_named_and_with_one_is_not():
    entry = "flight_software.guidance.entry"
    (warning,) = load_scenario("tianwen1", [f"{entry}.law=fnpeg"]).warnings
    assert warning.startswith(f"--set {entry}.law=fnpeg: ") and "so crossrange_corridor chooses" in warning
    for logic in ("own_sign", "crossrange_corridor"):
        assert (
            load_scenario("tianwen1", [f"{entry}.law=fnpeg", f"{entry}.reversal.logic={logic}"]).warnings
            == []
        )


def test_check_prints_warnings_and_succeeds():
    done = called("check", "tianwen1", "--set", "vehicle.landing_gear.friction=1e-9")
    assert done.returncode == 0 and done.stderr.startswith(
        "warning: --set vehicle.landing_gear.friction=1e-9: "
    )


def test_summary_and_report_repeat_them(tmp_path):
    sets = ["vehicle.landing_gear.friction=1e-9", "simulation.time_limit_s=1"]
    flight = edl6dof.fly("tianwen1", sets)
    flight.save(tmp_path / "run", replay=False)
    (warning,) = json.loads((tmp_path / "run" / "summary.json").read_text())["warnings"]
    assert "1e-09 is unusual" in warning
    (report,) = edl6dof.report(tmp_path / "run")
    assert "09 is unusual" in report.read_text(encoding="utf-8")


def test_thrusters_without_a_tank_are_named():
    """They never fire, and nothing else says so."""
    empty = edl6dof.load("phoenix", ["vehicle.tanks=[]", "vehicle.engines=[]", "mission={goal: time}"])
    (line,) = (one for one in empty.warnings if "tank" in one)
    assert "vehicle.rcs.thrusters" in line and "no thruster ever fires" in line
    assert not [one for one in edl6dof.load("tianwen1").warnings if "tank" in one]
