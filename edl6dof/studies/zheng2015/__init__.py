"""Zheng & Cui 2015, section 5: 500 dispersed point-mass entries under the sliding-mode law with disturbance
observer, as printed, and with what the print leaves open or contradicts.

The bank profile of the reference trajectory is not printed (see scenarios/zheng2015.yaml), nor the datum of
its altitudes; the reference radius of the density, 3394.5 km, is the only radius printed beside that of the
entry, and heights here are above it.  With the printed density 0.2 Earth g is met at 44.3 s in place of
42 s, whatever the bank profile, and no three-segment profile ends above 7.5 km.  Raised by 3 km, the
density meets 42 s, and a profile that ends range control at 136 s ends at 9.8 km.
"""

from __future__ import annotations

from edl6dof.campaign.design.variants import scenario_of
from edl6dof.campaign.executor import fly_cases
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import fly
from edl6dof.studies.study import Progress, Report, Study
from edl6dof.studies.zheng2015 import findings
from edl6dof.studies.zheng2015.experiments import ENTRY, SCENARIO, UPDATE, all_cases
from edl6dof.studies.zheng2015.figures import drawings
from edl6dof.studies.zheng2015.tracking import figures, history

REMARKS = (
    "as printed: reference drag planned once, one density factor a flight, 3 sigma 20 %; figures 3 to 5 and "
    "'run shown' are its first run; 'settled' is after the saturation at the beginning.",
    "denser air too: no density error, density raised by 3 km of height so that 0.2 Earth g is met at 42 s, "
    "bank profile 65 to 45 deg so that range control ends at 136 s; the height follows.",
    "as inferred: and the dead band of the bank reversals, not printed, 3.5 km to either side at no speed in "
    "place of 0.4, chosen for the RMS miss, which 2.5 to 3.5 km move between 2.2 and 3.0 km; the shares "
    "follow.",
    "density profile: the 20 % as an error correlated over so many km of height: no reading of it leaves "
    "half of the terminal altitudes within 0.1 km.",
    "flown: as printed, with the outer loop of eq. 12, for which the paper has no method.",
    "A datum of altitudes 3.7 km below the printed radius would meet 9.75 km in the printed air, and leave "
    "42 s and 136 s unexplained.",
)


def run(runs: int, progress: Progress) -> Report:
    """Fly the dispersed entries of every experiment, one of them in full for the figures, and a constant bank
    angle against the bound of eq. 51.
    """
    loaded, cases = load_scenario(SCENARIO), all_cases(runs)
    table = fly_cases(loaded, cases, collect=figures, progress=lambda done, row: progress(done, len(cases)))
    tables = findings.by_experiment(table, runs)
    shown = fly(scenario_of(loaded, cases[0]))
    constant = fly(load_scenario(SCENARIO, [f"{UPDATE}=false", f"{ENTRY}.law=constant_bank"]))
    found = (
        *findings.statistics(tables),
        *findings.tracking(shown, tables["as printed"]),
        *findings.energy_bound(shown, constant),
    )
    drawn = drawings(history(shown), tables)
    return Report(found, drawn, table, len(table), REMARKS, (findings.grid(tables),))


STUDY = Study(
    SCENARIO,
    "Disturbance-observer sliding guidance with input saturation",
    "Zheng & Cui 2015",
    run,
    runs=500,
    quick_runs=40,
    counted=True,
)
