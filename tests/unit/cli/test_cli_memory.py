"""What a flight may occupy, and the means to keep it there."""

from __future__ import annotations

import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import pytest
from cli_run import environment

from edl6dof.api.flight import Flight

LINUX = Path("/proc/self/status").exists()
BUDGET_B = 400e6
PROGRAM = [sys.executable, "-c", "from edl6dof.cli import main; main()"]


@pytest.mark.skipif(not LINUX, reason="needs Linux's account of memory")
def test_a_flight_with_all_its_files_keeps_within_the_memory_budget(nominal, tmp_path):
    """The shared flight comes first, and its files: only what compiles may take more."""
    Flight.of(nominal).write(tmp_path)
    with subprocess.Popen(
        [*PROGRAM, "fly", "tianwen1", "--quiet"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(), cwd=tmp_path,
    ) as flying:  # fmt: skip
        peak: list[Counter[str]] = []
        while flying.poll() is None:
            now = [memory_b(process) for process in (flying.pid, *children(flying.pid))]
            peak = max(peak, now, key=total_b)
            time.sleep(0.1)
        out, error = flying.communicate()
    assert out.startswith("tianwen1: landed"), error
    assert (tmp_path / "runs/tianwen1/replay.rrd").is_file()
    assert 100e6 < total_b(peak) < BUDGET_B, described(peak)


def memory_b(process: int) -> Counter[str]:
    """Memory of a process by what it holds, a page that n processes share as an nth part; nothing where it
    has ended.
    """
    held: Counter[str] = Counter()
    with suppress(OSError), open(f"/proc/{process}/smaps") as mappings:
        for words in map(str.split, mappings):
            if not words[0].endswith(":"):
                name = Path(words[5]).name if len(words) > 5 else "anonymous"
            elif words[0] == "Pss:":
                held[name] += 1024 * int(words[1])
    return held


def total_b(processes: list[Counter[str]]) -> int:
    """Memory of all of them."""
    return sum(held.total() for held in processes)


def described(processes: list[Counter[str]]) -> str:
    """What takes most of it, MB."""
    return f"{total_b(processes) / 1e6:.1f} MB: " + " beside ".join(
        f"{held.total() / 1e6:.1f} MB, of which "
        + ", ".join(f"{name} {size / 1e6:.1f}" for name, size in held.most_common(9))
        for held in processes
    )


def children(process: int) -> list[int]:
    """Processes that it has started and that are still there."""
    with suppress(OSError):
        return [int(one) for one in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    return []
