"""Build a wheel with machine code, so that the first flight after its installation compiles nothing.

    python tools/wheel_with_code.py dist      # Linux x86-64; 10 minutes on two cores

It flies the shipped scenarios as this version of Python and of numba compiles them for processors of the
level x86-64-v3 (2013 and later), and checks that each has the same bits as the golden flight.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from edl6dof.kernels.shipped import ARCHIVE, TARGET

ROOT = Path(__file__).resolve().parents[1]


def compile_all(folder: Path) -> Path:
    """Fly all shipped scenarios with an empty cache in ``folder``; returns the folder of machine code."""
    settings = {"NUMBA_CACHE_DIR": str(folder), "NUMBA_CPU_NAME": TARGET, "NUMBA_CPU_FEATURES": ""}
    environment = os.environ | settings | {"PYTHONPATH": str(ROOT)}
    for command in (["fly", "tianwen1", "--out", str(folder / "run")], ["verify", "--golden"]):
        subprocess.run([sys.executable, "-m", "edl6dof", *command], cwd=folder, env=environment, check=True)
    (place,) = (one for one in (folder / "edl6dof").iterdir() if one.is_dir())
    return place


def main() -> int:
    """Compile, pack, build."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path, help="where the wheel goes")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        code = Path(name, ARCHIVE.name)
        with tarfile.open(code, "w:xz") as archive:
            for file in sorted(compile_all(Path(name)).iterdir()):
                archive.add(file, file.name)
        print(f"{code.stat().st_size / 1e6:.1f} MB of machine code")
        command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "-w", str(options.folder), str(ROOT)]
        return subprocess.run(command, env=os.environ | {"EDL6DOF_CODE": str(code)}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
