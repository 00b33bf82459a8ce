"""Every powered law from the same dispersed ignition states, on diverts of three lengths, and with the engine
failing.

No paper's experiment but this simulator's own.  The flights are those of ``tianwen1_mc``; until the engine
lights they are the same for all laws, so that what laws need differs by the laws alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row, table_of
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.studies.landing.conditions import cases, dispersed, with_law
from edl6dof.studies.landing.drawings import drawings
from edl6dof.studies.landing.figures import of_flight
from edl6dof.studies.landing.tables import REMARKS, findings, grids
from edl6dof.studies.landing.timing import call_time
from edl6dof.studies.study import Progress, Report, Study

LAWS = POWERED_LAWS.names


def run(laws: Sequence[str], flights: int, progress: Progress) -> Report:
    """Fly the laws: ``flights`` dispersed landings each, a tenth of that on each divert, and one with each
    fault of the engine.
    """
    rows: list[Row] = []
    calls: dict[str, float] = {}
    truths = dispersed(flights)
    total = len(laws) * len(cases(with_law(laws[0]).scenario, truths, ""))
    for law in laws:
        loaded = with_law(law)
        for row in fly_rows(loaded, cases(loaded.scenario, truths, law), collect=of_flight):
            rows.append(row)
            progress(len(rows), total)
        calls[law] = call_time(loaded)
    return Report(
        tuple(findings(rows, calls)),
        tuple(drawings(rows)),
        table_of(rows),
        total,
        REMARKS,
        tuple(grids(rows, calls)),
    )


STUDY = Study(
    "landing",
    "Powered guidance laws from the same dispersed ignitions: fuel, miss, tilt, diverts, engine faults",
    "this simulator, 2026",
    partial(run, LAWS),
    runs=200,
    quick_runs=20,
    counted=True,
    parts=LAWS,
    run_parts=run,
)
