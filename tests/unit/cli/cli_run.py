"""Runs the program in a process of its own, and in this one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import in_process
import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = [sys.executable, "-c", "from edl6dof.cli import main; main()"]

#: A flight without flight software that is over in a moment.
SHORT = """\
name: drop
planet: mars
vehicle: tianwen1
terrain: {model: none, site_elevation_m: -4099.4, site_latitude_deg: 25.066, site_longitude_deg: 109.925}
atmosphere: {table: marsgram2010_jezero_feb2021_winds.csv}
wind: {model: none}
simulation: {time_limit_s: 0.5}
initial:
  {altitude_m: 5000.0, latitude_deg: 25.0, longitude_deg: 110.0, speed_m_s: 0.0,
   flight_path_angle_deg: -90.0, azimuth_deg: 0.0}
"""


def environment(**more: str) -> dict[str, str]:
    """The caller's environment with the package on the path and no terminal settings."""
    kept = {
        key: value
        for key, value in os.environ.items()
        if key not in ("COLUMNS", "FORCE_COLOR", "NO_COLOR", "TERM")
    }
    return {**kept, "PYTHONPATH": str(ROOT), **more}


def spawn(words: list[str], cwd: Path, **more: str) -> subprocess.Popen[str]:
    """Start the program."""
    return subprocess.Popen(
        [*PROGRAM, *words],
        cwd=cwd,
        env=environment(**more),
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def run(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *words: str
) -> tuple[int, str, str]:
    """Exit status, stdout and stderr of one command."""
    monkeypatch.setattr(sys, "argv", ["edl6dof", *words])
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit) as end:
        in_process.main()
    out, err = capsys.readouterr()
    return int(end.value.code or 0), out, err


def hidden(folder: Path) -> list[str]:
    """Names of hidden entries of a folder."""
    return sorted(path.name for path in folder.iterdir() if path.name.startswith("."))
