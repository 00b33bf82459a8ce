"""Truth and belief never mix: what the flight software may import and be given, and which code knows no
physics or no files.
"""

from functools import cache

import pytest
from source_rules import breaches, forbidden_imports, forbidden_parameters, has_kernels, modules

TRUTH = ("edl6dof.vehicle", "edl6dof.environment", "edl6dof.sensors", "edl6dof.scenario", "edl6dof.sim")
TRUTH_RECORDS = ("case", "cases", "plant", "plants", "outputs", "outputs_", "tables", "tables_")
ONBOARD = modules("fsw")
SENSORS = modules("sensors")
EVERYTHING = modules()
#: What kernels must not see: files, the viewer, and everything of the configuration that reads or validates
#: YAML.
READERS = (
    "yaml",
    "rerun",
    "pyarrow",
    "typer",
    "rich",
    *(f"edl6dof.config.document.{name}" for name in ("source", "yamltree", "overrides", "locate")),
    *(f"edl6dof.config.{name}" for name in ("validate", "errors", "dump", "schema")),
)


@cache
def with_kernels():
    """Modules that define compiled functions; when it is asked, as to find them all sources are parsed."""
    return [(name, source) for name, source in EVERYTHING if has_kernels(source)]


def test_there_is_something_to_check():
    assert len(ONBOARD) > 20
    assert len(SENSORS) >= 2
    assert len(with_kernels()) > 30


def importing(sources, *forbidden):
    """Imports that these modules may not make, by module."""
    return breaches(lambda name, source: forbidden_imports(source, forbidden, name), sources)


def given(sources, *forbidden):
    """Parameters that functions of these modules may not take, by module."""
    return breaches(lambda _, source: forbidden_parameters(source, forbidden), sources)


def test_flight_software_does_not_import_the_truth():
    assert importing(ONBOARD, *TRUTH) == {}


def test_flight_software_is_not_given_the_truth():
    assert given(ONBOARD, *TRUTH_RECORDS) == {}


def test_sensors_see_the_plant_but_not_the_flight_software():
    assert importing(SENSORS, "edl6dof.fsw", "edl6dof.sim") == {}
    assert given(SENSORS, "fsw", "onboard", "nav", "memory_fsw") == {}


def test_plant_knows_neither_flight_software_nor_belief():
    """The way back goes through the command record of the actuators alone."""
    plant = modules("vehicle", "environment")
    assert len(plant) > 50
    assert importing(plant, "edl6dof.fsw", "edl6dof.sensors") == {}
    assert given(plant, "fsw", "onboard", "nav", "sensors", "sensed") == {}


def test_files_with_kernels_know_no_yaml_no_files_and_no_viewer():
    assert importing(with_kernels(), *READERS) == {}


@pytest.mark.parametrize("folder", ["runs", "report", "replay", "cli", "api"])
def test_results_and_command_line_know_no_physics(folder):
    found = modules(folder) or [(n, s) for n, s in EVERYTHING if n == f"edl6dof.{folder}"]
    if not found:
        pytest.skip(f"no edl6dof.{folder} yet")
    physics = tuple(
        n for n, _ in with_kernels() if n.split(".")[1] in ("vehicle", "environment", "fsw", "sensors")
    )
    assert len(physics) > 20
    assert importing(found, *physics) == {}  # parameter models without kernels may be read
    assert breaches(lambda _, source: has_kernels(source), found) == {}


@pytest.mark.parametrize(
    "planted",
    [
        "from edl6dof.vehicle.plant import STATE",
        "import edl6dof.environment.atmosphere as a",
        "from edl6dof import environment",
        "def f():\n    from edl6dof.scenario.truth import CASE",
        "from ..vehicle import mass",
        "from edl6dof.sensors.imu import READINGS",
        "import importlib\nimportlib.import_module('edl6dof.vehicle.mass')",
    ],
)
def test_planted_import_of_the_truth_is_found(planted):
    assert forbidden_imports(planted, TRUTH, "edl6dof.fsw.navigation") != []
    assert forbidden_imports("from edl6dof.spatial.vector import dot\nimport edl6dof.vehicles", TRUTH) == []


@pytest.mark.parametrize(
    "planted",
    [
        "def f(onboard, plant): ...",
        "def f(*, case): ...",
        "g = lambda tables: 0",
        "def f(a, /, *plant): ...",
        "def o():\n  def i(case): ...",
    ],
)
def test_planted_parameter_with_the_truth_is_found(planted):
    assert forbidden_parameters(planted, TRUTH_RECORDS) != []
    assert forbidden_parameters("def f(onboard, nav, planted): ...", TRUTH_RECORDS) == []


def test_planted_file_access_of_a_kernel_is_found():
    planted = "import yaml\nfrom edl6dof.kernels import kernel\n@kernel\ndef f(x):\n    return x\n"
    assert has_kernels(planted)
    assert forbidden_imports(planted, READERS) == ["1: yaml"]
    assert not has_kernels("def kernel(f): return f\n")
