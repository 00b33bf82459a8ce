"""What a flight may occupy, and the means to keep it there."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from cli_run import environment

from edl6dof.api.blocked_imports import blocked_imports

LINUX = Path("/proc/self/status").exists()
BUDGET_B = 400e6
#: Largest resident memory of this program since it began, kB; ``getrusage`` would count what the process was
#: before, a copy of its parent.
PEAK = """
from edl6dof.cli import main
try:
    main()
finally:
    with open("/proc/self/status") as status:
        print(next(line.split()[1] for line in status if line.startswith("VmHWM")))
"""


@pytest.mark.skipif(not LINUX, reason="needs Linux's account of memory")
def test_a_flight_with_all_its_files_keeps_within_the_memory_budget(nominal, tmp_path):
    """The shared flight comes first: only what compiles may take more."""
    done = subprocess.run(
        [sys.executable, "-c", PEAK, "fly", "tianwen1", "--quiet"],
        capture_output=True, text=True, env=environment(), cwd=tmp_path, timeout=300,
    )  # fmt: skip
    assert done.stdout.startswith("tianwen1: landed"), done.stderr
    assert (tmp_path / "runs/tianwen1/replay.rrd").is_file()
    assert int(done.stdout.split()[-1]) * 1024 < BUDGET_B


def test_a_module_is_missing_inside_the_block_only(monkeypatch):
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    with pytest.raises(ModuleNotFoundError, match="colorsys"), blocked_imports("colorsys", "json"):
        import json  # imported before, and so still there

        assert json.dumps(1) == "1"
        import colorsys
    import colorsys

    assert colorsys.rgb_to_hls(0.0, 0.0, 0.0) == (0.0, 0.0, 0.0)
