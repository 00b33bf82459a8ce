"""The program in a process of its own, as a user starts it, and a small run folder that every viewer can
show.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = [sys.executable, "-c", "from edl6dof.cli import main; main()"]

#: Tianwen-1's entry, cut short: a run with every file and hundreds of rows, flown in a moment.
SHORT = ("tianwen1", "--set", "simulation.time_limit_s=5")

#: What shows a run; ``OUT`` stands for a file to write.
VIEWERS = {
    "report": ("report", "RUN", "--out", "OUT.html"),
    "plot": ("plot", "RUN", "truth.mach", "--out", "OUT.png"),
    "list": ("plot", "RUN"),
    "compare": ("compare", "RUN", "RUN", "--out", "OUT.html"),
    "csv": ("export", "RUN", "OUT.csv", "--format", "csv"),
    "mat": ("export", "RUN", "OUT.mat", "--format", "mat"),
    "oem": ("export", "RUN", "OUT.oem", "--format", "oem"),
    "nesc": ("export", "RUN", "OUT.txt", "--nesc"),
    "replay": ("replay", "RUN", "RUN", "--html", "OUT.html"),
}


def finished(*words: object, cwd: Path, **more: str) -> subprocess.CompletedProcess[str]:
    """Run the program to its end in a process of its own."""
    environment = {
        key: value for key, value in os.environ.items() if key not in ("COLUMNS", "FORCE_COLOR", "TERM")
    }
    environment.update(PYTHONPATH=str(ROOT), **more)
    return subprocess.run(
        [*PROGRAM, *map(str, words)], cwd=cwd, env=environment, capture_output=True, text=True, timeout=300
    )


def viewing(name: str, run: Path, out: Path) -> list[str]:
    """The words of a viewer for a run folder."""
    return [str(run) if word == "RUN" else word.replace("OUT", str(out)) for word in VIEWERS[name]]


def refused(done: subprocess.CompletedProcess[str]) -> bool:
    """Whether a command ended as bad input should: status 2, a message, no traceback."""
    return done.returncode == 2 and bool(done.stderr.strip()) and "Traceback" not in done.stderr + done.stdout
