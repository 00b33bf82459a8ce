"""Golden flights: the bits of this machine, as it is and as an old processor, are those that are shipped."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.verify.golden import CAMPAIGN, difference, golden_names, read_golden, traced

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from same_anywhere import PROCESSORS  # noqa: E402

#: Without what recompiles the simulator.
OLD = {
    key: value
    for name in ("prescott", "no-avx512", "libm-without-fma")
    for key, value in PROCESSORS[name].items()
}
pytestmark = pytest.mark.exact_start
EXTRA = [name for name in golden_names() if name not in ("tianwen1", "phoenix", "nesc/case10", CAMPAIGN)]


@pytest.fixture(scope="module")
def golden():
    return read_golden()


def test_every_shipped_scenario_is_golden(golden):
    assert list(golden) == golden_names()


@pytest.mark.parametrize(
    "name",
    [
        "tianwen1",
        "phoenix",
        "nesc/case10",
        CAMPAIGN,
        *(pytest.param(name, marks=pytest.mark.long) for name in EXTRA),
    ],
)
def test_bits_are_those_that_are_shipped(golden, name):
    assert difference(golden[name], traced(name)) == ""


@pytest.mark.skipif(sys.platform != "linux", reason="the variables are those of Linux")
def test_an_old_processor_has_the_same_bits():
    command = [sys.executable, "-m", "edl6dof", "verify", "--golden", "--json", "tianwen1", "wu2013"]
    done = subprocess.run(command, env={**os.environ, **OLD}, capture_output=True, text=True, check=False)
    assert json.loads(done.stdout) == {"identical": True, "flights": {"tianwen1": "", "wu2013": ""}}


def test_kept_values_stand_under_the_names_of_their_channels(golden):
    """They did not: channels had been put in another order, and a difference was told of the wrong one."""
    samples = golden["tianwen1"].samples
    telemetry = edl6dof.fly("tianwen1", ["simulation.time_limit_s=1"]).telemetry
    kept, flown = (
        np.array([table[name][0] for name in samples.dtype.names]) for table in (samples, telemetry)
    )
    np.testing.assert_array_equal(kept, flown)


def test_the_first_difference_is_named(golden):
    kept = golden["tianwen1"]
    samples = kept.samples.copy()
    for name in ("truth.mach", "truth.rate_p_deg_s"):
        samples[name][7:] = np.nextafter(samples[name][7:], np.inf)
    hashes = kept.hashes | {"truth.rate_p_deg_s": "0"}
    told = difference(kept, kept._replace(hashes=hashes, samples=samples))
    assert told.startswith(f"truth.mach at {samples['t_s'][7]:.2f} s: ")
    assert difference(kept, kept._replace(hashes=kept.hashes | {"case.vehicle": "0"})) == "case.vehicle"
    assert (
        difference(kept, kept._replace(hashes=kept.hashes | {"figure max_load_g": "0x1p+1"}))
        == "figure max_load_g"
    )
    assert "1 more" in difference(kept, kept._replace(hashes={"a": "1", "b": "2", **kept.hashes}))
