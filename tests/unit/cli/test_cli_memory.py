"""What a flight may occupy, and the means to keep it there."""

from __future__ import annotations

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from cli_run import environment

from edl6dof.api.blocked_imports import blocked_imports

LINUX = Path("/proc/self/status").exists()
BUDGET_B = 400e6
PROGRAM = [sys.executable, "-c", "from edl6dof.cli import main; main()"]


@pytest.mark.skipif(not LINUX, reason="needs Linux's account of memory")
def test_a_flight_with_all_its_files_keeps_within_the_memory_budget(nominal, tmp_path):
    """With that of the process that draws the replay; what they share counts once.  The shared flight comes
    first: only what compiles may take more.
    """
    with subprocess.Popen(
        [*PROGRAM, "fly", "tianwen1", "--quiet"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(), cwd=tmp_path,
    ) as flying:  # fmt: skip
        peak = 0
        while flying.poll() is None:
            peak = max(peak, sum(map(memory_b, (flying.pid, *children(flying.pid)))))
            time.sleep(0.03)
        out, error = flying.communicate()
    assert out.startswith("tianwen1: landed"), error
    assert (tmp_path / "runs/tianwen1/replay.rrd").is_file()
    assert 100e6 < peak < BUDGET_B


def memory_b(process: int) -> int:
    """Memory of a process, a page that n processes share as an nth part; 0 where it has ended."""
    with suppress(OSError, StopIteration), open(f"/proc/{process}/smaps_rollup") as rollup:
        return 1024 * next(int(line.split()[1]) for line in rollup if line.startswith("Pss:"))
    return 0


def children(process: int) -> list[int]:
    """Processes that it has started and that are still there."""
    with suppress(OSError):
        return [int(one) for one in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    return []


def test_a_module_is_missing_inside_the_block_only(monkeypatch):
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    with pytest.raises(ModuleNotFoundError, match="colorsys"), blocked_imports("colorsys", "json"):
        import json  # imported before, and so still there

        assert json.dumps(1) == "1"
        import colorsys
    import colorsys

    assert colorsys.rgb_to_hls(0.0, 0.0, 0.0) == (0.0, 0.0, 0.0)
