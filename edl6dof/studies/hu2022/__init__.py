"""Hu et al. 2022 (S1): the attitude control of Tianwen-1, its flight results and its claims, recomputed.

Figures 8 to 12 come from the nominal flight.  The claims are flown on from its saved states: thrust-direction
tracking of the two error formulations from dispersed starts of the powered descent (section 6.2), a 100 N m
step against the disturbance estimator and against integral action (section 6.2), hazard avoidance with D7
dead (section 6.3, Fig. 7), and a trim wing that fails (section 4.3).  The paper prints curves and maxima, no
tables; where it prints no figure, none stands beside.
"""

from __future__ import annotations

from edl6dof.campaign.executor import in_threads
from edl6dof.campaign.rows import table_of
from edl6dof.sim.flight import fly
from edl6dof.studies.hu2022 import findings, rigs, rows
from edl6dof.studies.hu2022.figures import drawings
from edl6dof.studies.hu2022.rows import FOUND_DEG, SETTLED_DEG
from edl6dof.studies.study import Progress, Report, Study

SEED = 2022
REMARKS = (
    "Touchdown errors and rates of one flight are samples of a limit cycle: their size compares, not "
    "their sign.",
    "The real descent under the parachute took 168.9 s; this vehicle needs 20 s less, so all later times are "
    "earlier.",
    f"Rates and errors are the largest; the thrust direction counts as found within {FOUND_DEG:g} deg, a "
    f"step as settled within {SETTLED_DEG:g} deg; roll in the powered descent is looked at from 8 s on; "
    "beside a phase margin stands its crossover frequency.",
    "Equal PID: the gains that the estimator is worth in its linear range, P + lambda D, lambda P and "
    "D + lambda.",
)


def run(runs: int, progress: Progress) -> Report:
    """Fly the nominal, ``runs`` dispersed entries with either formulation, and the single experiments."""
    nominal = fly(rigs.nominal())
    release = rigs.state_at(nominal.metrics["backshell_s"] + rigs.AFTER_RELEASE_S)
    starts = [
        (index, entry, name)
        for index, entry in enumerate(rigs.draw_entries(runs, SEED))
        for name in rigs.FORMULATIONS
    ]
    single = len(rigs.AGAINST_STEP) + len(rigs.AVOIDANCE) + len(rigs.WING)
    total = 1 + len(starts) + single
    table = []
    for row in in_threads(lambda start: rows.entry_row(release, *start), starts):
        table.append(row)
        progress(1 + len(table), total)
    steps, avoided, wings = rigs.torque_steps(nominal), rigs.avoidance(), rigs.failed_wings()
    table += [*rows.step_rows(steps), *rows.avoidance_rows(avoided), *rows.wing_rows(wings)]
    progress(total, total)
    worst = max((entry for _, entry, _ in starts), key=lambda entry: abs(entry.roll_deg))
    shown = {name: rigs.from_entry(release, worst, name) for name in rigs.FORMULATIONS}
    return Report(
        findings.all_of(nominal, table),
        drawings(nominal, shown, table, steps, avoided, wings),
        table_of(table),
        total,
        REMARKS,
    )


STUDY = Study(
    "hu2022",
    "Attitude control of Tianwen-1 from entry to touchdown",
    "Hu et al. 2022",
    run,
    runs=100,
    quick_runs=6,
    counted=True,
)
