"""Compiled code with numba's bounds check on: tables, lookups, staging and allocation index nothing outside.

A short selection; CONTRIBUTING.md has the command for all tests that compile.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

UNIT = Path(__file__).parents[1] / "unit"
SELECTION = (
    "spatial/test_lookups.py",
    "environment/test_atmosphere.py",
    "environment/test_terrain.py",
    "fsw/test_allocation_table.py",
    "vehicle/test_staging.py",
)
PLANTED = """
import numpy as np
from edl6dof.jit import kernel
@kernel
def beyond(x):
    return x[len(x)]
beyond(np.zeros(3))
"""


@pytest.fixture(scope="module")
def checked(tmp_path_factory):
    """Environment in which kernels are compiled with the bounds check, beside the usual machine code."""
    folder = tmp_path_factory.mktemp("machine_code")
    return os.environ | {"NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(folder)}


def test_an_index_outside_is_found(checked, tmp_path):
    (tmp_path / "planted.py").write_text(PLANTED)
    run = subprocess.run(
        [sys.executable, tmp_path / "planted.py"], env=checked, capture_output=True, text=True
    )
    assert run.returncode != 0 and "IndexError" in run.stderr


def test_kernels_index_nothing_outside(checked):
    files = [str(UNIT / name) for name in SELECTION]
    command = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", *files]
    run = subprocess.run(command, env=checked, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout[-3000:]
    assert " passed" in run.stdout
