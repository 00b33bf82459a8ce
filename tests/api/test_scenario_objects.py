"""Scenarios and vehicles as objects: they print, draw and change, and stand wherever a name may stand."""

import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import edl6dof
from edl6dof.api.arguments import named
from edl6dof.api.scenario import MAIN_VALUES

ROOT = Path(edl6dof.__file__).parents[1]
MASS = "vehicle.mass.entry_kg"


@pytest.fixture(scope="module")
def scenario():
    return edl6dof.Scenario("tianwen1")


def test_load_returns_the_object(scenario):
    loaded = edl6dof.load("tianwen1", ["seed=4"])
    assert isinstance(loaded, edl6dof.Scenario) and isinstance(loaded, edl6dof.LoadedScenario)
    assert loaded.scenario == scenario.with_("seed=4").scenario != scenario.scenario


def test_a_value_is_read_by_its_path(scenario):
    assert scenario[MASS] == scenario.scenario.vehicle.mass.entry_kg
    assert scenario["vehicle.rcs.thrusters.D4.thrust_n"] == 250.0
    assert scenario["vehicle.rcs.thrusters.3"].name == "D4"
    assert scenario["vehicle.mass"] is scenario.scenario.vehicle.mass
    for unknown in ("vehicle.mass.entri_kg", "vehicle.rcs.thrusters.D99", "seed.real", "phase_names", ""):
        with pytest.raises(KeyError, match="no parameter"):
            scenario[unknown]
    with pytest.raises(KeyError, match=f"did you mean '{MASS}'"):
        scenario["vehicle.mass.entri_kg"]


def test_main_values_are_printed_with_changes_and_warnings(scenario):
    text = repr(scenario.with_({MASS: 90_000.0}))
    title, *lines = text.splitlines()
    assert title.startswith("tianwen1: ") and "90000.0  kg" in text
    assert [line for line in lines if line.startswith("changed: ")] == [f"changed: {MASS}=90000.0"]
    assert any(line.startswith("warning: ") and "ballistic coefficient" in line for line in lines)
    assert "height_above_areoid_m" not in text, "it is not set"
    html = scenario._repr_html_()
    assert html.count("<tr>") == 1 + sum(scenario[path] not in (None, "") for path in MAIN_VALUES)


def test_show_prints_what_the_command_prints(scenario, capsys):
    from edl6dof.cli.inspection import show_values

    scenario.show("flight_software.control")
    own = capsys.readouterr().out
    show_values("tianwen1", "flight_software.control", (), as_json=False)
    assert own == capsys.readouterr().out and "flight_software.control" in own
    with pytest.raises(edl6dof.ConfigError, match="did you mean"):
        scenario.show("flight_software.controls")


def test_changes_make_another_scenario_and_the_last_one_counts(scenario):
    heavy = scenario.with_({MASS: 1350.0}, "seed=3").with_(["seed=5"], {"wind": {"scale": 2.0}})
    assert (heavy[MASS], heavy["seed"], heavy["wind.scale"]) == (1350.0, 5, 2.0)
    assert scenario[MASS] == 1284.0 and scenario["seed"] == 1
    assert heavy.overrides == (f"{MASS}=1350.0", "seed=3", "seed=5", "wind.scale=2.0")


def test_all_mistakes_of_changes_are_one_error(scenario):
    """Those of keys, and those of values, which are found only when the keys are right."""
    with pytest.raises(edl6dof.ConfigError) as caught:
        scenario.with_({"sede": 3, MASS: -1.0}, "vehicle.mas.entry_kg=1", "terrain.site_latitude_deg=100")
    found = {(problem.file, problem.path) for problem in caught.value.problems}
    paths = ("sede", MASS, "vehicle.mas.entry_kg", "terrain.site_latitude_deg")
    assert found == {("overrides", path) for path in paths}
    with pytest.raises(TypeError, match="texts 'path=value'"):
        scenario.with_(3)


def test_a_saved_scenario_has_the_same_values(scenario, tmp_path):
    heavy = scenario.with_({MASS: 1350.0, "truth": {"wind.scale": 1.2}})
    heavy.save(tmp_path / "heavy.yaml")
    again = edl6dof.Scenario(tmp_path / "heavy.yaml")
    assert again.scenario == heavy.scenario and again.truth == heavy.truth != again.scenario
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        heavy.save(tmp_path / "heavy.yaml")


def test_a_vehicle_prints_and_draws(scenario, tmp_path):
    vehicle = scenario.vehicle
    text = repr(vehicle)
    assert text.startswith("Tianwen-1\n") and "1284 kg" in text and "8 horizontal, 4 axial" in text
    assert [state.name for state in vehicle.authority] == ["at entry", "without aeroshell"]
    plot = vehicle.draw(tmp_path / "vehicle.svg")
    assert "A1" in (tmp_path / "vehicle.svg").read_text() and len(plot.figure.axes) >= 2
    assert vehicle.draw()._repr_png_()[:4] == b"\x89PNG"
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        vehicle.draw(tmp_path / "vehicle.svg")
    with pytest.raises(edl6dof.ConfigError, match="must end in"):
        vehicle.draw(tmp_path / "vehicle.gif")
    with pytest.raises(edl6dof.ConfigError, match="no shape to draw"):
        edl6dof.Scenario("zheng2015").vehicle.draw()


def test_functions_take_the_object_with_its_changes(scenario):
    heavy = scenario.with_({MASS: 1350.0})
    assert named(heavy, ["seed=2"]) == ("tianwen1", (f"{MASS}=1350.0", "seed=2"))
    assert edl6dof.load(heavy, {"seed": 2})[MASS] == 1350.0
    assert edl6dof.Simulation(heavy, {"seed": 2}).loaded.scenario.seed == 2
    with pytest.raises(TypeError, match="or edl6dof.Scenario"):
        edl6dof.campaign(heavy.scenario)


def test_flights_and_campaigns_of_the_object(scenario):
    """The campaign's own section of the file counts, and the mass that was changed is drawn from."""
    short = {"simulation.time_limit_s": 5.0, "mission.goal": "time"}
    brief = scenario.with_(short)
    assert brief.fly().log.tobytes() == edl6dof.fly("tianwen1", short).log.tobytes()
    assert brief.fly().log.tobytes() == edl6dof.fly(scenario, short).log.tobytes()
    many = edl6dof.Scenario("tianwen1_mc", short)
    found = edl6dof.campaign(many, cases=2, workers=1)
    assert found.table.equals(edl6dof.campaign("tianwen1_mc", short, cases=2, workers=1).table)


def test_cases_whose_changes_are_no_numbers_fly_from_the_object(scenario):
    """They are checked like a file, from the document of the scenario, and may go to another process."""
    brief = pickle.loads(pickle.dumps(scenario.with_({"simulation.time_limit_s": 5.0})))
    cases = [edl6dof.Case(0), edl6dof.Case(1, belief={"flight_software.guidance.entry.law": "constant_bank"})]
    rows = edl6dof.fly_rows(brief, cases, workers=1)
    assert [row["end_s"] for row in rows] == [5.0, 5.0] and brief["simulation.time_limit_s"] == 5.0


def test_plugins_of_a_scenario_are_loaded_first():
    """In a process of its own: the families are built when the first scenario is read."""
    code = "import edl6dof; s = edl6dof.Scenario('scenarios/plugin/energy_law.yaml'); print(s.scenario.name)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert (done.returncode, done.stderr) == (0, "")
