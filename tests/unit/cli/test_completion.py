"""The shell completes scenarios, parameter paths and channels."""

import os
import subprocess
import sys

import pytest


def completed(*words):
    """What the shell is offered for the last word."""
    line = " ".join(("edl6dof", *words))
    asked = {"_EDL6DOF_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words))}
    program = "import sys; sys.argv = ['edl6dof']; from edl6dof.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=os.environ | asked, check=False
    )
    assert done.returncode == 0 and not done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    "words, some",
    [
        (("fl",), {"fly"}),
        (("fly", "msl"), {"msl", "msl_landing", "msl_range_trigger"}),
        (("fly", "tianwen1", "--set", "vehicle.mass.entry_k"), {"vehicle.mass.entry_kg="}),
        (("params", "vehicle.rcs.th"), {"vehicle.rcs.thrusters"}),
        (("fly", "no_such", "--set", "wind.mo"), {"wind.model="}),
        (("plot", "no_such_run", "tr"), set()),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_words_are_completed(words, some):
    found = completed(*words)
    assert some <= set(found) and all(word.startswith(words[-1]) for word in found)


def test_paths_name_the_parts_of_the_scenario():
    assert "vehicle.engines.main.thrust_factor=" in completed("fly", "tianwen1", "--set", "vehicle.engines.m")
