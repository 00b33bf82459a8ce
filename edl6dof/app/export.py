"""``edl6dof export``."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.source import parse_document
from edl6dof.interchange.nesc import check_case_table, write_table
from edl6dof.sim.records import build_case, build_tables
from edl6dof.sim.scenario import check_document


def run_export(run: Path, target: Path | None, force: bool) -> int:
    """Write the check-case table of a run; to ``nesc.csv`` in its folder if no target is given, ``-`` is standard output."""
    table = nesc_table(run)
    if target == Path("-"):
        write_table(table, sys.stdout)
        return 0
    target = target or run / "nesc.csv"
    if target.exists() and not force:
        raise _problem(target, "exists; choose another file, or replace it with --force")
    try:
        with target.open("w", encoding="utf-8", newline="") as stream:
            write_table(table, stream)
    except OSError as error:
        raise _problem(target, f"cannot be written: {error.strerror or error}") from None
    print(f"{target}: {len(table['time'])} rows")
    return 0


def nesc_table(run: Path) -> dict[str, np.ndarray]:
    """The check-case columns of a run folder.

    Raises:
        ConfigError: the folder is no run.
    """
    import pyarrow.parquet as pq

    text, telemetry = run / "scenario.yaml", run / "telemetry.parquet"
    for path in (text, telemetry):
        if not path.is_file():
            raise _problem(path, "no such file; name the folder of a run")
    truth = check_document(parse_document(text.read_text(encoding="utf-8"), str(text))).truth
    try:
        content = pq.read_table(telemetry)
    except (OSError, ValueError) as error:
        raise _problem(telemetry, f"cannot be read: {' '.join(str(error).split())[:200]}") from None
    columns = {name: content[name].to_numpy() for name in content.column_names}
    tables = build_tables(truth)
    case = build_case(truth, tables)
    return check_case_table(columns, case[0], tables[0]["atmosphere"])


def _problem(path: Path, message: str) -> ConfigError:
    return ConfigError([Problem(str(path), 0, 0, "", message)])
