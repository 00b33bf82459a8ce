"""The folder of a kernel's machine code is named by a hash of some sources: a kernel reads nothing of others.

Types of arguments are part of numba's own key, so the layout of a record may be declared anywhere.
"""

import ast
from pathlib import Path

import numpy as np
import pytest
from frozen_globals import kernels, names_in
from source_rules import PACKAGE, modules

from edl6dof.kernels import cache
from edl6dof.sim import loop


def files_of(file):
    """Sources that the machine code of a file follows from, by path below the package."""
    name = Path(file).relative_to(PACKAGE).as_posix()
    groups = (one for one in ("shared", "software", "plant") if name.startswith(cache._GROUPS[one]))
    group = next(groups, "ground" if name.startswith(cache._GROUND) else "rest")
    known = {one for one in cache._sources() if one.startswith(cache._GROUPS[group])}
    return (known if group == "rest" else known - cache._members()) | {name}


def origins(source):
    """Dotted name of the module that each imported name of a source comes from."""
    found = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("edl6dof"):
            found |= {alias.asname or alias.name: (node.module, alias.name) for alias in node.names}
    return found


def foreign(file, source, function):
    """What a kernel reads from files outside its group."""
    read, allowed = names_in(function.__code__), files_of(file)
    for name, (module, given) in origins(source).items():
        value = function.__globals__.get(name)
        if name not in read or isinstance(value, np.dtype):
            continue
        parts = module.split(".")[1:]
        places = [
            "/".join((*parts, f"{given}.py")),
            f"{'/'.join(parts)}.py",
            "/".join((*parts, "__init__.py")),
        ]
        if not allowed.intersection(places):
            yield f"{file}: {function.__qualname__} reads {module}.{given}"


def test_no_kernel_reads_what_its_folder_is_not_named_by():
    import importlib

    found, checked = [], 0
    for name, source in modules(
        "spatial",
        "interface",
        "fsw",
        "environment",
        "vehicle",
        "sensors",
        "telemetry",
        "sim",
        "scenario",
        "metrics",
    ):
        if "@kernel" not in source and "@inlined_kernel" not in source:
            continue
        module = importlib.import_module(name)
        for function in kernels(module):
            checked += 1
            found += foreign(module.__file__, source, function)
    assert not found and checked > 800


@pytest.mark.parametrize(
    "file, origin, seen",
    [
        ("fsw/cycle.py", "edl6dof.spatial.vector", False),
        ("fsw/cycle.py", "edl6dof.vehicle.mass", True),
        ("fsw/cycle.py", "edl6dof.fsw.guidance.powered.apollo", True),
        ("vehicle/mass.py", "edl6dof.sim.flight", True),
    ],
)
def test_planted_imports_are_seen(file, origin, seen):
    scope = {"size": 1.0}
    exec("def reads(x):\n    return x * size", scope)
    source = f"from {origin} import size"
    assert bool(list(foreign(str(PACKAGE / file), source, scope["reads"]))) == seen


def test_the_loop_and_a_member_have_different_folders():
    law = PACKAGE / "fsw/guidance/powered/apollo.py"
    folders = {cache.folder_of(str(one)) for one in (law, PACKAGE / "fsw/cycle.py", Path(loop.__file__))}
    assert len(folders) == 3
