"""``edl6dof check``, ``params``, ``schema`` and ``replay``."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from edl6dof.config.errors import ConfigError
from edl6dof.sim.scenario import Scenario, load_scenario

BAD_INPUT = 2


def run_check(files: Sequence[str], sets: Sequence[str]) -> int:
    """Validate each file; every problem of every file is printed."""
    bad = False
    for name in files:
        try:
            loaded = load_scenario(name, sets)
        except ConfigError as error:
            print(error, file=sys.stderr)
            bad = True
        else:
            print(f"{name}: ok ({loaded.scenario.name}, {len(loaded.scenario.mission.phases)} phases)")
    return BAD_INPUT if bad else 0


def run_params(path: str, as_json: bool) -> int:
    """Print the reference table from ``path`` downwards."""
    from edl6dof.config.reference import rows

    found = rows(Scenario, path)
    if not found:
        print(f"{path}: no such parameter; 'edl6dof params' lists all", file=sys.stderr)
        return BAD_INPUT
    if as_json:
        print(json.dumps([asdict(row) if not hasattr(row, "_asdict") else row._asdict() for row in found], indent=1, default=str))
        return 0
    table = Table(header_style="bold")
    for name in ("path", "type", "unit", "bounds", "default", "meaning", "status"):
        table.add_column(name, overflow="fold")
    for row in found:
        cells = (row.path, row.type, row.unit, row.bounds, row.default, row.meaning, row.status)
        table.add_row(*(escape(str(cell)) if cell is not None else "" for cell in cells))
    console = Console(highlight=False)
    console.print(table)
    return 0


def run_schema() -> int:
    """Print the JSON schema."""
    from edl6dof.config.schema import json_schema

    print(json.dumps(json_schema(Scenario), indent=1))
    return 0


def run_replay(run: Path) -> int:
    """Open the recording of a run in the viewer."""
    import subprocess

    recording = run / "replay.rrd" if run.is_dir() else run
    if not recording.is_file():
        print(f"{recording}: no such replay; fly with the replay on, or name a run folder", file=sys.stderr)
        return BAD_INPUT
    return subprocess.run([sys.executable, "-m", "rerun", str(recording)], check=False).returncode
