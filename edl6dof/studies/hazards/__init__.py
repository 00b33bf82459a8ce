"""Landings among rocks, with and without hazard avoidance.

No paper's experiment but this simulator's own.  The flights are those of ``tianwen1_mc`` over the ground of
``tianwen1_hazards``, another one in each flight, at three abundances of rocks.  Blind landings fly to a fixed
offset: how many of them come down on a rock is known in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row, table_of
from edl6dof.studies.hazards.conditions import ABUNDANCES, WAYS, cases, over
from edl6dof.studies.hazards.drawings import drawings
from edl6dof.studies.hazards.tables import REMARKS, findings, grids
from edl6dof.studies.study import Progress, Report, Study


def run(ways: Sequence[str], flights: int, progress: Progress) -> Report:
    """Fly ``flights`` dispersed landings each way over each ground."""
    rows: list[Row] = []
    total = len(ways) * len(ABUNDANCES) * flights
    for abundance in ABUNDANCES:
        for way in ways:
            for row in fly_rows(over(abundance, way), cases(abundance, way, flights)):
                rows.append(row)
                progress(len(rows), total)
    return Report(
        tuple(findings(rows)), tuple(drawings(rows)), table_of(rows), total, REMARKS, tuple(grids(rows))
    )


STUDY = Study(
    "hazards",
    "Landings among rocks with and without hazard avoidance, at rock abundances of 4, 10 and 20 %",
    "this simulator, 2026",
    partial(run, WAYS),
    runs=200,
    quick_runs=10,
    counted=True,
    parts=WAYS,
    run_parts=run,
)
