"""The landing of Schiaparelli: the chain that lost it, the cliff that it fell from, and the guards that would
have held.

The flight is that of ``scenarios/schiaparelli.yaml``, in which nothing is made to fail.  The flights around
it enter with their nutation in any phase, in gusts of their own: the flag of saturation stays on for
different times, and one guard at a time is switched on.
"""

from __future__ import annotations

from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row, table_of
from edl6dof.sim.flight import fly
from edl6dof.studies.schiaparelli.conditions import GUARDS, PERSISTENCES, all_cases, loaded, swing
from edl6dof.studies.schiaparelli.drawings import drawings
from edl6dof.studies.schiaparelli.tables import REMARKS, findings, grids
from edl6dof.studies.study import Progress, Report, Study


def run(flights: int, progress: Progress) -> Report:
    """Fly ``flights`` phases of the nutation for each persistence, and with each guard."""
    rows: list[Row] = []
    total = flights * (len(PERSISTENCES) + len(GUARDS))
    for overrides, cases in all_cases(flights):
        for row in fly_rows(loaded(*overrides), cases, collect=swing):
            rows.append(row)
            progress(len(rows), total)
    flight = fly(loaded())
    return Report(findings(flight), drawings(flight, rows), table_of(rows), total + 1, REMARKS, grids(rows))


STUDY = Study(
    "schiaparelli",
    "The landing of Schiaparelli: the chain, the cliff and the guards",
    "T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN, 2017",
    run,
    runs=40,
    quick_runs=3,
    counted=True,
)
