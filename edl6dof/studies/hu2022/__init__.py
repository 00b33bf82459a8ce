"""Hu et al. 2022 (S1): the attitude control of Tianwen-1, its flight results and its claims, recomputed.

What is published of the flight stands beside the mean of neighbouring flights; Figures 8 to 12 are drawn from
the nominal one.  The claims are flown on from its saved states: thrust-direction
tracking of the two error formulations from dispersed starts of the powered descent (section 6.2), a 100 N m
step against the disturbance estimator and against integral action (section 6.2), hazard avoidance with a dead
horizontal thruster (section 6.3, Fig. 7), and a trim wing that fails (section 4.3).  The paper prints curves
and maxima, no tables; where it prints no figure, none stands beside.
"""

from __future__ import annotations

from edl6dof.campaign.executor import in_threads
from edl6dof.campaign.neighbours import FLIGHTS, SPEED_STEP_M_S, fly_neighbours, sample_means
from edl6dof.campaign.rows import table_of
from edl6dof.sim.flight import fly
from edl6dof.studies.hu2022 import avoidance, findings, rigs, rows
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
    "Fig. 7: each horizontal thruster dies before its first push, or 1 or 2 s into it, 20 m to go, on "
    "instruments. Where a PID law alone works against the disturbance, that spoils the roll axis, and "
    "diagnosis saves it, as the paper says. The paper's estimator at the lambda of the scenario saves it by "
    "itself, with P + lambda D in place of P, and diagnosis leaves a quarter of what is left. The safe "
    "spot is reached either way, as the missing force is fed forward. The paper prints neither gains "
    "nor lambda; foreseen is d / (J (P + lambda D)).",
    "Fig. 12: the 40 N are the estimate of a disturbance with sound thrusters, not the force of avoidance, "
    "of which a pair has 500 N. As printed, eq. 12 takes the commanded force as delivered, which makes pulse "
    "modulation part of the estimate: that meets the 40 N near lambda_v = 1 rad/s. Here the estimator sees "
    "the valves.",
    "Fig. 11: the largest torque of the real flight was about its yaw, here it is about the yaw of this body "
    "frame, where the tanks are out of balance: sizes compare.",
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
    before = avoidance.starts(runs)
    dead = len(list(avoidance.cases(before, nominal.scenario)))
    total = 1 + around + len(starts) + len(rigs.AGAINST_STEP) + dead + len(rigs.WING)
    table = []
    for row in in_threads(lambda start: rows.entry_row(release, *start), starts):
        table.append(row)
        progress(1 + around + len(table), total)
    for row in avoidance.avoidance_rows(before, nominal.scenario):
        table.append(row)
        progress(1 + around + len(table), total)
    steps, wings = rigs.torque_steps(nominal), rigs.failed_wings()
    table += [*rows.step_rows(steps), *rows.wing_rows(wings)]
    progress(total, total)
    inertia = float(nominal.outputs["inertia"][0, 0])
    worst = max((entry for _, entry, _ in starts), key=lambda entry: abs(entry.roll_deg))
    shown = {name: rigs.from_entry(release, worst, name) for name in rigs.FORMULATIONS}
    return Report(
        findings.all_of(nominal, means, table),
        drawings(nominal, shown, table, steps, avoidance.shown(before, nominal.scenario), wings),
        table_of(table),
        total,
        REMARKS,
        avoidance.grids(nominal.scenario, inertia, table),
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
