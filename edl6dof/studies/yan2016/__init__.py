"""Yan, Sun & Guo 2016, section 3: finite-time against proportional-derivative drag tracking, both with the
disturbance observer.

The flight-path rate is disturbed by 0.01 sin(t) rad/s, as printed.  Lift makes 0.0107 rad/s at the most, so
no law can cancel that; the comparison is repeated under a disturbance that lift can cancel for most of the
flight, and with other gains, since the paper prints none.  It says that the initial state deviates but not by
how much: both laws fly from all eight corners of a box.  Errors are those against the undisturbed nominal
flight at equal time, as in the paper's figures.
"""

from __future__ import annotations

from edl6dof.campaign.design.variants import scenario_of
from edl6dof.campaign.executor import fly_cases
from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import fly
from edl6dof.studies.study import Progress, Report, Study
from edl6dof.studies.yan2016.drawings import drawings
from edl6dof.studies.yan2016.experiments import CORNERS, EXPERIMENTS, LAWS, PRINTED, case, cases
from edl6dof.studies.yan2016.findings import findings
from edl6dof.studies.yan2016.flights import figures

SCENARIO = "yan2016"
RUNS = len(EXPERIMENTS) * len(LAWS) * len(CORNERS)
REMARKS = (
    "Gains are not printed: both laws have k_1 = k_P = 0.25 1/s2 and k_2 = k_D = 0.8 1/s unless another is "
    "named, the observer 60 1/s.",
    "Errors are means over eight corners of +-500 m, +-25 m/s, +-0.1 deg at entry, against the nominal at "
    "equal time.",
)


def run(runs: int, progress: Progress) -> Report:
    """Fly the nominal, both laws from every corner in every experiment, and one corner in full for the
    figures; ``runs`` is fixed.
    """
    loaded, flown = load_scenario(SCENARIO), cases()
    nominal = fly(loaded)
    table = fly_cases(
        loaded,
        flown,
        collect=lambda flight: figures(flight, nominal),
        progress=lambda done, row: progress(done, len(flown)),
    )
    shown = {
        law: fly(scenario_of(load_scenario(SCENARIO), case(0, PRINTED, law, CORNERS[0]))) for law in LAWS
    }
    exponent = loaded.scenario.flight_software.guidance.entry.ftc_dob.exponent
    return Report(findings(table, nominal, exponent), drawings(nominal, shown), table, len(table), REMARKS)


STUDY = Study(
    SCENARIO,
    "Finite-time drag tracking against a sinusoidal disturbance",
    "Yan, Sun & Guo 2016",
    run,
    runs=RUNS,
    quick_runs=RUNS,
)
