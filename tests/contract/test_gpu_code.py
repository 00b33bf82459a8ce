"""What a flight runs stays such that GPU code can be made of it; ``tools/gpu_code.py`` makes it."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from gpu_rules import foreign_to_gpus
from source_rules import breaches, modules

FLYING = modules("environment", "fsw", "interface", "sensors", "sim", "spatial", "vehicle", "telemetry")


def test_kernels_of_a_flight_hold_nothing_that_no_gpu_has():
    assert breaches(lambda _, source: foreign_to_gpus(source), FLYING) == {}


def test_planted_statements_are_found():
    for planted in (
        "x = np.floor(y)",
        "x = np.zeros(3)",
        "a[:] = b",
        "a[0, :] = b[1]",
        "b = a.copy()",
        "print(y)",
        "raise ValueError",
    ):
        assert foreign_to_gpus(f"@kernel\ndef look(a, b, y):\n    {planted}\n") != []
    assert foreign_to_gpus("@kernel\ndef clear(a, b):\n    a[:] = 0.0\n    b[0] = a[1]\n") == []
    assert foreign_to_gpus("def plan(a, b):\n    a[:] = b\n") == []


def test_equations_of_motion_become_gpu_code():
    """No GPU is needed for that; half a minute where numba-cuda is installed."""
    pytest.importorskip("numba_cuda", reason="edl6dof[gpu] is not installed")
    tool = Path(__file__).parents[2] / "tools/gpu_code.py"
    words = [sys.executable, str(tool), "--part", "derivative"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr
    print(done.stdout)
    spilled = re.search(r"at most (\d+) bytes", done.stdout)
    assert spilled is not None and int(spilled[1]) < 500
