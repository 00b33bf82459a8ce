"""Hu et al. 2022 (S1): the attitude control of Tianwen-1, its flight results and its claims, recomputed.

What is published of the flight stands beside the mean of neighbouring flights; Figures 8 to 12 are drawn from
the nominal one.  The claims are flown on from its saved states: thrust-direction
tracking of the two error formulations from dispersed starts of the powered descent (section 6.2), a 100 N m
step against the disturbance estimator and against integral action (section 6.2), hazard avoidance with D7
dead (section 6.3, Fig. 7), and a trim wing that fails (section 4.3).  The paper prints curves and maxima, no
tables; where it prints no figure, none stands beside.
"""

from __future__ import annotations

from edl6dof.campaign.executor import in_threads
from edl6dof.campaign.neighbours import FLIGHTS, SPEED_STEP_M_S, fly_neighbours, sample_means
from edl6dof.campaign.rows import table_of
from edl6dof.sim.flight import fly
from edl6dof.studies.hu2022 import findings, rigs, rows
from edl6dof.studies.hu2022.figures import drawings
from edl6dof.studies.hu2022.rows import FOUND_DEG, SETTLED_DEG
from edl6dof.studies.study import Progress, Report, Study

SEED = 2022
REMARKS = (
    "Beside published values stand mean and standard deviation over flights that differ by "
    f"{SPEED_STEP_M_S:g} m/s in entry speed, {FLIGHTS} where the study flies in full.",
    "S1's pitch is the channel of sideslip and its yaw that of the angle of attack: the yaw and pitch of "
    "this body frame. The signs of its axes are not told: sizes compare.",
    "Rates in lift are those of the channels of angle of attack and sideslip: without the yaw p tan(alpha) "
    "that banking about the velocity is in the body.",
    f"Rates and errors are the largest; the thrust direction counts as found within {FOUND_DEG:g} deg, a "
    f"step as settled within {SETTLED_DEG:g} deg; roll in the powered descent is looked at from 8 s on; "
    "beside a phase margin stands its crossover frequency.",
    "Equal PID: the gains that the estimator is worth in its linear range, P + lambda D, lambda P and "
    "D + lambda.",
)


def run(runs: int, progress: Progress) -> Report:
    """Fly the nominal and its neighbours, ``runs`` dispersed entries with either formulation, and the single
    experiments.
    """
    nominal = fly(rigs.nominal())
    around = min(FLIGHTS, max(2, runs))
    means = sample_means(fly_neighbours(nominal.loaded, around), nominal.scenario.published)
    release = rigs.state_at(nominal.metrics["backshell_s"] + rigs.AFTER_RELEASE_S)
    starts = [
        (index, entry, name)
        for index, entry in enumerate(rigs.draw_entries(runs, SEED))
        for name in rigs.FORMULATIONS
    ]
    single = len(rigs.AGAINST_STEP) + len(rigs.AVOIDANCE) + len(rigs.WING)
    total = 1 + around + len(starts) + single
    table = []
    for row in in_threads(lambda start: rows.entry_row(release, *start), starts):
        table.append(row)
        progress(1 + around + len(table), total)
    steps, avoided, wings = rigs.torque_steps(nominal), rigs.avoidance(), rigs.failed_wings()
    table += [*rows.step_rows(steps), *rows.avoidance_rows(avoided), *rows.wing_rows(wings)]
    progress(total, total)
    worst = max((entry for _, entry, _ in starts), key=lambda entry: abs(entry.roll_deg))
    shown = {name: rigs.from_entry(release, worst, name) for name in rigs.FORMULATIONS}
    return Report(
        findings.all_of(nominal, means, table),
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
