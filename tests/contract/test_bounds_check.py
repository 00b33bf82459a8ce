"""Compiled code with numba's bounds check on: tables, lookups, staging and allocation index nothing outside.

A short selection; CONTRIBUTING.md has the command for all tests that compile.
"""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import pytest

import edl6dof
from edl6dof.scenario.records import build_records

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

#: Laws of entry guidance with tables of their own, and what gives all other tables something to say.
LAWS = ("etpc", "adaptive_hinf")
SETS = (
    *("wind.gust.enabled=true", "atmosphere.perturbation.enabled=true"),
    "terrain.landing_area.model=generated",
)
#: Every table that is read in flight, each with the words in which a number enters it.  The records come from
#: outside: to make them, all that plans an entry would be compiled with the bounds check.
TABLES = """
import pickle, sys
import numpy as np
from edl6dof.environment.atmosphere import air
from edl6dof.environment.terrain import ground
from edl6dof.environment.wind import wind
from edl6dof.fsw.guidance.entry.prediction.airframe import believed_aero
from edl6dof.fsw.guidance.entry.profiles.drag_velocity import profile_range
from edl6dof.fsw.guidance.entry.laws.etpc import at_speed
from edl6dof.fsw.guidance.entry.profiles.range_update import range_scale
from edl6dof.fsw.guidance.entry.prediction.reference import node_of
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.vehicle.aerodynamics.capsule import capsule_coefficients

for records in pickle.load(sys.stdin.buffer):
    case, tables, onboard = (record[0] for record in records)
    capsule, gas = case["vehicle"]["aero"]["capsule"], case["planet"]["gas"]
    for x in (np.nan, np.inf, -np.inf, 1e300, -1e300, 9.3e18, -9.3e18, 5e-324, -1.0, 0.0):
        found = {
            "air": air(case["atmosphere"], gas, tables["atmosphere"], x)[0],
            "wind": wind(case["wind"], tables["atmosphere"], x)[0],
            "ground, latitude": ground(case["terrain"], tables["terrain"], x, 1.0)[0],
            "ground, longitude": ground(case["terrain"], tables["terrain"], 0.4, x)[0],
            "aerodynamics, Mach": capsule_coefficients(capsule, tables["aero"], gas, x, 1e-3, 0.2)[0],
            "aerodynamics, angle": capsule_coefficients(capsule, tables["aero"], gas, 5.0, 1e-3, x)[0],
            "model atmosphere": model_atmosphere(onboard["atmosphere"], x)[0],
            "airframe": believed_aero(onboard["vehicle"], x, 1e9)[0],
            "reference": node_of(onboard["reference"], x)[1],
            "range scale": x + range_scale(onboard["reference"], x, 1e5, 0.0, 0.4),
            "influence": at_speed(onboard["plan"]["etpc"], x)[1],
            "profile": profile_range(onboard["plan"]["adaptive_hinf"], x),
        }
        if np.isnan(x):
            assert all(np.isnan(value) for value in found.values()), found
print("kept within bounds")
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


def test_no_table_is_read_out_of_bounds(checked):
    loaded = [edl6dof.load("tianwen1", [*SETS, f"flight_software.guidance.entry.law={law}"]) for law in LAWS]
    records = pickle.dumps([tuple(build_records(one)) for one in loaded])
    done = subprocess.run(
        [sys.executable, "-c", TABLES], input=records, env=checked, capture_output=True, timeout=300
    )
    assert done.stdout.strip() == b"kept within bounds", done.stderr[-3000:].decode()
