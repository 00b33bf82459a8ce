"""Compiled code with numba's bounds check on: tables, rings and allocation index nothing outside.

A short selection of kernels; more are asked by the tests that run as ``long``, and CONTRIBUTING.md has the
command for all tests that compile.
"""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.scenario.records import build_records, initial_plant
from edl6dof.vehicle.plant import OUTPUTS

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
from edl6dof.kernels import kernel
@kernel
def beyond(x):
    return x[len(x)]
beyond(np.zeros(3))
"""

#: Laws of entry guidance with tables of their own, and what gives all other tables something to say.
LAWS = ("etpc", "adaptive_hinf")
SETS = (
    *("wind.gust.enabled=true", "atmosphere.perturbation.enabled=true"),
    "terrain.landing_area.model=generated",
)


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


@pytest.mark.long
def test_kernels_index_nothing_outside(checked):
    files = [str(UNIT / name) for name in SELECTION]
    command = [sys.executable, "-m", "pytest", "-q", "-n0", "-p", "no:cacheprovider", *files]
    run = subprocess.run(command, env=checked, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout[-3000:]
    assert " passed" in run.stdout


@pytest.mark.parametrize("part", ["onboard", pytest.param("world", marks=pytest.mark.long)])
def test_tables_rings_and_allocation_keep_within_bounds(part, checked):
    loaded = [edl6dof.load("tianwen1", [*SETS, f"flight_software.guidance.entry.law={law}"]) for law in LAWS]
    records = []
    for one in loaded:
        parts = build_records(one)
        records.append((*parts, initial_plant(one.truth, parts.case), np.zeros(1, OUTPUTS)))
    done = subprocess.run(
        [sys.executable, Path(__file__).with_name("within_bounds.py"), part],
        input=pickle.dumps(records),
        env=checked,
        capture_output=True,
        timeout=300,
    )
    assert done.stdout.strip() == b"kept within bounds", done.stderr[-3000:].decode()
