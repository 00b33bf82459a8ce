"""The files of a run that hold its numbers: resolved scenario, telemetry, events, summary, landing map."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof import __version__
from edl6dof.config.document.jsontext import json_text
from edl6dof.metrics.published import published_figures
from edl6dof.runs.contents import write_landing_map

if TYPE_CHECKING:
    from edl6dof.sim.flight import Flight


#: Rows written at a time: keeps the memory of writing small beside the telemetry itself.
ROW_GROUP = 2_500


def write_run(flight: Flight, folder: Path) -> None:
    """Write these files into ``folder``, which exists."""
    (folder / "scenario.yaml").write_text(flight.resolved_scenario, encoding="utf-8")
    write_telemetry(flight, folder / "telemetry.parquet")
    (folder / "events.json").write_text(json_text(flight.events), encoding="utf-8")
    (folder / "summary.json").write_text(json_text(summary(flight)), encoding="utf-8")
    if flight.landing_map is not None:
        write_landing_map(flight.landing_map, folder)


def summary(flight: Flight) -> dict[str, Any]:
    """Outcome, figures, limits and published figures of a flight, ready for JSON."""
    return {
        "name": flight.name,
        "outcome": flight.outcome,
        "success": flight.success,
        "reached_goal": flight.termination.reached,
        "time_s": flight.time_s,
        "phase": flight.phase,
        "edl6dof_version": __version__,
        "seed": flight.scenario.seed,
        "scenario_sha256": hashlib.sha256(flight.resolved_scenario.encode()).hexdigest(),
        "warnings": flight.loaded.warnings,
        "figures": flight.metrics,
        "limits": [
            {"name": c.label, "value": c.value, "limit": c.limit, "unit": c.unit, "ok": c.ok}
            for c in flight.checks
        ],
        "published": {
            beside.figure.name: beside.published.model_dump(exclude_none=True)
            for beside in published_figures(flight.scenario.published)
        },
    }


def write_telemetry(flight: Flight, path: Path) -> None:
    """Write all telemetry columns as Parquet; unit and meaning of each are in the column's metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from edl6dof.telemetry.columns import describe

    fields = []
    for name in flight.telemetry:
        unit, meaning = describe(name)
        fields.append(pa.field(name, pa.float64(), metadata={"unit": unit, "meaning": meaning}))
    metadata = {
        "edl6dof_version": __version__,
        "scenario": flight.resolved_scenario,
        "outcome": flight.outcome,
        "phases": json.dumps(flight.phase_names),
    }
    schema = pa.schema(fields, metadata=metadata)
    rows = len(flight.log)
    options = {"compression": "zstd", "use_dictionary": False, "use_byte_stream_split": True}
    with pq.ParquetWriter(path, schema, **options) as writer:
        for start in range(0, rows, ROW_GROUP):
            columns = flight.telemetry.rows(start, start + ROW_GROUP).values()
            # from their memory as it is: pa.array would import pandas, where that is installed
            part = [_array(np.ascontiguousarray(values, float)) for values in columns]
            writer.write_table(pa.Table.from_arrays(part, schema=schema))
            del columns, part
    pa.default_memory_pool().release_unused()  # 30 MB that the system would not get back


def _array(values: np.ndarray) -> Any:
    import pyarrow as pa

    return pa.Array.from_buffers(pa.float64(), len(values), [None, pa.py_buffer(values)])
