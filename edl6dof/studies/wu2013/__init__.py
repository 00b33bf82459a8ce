"""Wu, Cui & Cui 2013, section 5: 2000 dispersed point-mass entries with and without the extended high-gain
observer.

The paper as printed comes first: its gains and time scale, measured drag, perfect navigation, and the range
update of section 3.2, every 5 s.  What does not come out so is flown in other ways, to find the cause; the
settings of this software stand apart.  Reference bank, terminal speed, target, heading corridor, period of
the update, limits of the bank angle and start of the observer are not printed; see scenarios/wu2013.yaml.
"""

from __future__ import annotations

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.variants import scenario_of
from edl6dof.campaign.executor import fly_cases
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.sim.flight import Flight, fly
from edl6dof.studies.study import Progress, Report, Study
from edl6dof.studies.wu2013.drawings import drawings
from edl6dof.studies.wu2013.experiments import (
    AS_PRINTED,
    CONTINUOUS,
    ENTRY,
    EXPERIMENTS,
    KEPT,
    LAWS,
    PRINTED,
    cases,
)
from edl6dof.studies.wu2013.findings import findings
from edl6dof.studies.wu2013.flights import figures, history

SCENARIO = "wu2013"
#: Shares of the measured drag that the observer of figure 3 starts from.
STARTS = (0.8, 0.0)
REMARKS = (
    "K = [0.4 0.04] is taken as gains on [rate, error]; as it stands the error is nearly undamped.",
    "The printed observer (0.1 s) makes of an accelerometer's noise, 1.4 mm/s2, a perturbation as large as "
    "what the bank angle can do.",
    "Figure 3 is a flight whose observer starts at 80 % of the drag, figure 4 the first entry.",
)


def run(runs: int, progress: Progress) -> Report:
    """Fly the dispersed entries in every experiment, and some of them in full for the figures."""
    loaded, flown = _loaded(), cases(runs)
    table = fly_cases(loaded, flown, collect=figures, progress=lambda done, row: progress(done, len(flown)))
    places = {
        (experiment.name, law): [
            case.index
            for case in flown
            if (case.label["experiment"], case.label["law"]) == (experiment.name, law)
        ]
        for experiment in EXPERIMENTS
        for law in experiment.laws
    }
    groups = {key: table.take(rows) for key, rows in places.items()}
    starts = {share: history(_nominal(share)) for share in STARTS}
    shown = {
        f"{label}, {experiment.name}": history(
            fly(scenario_of(loaded, flown[places[experiment.name, law][0]]))
        )
        for experiment in (PRINTED, KEPT)
        for law, label in LAWS.items()
    }
    return Report(
        findings(groups, starts), drawings(starts[STARTS[0]], shown, groups), table, len(table), REMARKS
    )


def _loaded() -> LoadedScenario:
    return load_scenario(SCENARIO, AS_PRINTED)


def _nominal(share: float) -> Flight:
    """The nominal entry, its observer started from a share of the drag."""
    belief = {**CONTINUOUS, f"{ENTRY}.ehgo_fl.start_share": share}
    return fly(scenario_of(_loaded(), Case(0, belief=belief)))


STUDY = Study(
    SCENARIO,
    "Extended high-gain observer with feedback linearisation",
    "Wu, Cui & Cui 2013",
    run,
    runs=2000,
    quick_runs=20,
    counted=True,
)
