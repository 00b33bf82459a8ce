"""``edl6dof report``."""

from __future__ import annotations

from pathlib import Path

from edl6dof.api.blocked_imports import lean_arrow
from edl6dof.api.reports import write_report


def run_report(folder: Path, out: Path | None, pdf: bool, png: bool, force: bool) -> int:
    """Write the report of a folder and say where; returns the exit status."""
    with lean_arrow():
        for path in write_report(folder, out, pdf, png, force):
            print(path)
    return 0
