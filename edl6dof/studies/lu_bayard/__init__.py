"""Lu & Bayard: drag-velocity tracking under adaptive H-infinity control; the claims of section 3 put to
numbers.

The paper prints no vehicle, no entry and no run.  Vehicle and entry are those of Wu, Cui & Cui 2013, an
MSL-class point mass, with estimates for what it stands.  Its claim is that the energy of the drag error stays
below lambda^2 times that of the disturbance and what the start adds, for any disturbance.  It is tried first
in the theorem's own setting (constant theta), then on the equations of motion with given errors of density,
wind and lift, from which w follows, with free lift, as the paper has it, and with the lift that the vehicle
has; last in flight.  Two constant bank angles have to break it.
"""

from __future__ import annotations

import pyarrow as pa

from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_onboard
from edl6dof.studies.lu_bayard import findings
from edl6dof.studies.lu_bayard.figures import drawings
from edl6dof.studies.lu_bayard.flights import FLIGHTS, fly_one
from edl6dof.studies.lu_bayard.profile_range import range_findings
from edl6dof.studies.lu_bayard.settings import FLOWN, SCENARIO, design_of
from edl6dof.studies.lu_bayard.theorem import DISTURBANCES, nothing, respond_along
from edl6dof.studies.lu_bayard.trials import BANKS, ERRORS, SETTINGS, all_trials
from edl6dof.studies.study import Progress, Report, Study

#: Trials and flights.
COUNT = len(SETTINGS) * len(ERRORS) * (2 + len(BANKS)) + len(FLIGHTS)
REMARKS = (
    "as printed: rho = 1, lambda = 2 (the print says above 1) and epsilon = 20 m2/s3; flown: rho = 625, "
    "lambda = 40.  As printed the drag loop is faster than any capsule banks.",
    "w is made of the errors given: a wave of ln(density) over 40 km, a head wind growing with height, L/D; "
    "it is formed from drag and speed as flown and does not know the error.",
    "own lift: |u| is at most L/D.  The three segments of the profile ask for many times that at their "
    "joints, so the bound is broken though the law tracks.",
)


def run(runs: int, progress: Progress) -> Report:
    """Integrate the design model with three disturbances, try the claim, and fly."""
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        progress(done, COUNT)

    loaded = load_scenario(SCENARIO, FLOWN)
    onboard = build_onboard(loaded.scenario)
    design = design_of(onboard)
    responses = {name: respond_along(design, onboard, w) for name, w in DISTURBANCES.items()}
    fixed = respond_along(design, onboard, nothing, adaptive=False)
    trials = all_trials(step)
    flights = {}
    for name, (overrides, truth) in FLIGHTS.items():
        flights[name] = fly_one(overrides, truth)
        step()
    found = (
        *findings.riccati_findings(design),
        *findings.theorem_findings(design, responses, fixed),
        *findings.trial_findings(trials),
        *findings.flight_findings(flights),
        *range_findings(onboard, loaded.scenario.planet.equatorial_radius_m),
    )
    rows = [
        {"case": f"{t.settings}, {t.errors}, {t.steering}", "error_over_bound": t.ratio} for t in trials
    ] + [
        {"case": f"flight, {name}", "error_over_bound": f.response.over_bound(f.design)}
        for name, f in flights.items()
    ]
    return Report(
        found,
        drawings(onboard, responses, fixed, trials, flights),
        pa.Table.from_pylist(rows),
        COUNT,
        REMARKS,
        (findings.trial_grid(trials), findings.flight_grid(flights)),
    )


STUDY = Study(
    "lu_bayard",
    "Adaptive H-infinity tracking of a drag-velocity profile",
    "Lu & Bayard",
    run,
    runs=COUNT,
    quick_runs=COUNT,
)
