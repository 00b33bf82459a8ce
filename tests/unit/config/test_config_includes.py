"""Vehicle and planet files, and finding the shipped ones."""

from __future__ import annotations

import pytest
from config_toy import Toy, write

from edl6dof.config.document import locate
from edl6dof.config.document.source import LONGEST_CHAIN, find_shipped, read_document, resolve_scenario
from edl6dof.config.errors import ConfigError
from edl6dof.config.validate import validate

VEHICLE = "# a vehicle\nmass:\n  entry_mass_kg: 1000.0  # [P] S1\n"


@pytest.fixture
def package(tmp_path, monkeypatch):
    """An empty place where the package is installed."""
    root = tmp_path / "install" / "edl6dof"
    root.mkdir(parents=True)
    monkeypatch.setattr(locate, "PACKAGE", root)
    return root


PLACES = ["scenarios/capsule.yaml", "vehicles/capsule.yaml", "install/edl6dof/share/vehicles/capsule.yaml"]


@pytest.mark.parametrize("place", PLACES)
def test_a_named_vehicle_is_found_beside_in_vehicles_and_shipped(tmp_path, package, place):
    write(tmp_path, place, VEHICLE)
    document = read_document(write(tmp_path, "scenarios/a.yaml", "title: x\nvehicle: capsule\n"))
    assert document.data["vehicle"] == {"mass": {"entry_mass_kg": 1000.0}}
    assert document.marks["vehicle", "mass"].file.endswith(place)
    assert document.marks["vehicle", "mass"].line == 2
    assert document.status == {"vehicle.mass.entry_mass_kg": "published"}
    assert [file.name for file in document.files] == ["a.yaml", "capsule.yaml"]


def test_a_nearer_file_wins_over_a_shipped_one(tmp_path, package):
    write(package, "share/vehicles/capsule.yaml", "mass: {entry_mass_kg: 2.0}\n")
    write(tmp_path, "vehicles/capsule.yaml", VEHICLE)
    document = read_document(write(tmp_path, "scenarios/a.yaml", "vehicle: capsule\n"))
    assert document.data["vehicle"]["mass"]["entry_mass_kg"] == 1000.0


def test_an_include_may_be_a_path(tmp_path, package):
    write(tmp_path, "other/capsule.yaml", VEHICLE)
    document = read_document(write(tmp_path, "scenarios/a.yaml", "vehicle: ../other/capsule.yaml\n"))
    assert "mass" in document.data["vehicle"]


@pytest.mark.parametrize("name", ["x" * 5000, '"a\\0b"', "''", "..", "/"])
def test_an_impossible_file_name_is_a_problem(tmp_path, package, name):
    with pytest.raises(ConfigError, match="no such file"):
        validate(Toy, read_document(write(tmp_path, "scenarios/a.yaml", f"vehicle: {name}\n")))


def test_an_inline_vehicle_is_left_alone(tmp_path, package):
    document = read_document(write(tmp_path, "a.yaml", "vehicle: {mass: {entry_mass_kg: 1.0}}\n"))
    assert document.data["vehicle"]["mass"] == {"entry_mass_kg": 1.0}


def test_a_missing_include_names_the_places_and_near_names(tmp_path, package):
    write(tmp_path, "vehicles/capsule.yaml", VEHICLE)
    with pytest.raises(ConfigError) as caught:
        validate(Toy, read_document(write(tmp_path, "scenarios/a.yaml", "title: x\nvehicle: capsul\n")))
    (problem,) = caught.value.problems
    assert (problem.line, problem.path) == (2, "vehicle")
    assert "did you mean capsule" in problem.message
    assert str(tmp_path / "vehicles" / "capsul.yaml") in problem.message


def test_mistakes_in_an_included_file_name_that_file(tmp_path, package):
    write(tmp_path, "vehicles/capsule.yaml", "mass:\n  entry_mass_kg: -1\n")
    scenario = write(tmp_path, "scenarios/a.yaml", "\n\n\nvehicle: capsule\nsed: 1\n")
    with pytest.raises(ConfigError) as caught:
        validate(Toy, read_document(scenario))
    places = {
        problem.path: (problem.file.rsplit("/", 1)[-1], problem.line) for problem in caught.value.problems
    }
    assert places == {"vehicle.mass.entry_mass_kg": ("capsule.yaml", 2), "sed": ("a.yaml", 5)}


def test_all_broken_includes_are_reported_together_with_mistakes_elsewhere(tmp_path, package):
    write(tmp_path, "vehicles/capsule.yaml", "mass: [\n")
    with pytest.raises(ConfigError) as caught:
        text = "vehicle: capsule\nplanet: vulcan\nseed: -1\n"
        validate(Toy, read_document(write(tmp_path, "scenarios/a.yaml", text)))
    places = [(problem.file.rsplit("/", 1)[-1], problem.path) for problem in caught.value.problems]
    assert places == [("capsule.yaml", ""), ("a.yaml", "planet"), ("a.yaml", "seed")]


def test_shipped_files_come_from_repository_share_and_data(package):
    assert find_shipped("scenarios", "a") is None
    planet = write(package, "data/planets/mars.yaml", "x: 1\n")
    shared = write(package, "share/scenarios/a.yaml", "x: 1\n")
    beside = write(package.parent, "scenarios/a.yaml", "x: 1\n")
    assert find_shipped("planets", "mars") == planet
    assert find_shipped("scenarios", "a") == shared  # a folder beside an installed package is not ours
    write(package.parent, "pyproject.toml", "")
    assert find_shipped("scenarios", "a.yaml") == beside
    assert find_shipped("scenarios", "../scenarios/a") is None
    with pytest.raises(ValueError, match="kind"):
        find_shipped("secrets", "a")


def test_scenarios_are_found_by_path_and_by_name_from_anywhere(tmp_path, package, monkeypatch):
    shipped = write(package, "share/scenarios/demo.yaml", "x: 1\n")
    own = write(tmp_path, "mine/own.yaml", "x: 1\n")
    monkeypatch.chdir(tmp_path)
    for text in ("demo", "demo.yaml", "scenarios/demo.yaml", "scenarios/demo"):
        assert resolve_scenario(text) == shipped
    assert resolve_scenario(own) == own
    assert resolve_scenario("mine/own").resolve() == own
    (tmp_path / "demo").mkdir()  # a results folder of that name does not hide the scenario
    assert resolve_scenario("demo") == shipped


def test_an_unknown_scenario_suggests_the_shipped_ones(tmp_path, package, monkeypatch):
    write(package, "share/scenarios/tianwen1.yaml", "x: 1\n")
    write(tmp_path, "runs/x/scenario.yaml", "x: 1\n")
    monkeypatch.chdir(tmp_path)

    def message(text):
        with pytest.raises(ConfigError) as caught:
            resolve_scenario(text)
        return str(caught.value)

    assert "did you mean tianwen1?" in message("tianwen")
    assert "shipped scenarios: tianwen1" in message("zzz")
    assert "no such scenario" in message("elsewhere/tianwen1.yaml")
    assert "runs/x/scenario.yaml" in message("runs/x")
    assert "(no name)" in message("")
    assert "no such scenario" in message("a\0b")
    assert "no such scenario" in message("x" * 5000)


def test_a_long_chain_of_scenarios_is_refused_at_the_line_that_goes_too_far(tmp_path):
    write(tmp_path, "s0.yaml", "x: 0\n")
    for k in range(1, 1501):
        write(tmp_path, f"s{k}.yaml", f"x: {k}\nextends: s{k - 1}.yaml\n")
    assert read_document(tmp_path / f"s{LONGEST_CHAIN}.yaml").data == {"x": LONGEST_CHAIN}
    with pytest.raises(ConfigError) as caught:
        read_document(tmp_path / "s1500.yaml")
    (problem,) = caught.value.problems
    assert (problem.path, problem.line) == ("extends", 2)
    assert problem.file.endswith(f"s{1500 - LONGEST_CHAIN}.yaml")
    assert f"at most {LONGEST_CHAIN} are allowed" in problem.message


@pytest.mark.parametrize(
    ("file", "given", "name"),
    [
        ("heavy.yaml", "", "heavy"),
        ("heavy.yaml", "name: other\n", "other"),
        ("heavy (2).yaml", "", "light"),  # no folder is called that
    ],
)
def test_a_scenario_that_extends_another_goes_by_its_own_name_or_that_of_its_file(
    tmp_path, package, file, given, name
):
    write(tmp_path, "light.yaml", "name: light\nlow: 1.0\n")
    write(tmp_path, "heavy.yaml", "extends: light.yaml\nlow: 2.0\n")
    document = read_document(write(tmp_path, file, f"extends: light.yaml\n{given}low: 3.0\n"))
    assert document.data == {"name": name, "low": 3.0}
    assert document.mark(("name",)).file.endswith("light.yaml" if name == "light" else file)
