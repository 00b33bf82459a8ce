"""Imports point one way: from the command line down to the vector algebra, never back."""

from collections import Counter
from pathlib import Path

import pytest
from source_rules import HEIGHT, LAYERS, breaches, imports, layer_of, modules, rings, upward_imports

import edl6dof

EVERYTHING = modules()


def test_every_module_of_the_package_has_a_layer():
    assert {layer_of(name) for name, _ in EVERYTHING} - set(HEIGHT) == set()


def test_every_module_imports_only_its_own_layer_or_lower_ones():
    assert breaches(upward_imports, EVERYTHING) == {}


#: What environments and servers are built on: the public API, the words that cross between plant and flight
#: software, and those of messages.
PUBLIC = ("edl6dof.api", "edl6dof.interface", "edl6dof.config.errors", "edl6dof.config.wording")


def beyond_the_api(module, source):
    """Imports of the package in ``gym`` or ``serve`` that are neither public nor of its own folder."""
    allowed = (*PUBLIC, ".".join(module.split(".")[:2]))
    ours = {name for _, name in imports(source, module) if name.startswith("edl6dof.")}
    top = {f"edl6dof.{name}" for name in edl6dof.__all__}
    return sorted(name for name in ours - top if not name.startswith(allowed))


def test_environments_and_servers_are_built_on_the_public_api():
    assert breaches(beyond_the_api, modules("gym", "serve")) == {}
    planted = "from edl6dof import Simulation\nfrom edl6dof.sim.fleet import Fleet"
    assert beyond_the_api("edl6dof.gym.a", planted) == ["edl6dof.sim.fleet", "edl6dof.sim.fleet.Fleet"]


def test_planted_upward_imports_are_found():
    for low, high in zip(LAYERS[1:], LAYERS[2:], strict=False):
        module, planted = f"edl6dof.{low[0]}.a", f"from edl6dof.{high[0]}.b import c"
        assert upward_imports(module, planted) != []
        assert upward_imports(f"edl6dof.{high[0]}.a", f"from edl6dof.{low[0]}.b import c") == []
    assert upward_imports("edl6dof.vehicle.mass", "from ..fsw import onboard") != []
    assert upward_imports("edl6dof.interface.effectors", "from ..vehicle import plant") != []


def test_no_modules_import_each_other_in_a_ring():
    """Imports inside functions and for type checking count as well: who reads one reads all."""
    assert rings(EVERYTHING) == []


@pytest.mark.parametrize(
    "back",
    [
        "import edl6dof.a",
        "def f():\n    from edl6dof.a import x",
        "if TYPE_CHECKING:\n    from edl6dof import a",
    ],
)
def test_a_planted_ring_is_found(back):
    planted = [
        ("edl6dof.a", "from edl6dof.b import y"),
        ("edl6dof.b", "import edl6dof.c"),
        ("edl6dof.c", back),
    ]
    assert rings(planted) == [("edl6dof.a", "edl6dof.b", "edl6dof.c")]
    assert rings(planted[:2]) == []


def test_a_breach_is_told_with_its_module():
    planted = [("edl6dof.vehicle.a", "from ..fsw import cycle"), ("edl6dof.fsw.a", "import numpy")]
    assert list(breaches(upward_imports, planted)) == ["edl6dof.vehicle.a"]


def test_no_two_modules_of_the_tests_have_one_name():
    """pytest puts the folder of each test on the path: whoever is loaded first would be found by both."""
    names = Counter(path.stem for path in Path(__file__).parents[1].rglob("*.py") if path.stem != "conftest")
    assert [name for name, count in names.items() if count > 1] == []
