"""The paper's Fig. 1, and the drag errors of the theorem, of the trials and of the flights."""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.guidance.entry.profiles.drag_velocity import profile_drag
from edl6dof.fsw.guidance.entry.profiles.entry_corridor import corridor
from edl6dof.report.figure import Figure, Panel
from edl6dof.studies import plots
from edl6dof.studies.lu_bayard.drag_model import Adapted
from edl6dof.studies.lu_bayard.flights import Flown
from edl6dof.studies.lu_bayard.trials import FREE, LIMITED, Trial


def drawings(
    onboard: np.ndarray,
    responses: dict[str, Adapted],
    fixed: Adapted,
    trials: tuple[Trial, ...],
    flights: dict[str, Flown],
) -> tuple[Figure, ...]:
    """Fig. 1, the design model, the trials with every error at once, and the flights under the law."""
    time, error = "time (s)", "D - D_r (m/s2)"
    names, still = ("C", "C'", "1 - (R/r) cos2", "1 - cos", "sin2"), responses["w = 0"]
    shares = (still.theta - still.theta.min(axis=0)) / np.maximum(np.ptp(still.theta, axis=0), 1e-12)
    estimates = tuple(plots.curve(still.t, share, name) for share, name in zip(shares.T, names, strict=True))
    errors = tuple(plots.curve(r.t, r.error, name) for name, r in responses.items())
    under_law = {name: flight for name, flight in flights.items() if not name.startswith("bank")}
    flown = tuple(plots.curve(f.response.t, f.response.error, name) for name, f in under_law.items())
    banks = tuple(plots.curve(f.response.t, f.bank_deg, name) for name, f in under_law.items())
    return (
        plots.figure("fig1_corridor_and_profile", (_corridor_panel(onboard, flights["flown"]),)),
        plots.figure(
            "design_model",
            (
                plots.panel(
                    "Drag error",
                    time,
                    error,
                    (*errors, plots.reference(fixed.t, fixed.error, "w = 0, theta not adapted")),
                ),
                plots.panel("Estimate of theta, w = 0", time, "share of its travel", estimates),
            ),
        ),
        plots.figure("trials", tuple(_trial_panel(trials, steering) for steering in (FREE, LIMITED))),
        plots.figure(
            "flights",
            (
                plots.panel("Drag error", time, error, flown),
                plots.panel("Bank angle", time, "|bank| (deg)", banks),
            ),
        ),
    )


def _trial_panel(trials: tuple[Trial, ...], steering: str) -> Panel:
    curves = tuple(
        plots.curve(trial.response.t, trial.response.error, trial.settings)
        for trial in trials
        if (trial.errors, trial.steering) == ("all three", steering)
    )
    return plots.panel(f"Drag error, {steering}", "time (s)", "D - D_r (m/s2)", curves)


def _corridor_panel(onboard: np.ndarray, flight: Flown) -> Panel:
    """The paper's Fig. 1, with the bounds and a flight."""
    profile = onboard[0]["plan"]["adaptive_hinf"]
    v = np.linspace(float(profile["final"]), float(profile["start"]), 400)
    bounds = np.array([corridor(onboard[0], x) for x in v]).T
    joints = np.array([float(profile["join"]), float(profile["level"])])
    names = ("heat rate", "load", "dynamic pressure", "equilibrium glide")
    curves = (
        *(plots.curve(v, bound, name) for bound, name in zip(bounds, names, strict=True)),
        plots.reference(v, np.array([profile_drag(profile, x)[0] for x in v]), "profile"),
        plots.dots(joints, np.array([profile_drag(profile, x)[0] for x in joints]), "its joints"),
        plots.curve(flight.speed, flight.drag, "flown"),
    )
    return plots.panel("Entry corridor", "speed (m/s)", "drag (m/s2)", curves, y_range=(0.0, 200.0))
