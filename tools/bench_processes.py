"""A section of bench.py: whole processes as a user starts them; wall and CPU time, peak resident memory."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENARIO = "tianwen1"


@dataclass
class Lap:
    """Cost of one repetition."""

    wall_s: float
    cpu_s: float
    steps: int = 0
    peak_mib: float = 0.0

    @property
    def rate(self) -> float:
        """Integration steps per CPU second."""
        return self.steps / self.cpu_s


def snapshot(folder: Path) -> Path:
    """Copy of package, scenarios and vehicles without any compiled code; ``pyproject.toml`` marks it as a
    repository.
    """
    shutil.copy(ROOT / "pyproject.toml", folder)
    for name in ("edl6dof", "scenarios", "vehicles"):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def process(tree: Path, code: str, *arguments: str) -> Lap:
    """Run ``python -c code arguments`` with the package in ``tree``.

    The peak memory of a child is never below that of its parent at the time of the fork: measure before
    importing anything large.

    Raises:
        RuntimeError: the process failed; a flight outside its limits (status 1) is not a failure.
    """
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment["PYTHONPATH"] = str(tree)
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as errors:
        start = time.perf_counter()
        child = subprocess.Popen(
            [sys.executable, "-c", code, *arguments],
            cwd=folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=errors,
        )
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in (0, 1):
            errors.seek(0)
            raise RuntimeError(
                f"{' '.join(arguments) or code}: status {child.returncode}\n{errors.read().decode()[-2000:]}"
            )
    return Lap(wall, usage.ru_utime + usage.ru_stime, peak_mib=usage.ru_maxrss / 1024)


def measure_processes(tree: Path, repeats: int, cold: bool) -> dict[str, list[Lap]]:
    """Laps by name."""
    command = "from edl6dof.cli import main; main()"
    flight = (command, "fly", SCENARIO)
    laps: dict[str, list[Lap]] = {}
    if cold:
        laps["first flight ever"] = [process(tree, *flight)]
    else:
        process(tree, *flight)
    laps["fly, all files"] = [process(tree, *flight) for _ in range(repeats)]
    laps["fly, no replay"] = [process(tree, *flight, "--no-replay") for _ in range(repeats)]
    laps["--help"] = [process(tree, command, "--help") for _ in range(repeats)]
    laps["import edl6dof"] = [process(tree, "import edl6dof") for _ in range(repeats)]
    laps["python alone"] = [process(tree, "pass") for _ in range(repeats)]
    return laps
