"""A small campaign that flies in moments, and the program in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = [sys.executable, "-c", "from edl6dof.cli import main; main()"]

#: Bodies dropped in thin air: a flight is over in a millisecond or two.
DROP = """\
name: drops
planet: mars
vehicle: tianwen1
terrain: {model: none, site_elevation_m: -4099.4, site_latitude_deg: 25.066, site_longitude_deg: 109.925}
atmosphere:
  table: marsgram2010_jezero_feb2021_winds.csv
simulation: {time_limit_s: 2.0}
mission: {goal: time}
initial:
  {altitude_m: 9000.0, latitude_deg: 25.0, longitude_deg: 110.0, speed_m_s: 50.0,
   flight_path_angle_deg: -80.0, azimuth_deg: 0.0}
campaign:
  cases: 430
  seed: 3
  truth:
    vehicle.mass.entry_kg: {kind: normal, three_sigma: 30.0}
    atmosphere.density_factor: {kind: log_normal, sigma_ln: 0.1}
    vehicle.rcs.thrusters.*.thrust_n: {kind: uniform, half_width: 5.0}
"""


def write_drop(folder: Path, **changes: str) -> str:
    """Write the campaign file with lines exchanged; returns its path."""
    text = DROP
    for old, new in changes.items():
        line = next(line for line in text.splitlines() if line.strip().startswith(f"{old}:"))
        text = text.replace(line, new)
    path = folder / "drops.yaml"
    path.write_text(text)
    return str(path)


def program(*words: str, cwd: Path, **more: str) -> subprocess.Popen[str]:
    """Start the program."""
    environment = {
        key: value for key, value in os.environ.items() if key not in ("COLUMNS", "FORCE_COLOR", "TERM")
    }
    environment.update(PYTHONPATH=str(ROOT), **more)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([*PROGRAM, *words], cwd=cwd, env=environment, **pipes)


def finished(*words: str, cwd: Path, **more) -> tuple[int, str, str]:
    """Run the program to its end: status, stdout, stderr."""
    process = program(*words, cwd=cwd, **more)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err
