"""Fly the matrix of single faults, write its table, show it."""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet as pq
from rich.console import Console

from edl6dof.app.faults.choice import FaultOptions, choose
from edl6dof.app.faults.progress import progress_bar
from edl6dof.app.faults.show import show
from edl6dof.app.faults.summary import summary_of
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.faults import fault_cases, fault_response
from edl6dof.campaign.rows import table_of
from edl6dof.config.document.jsontext import json_text
from edl6dof.runs.folder import atomic_folder
from edl6dof.scenario.schema import load_scenario


def run_faults(options: FaultOptions) -> int:
    """Fly the matrix, write its table, show it; returns the exit status."""
    loaded = load_scenario(options.scenario, options.sets)
    failing, phases = choose(options, loaded)
    what = "sensor-faults" if options.sensors else "faults"
    target = options.out or Path("runs") / f"{what}-{loaded.scenario.name}"
    cases = fault_cases(failing, phases, options.after_s)
    with atomic_folder(target, "faults", options.force) as folder:
        with progress_bar(len(cases), quiet=options.as_json) as progress:
            rows = list(
                fly_rows(loaded, cases, workers=options.workers, collect=fault_response, progress=progress)
            )
        pq.write_table(table_of(rows), folder / "faults.parquet", compression="zstd")
        summary = json_text(summary_of(rows, phases))
        (folder / "summary.json").write_text(summary, encoding="utf-8")
    if options.as_json:
        print(summary, end="")
    else:
        show(Console(highlight=False, soft_wrap=True), rows, phases, options.sensors, target)
    return 0 if all(row["success"] for row in rows) else 1
