"""Machine code is named by its source and all that this imports, but for members that flights are given: no
other kernel reads anything of theirs.

Types of arguments are part of numba's own key, so the layout of a record may be declared there.
"""

import ast
import importlib

import numpy as np
import pytest
from frozen_globals import kernels, names_in
from source_rules import PACKAGE, modules

from edl6dof.kernels import cache

ROOMS = (
    *("spatial", "interface", "fsw", "environment", "vehicle"),
    *("sensors", "telemetry", "sim", "scenario", "metrics"),
)


def of_members(source):
    """Names that a source imports from members that flights are given."""
    found = {}
    for node in ast.parse(source).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("edl6dof"):
            for alias in node.names:
                line = f"from {node.module} import {alias.name}".encode()
                if not cache._imported(line):
                    found[alias.asname or alias.name] = node.module
    return found


def foreign(source, function):
    """What a kernel reads of members."""
    read = names_in(function.__code__)
    for name, module in of_members(source).items():
        if name in read and not isinstance(function.__globals__.get(name), np.dtype):
            yield f"{function.__module__}.{function.__qualname__} reads {name} of {module}"


def test_no_kernel_reads_what_its_code_is_not_named_by():
    found, checked = [], 0
    for name, source in modules(*ROOMS):
        if "@kernel" in source or "@inlined_kernel" in source:
            for function in kernels(importlib.import_module(name)):
                checked += 1
                found += foreign(source, function)
    assert not found and checked > 800


@pytest.mark.parametrize(
    "origin, seen",
    [
        ("spatial.vector", False),
        ("fsw.guidance.powered.apollo", True),
        ("environment.atmosphere_models", False),
    ],
)
def test_planted_imports_are_seen(origin, seen):
    scope = {"size": 1.0}
    exec("def reads(x):\n    return x * size", scope)
    assert bool(list(foreign(f"from edl6dof.{origin} import size", scope["reads"]))) == seen


def test_edit_of_a_law_changes_no_stamp_but_its_own_and_that_of_a_vector_all():
    law, vector, loop = (
        str(PACKAGE / name) for name in ("fsw/guidance/powered/apollo.py", "spatial/vector.py", "sim/loop.py")
    )

    def stamps(edited):
        cache.stamp.cache_clear()
        try:
            cache.received[edited] = b"x = 1\n"
            return [cache.stamp(one) for one in (law, loop)]
        finally:
            del cache.received[edited]
            cache.stamp.cache_clear()

    before = [cache.stamp(one) for one in (law, loop)]
    assert all(before)
    of_law, of_vector = stamps(law), stamps(vector)
    assert of_law[0] != before[0] and of_law[1] == before[1]
    assert of_vector[0] != before[0] and of_vector[1] != before[1]
