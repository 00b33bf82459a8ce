"""The paper's claims as ratios that must not exceed one, and what has to exceed them."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_continuous_are

from edl6dof.fsw.guidance.entry.laws.hinf import feedback, riccati
from edl6dof.studies.lu_bayard.drag_model import Adapted, Design
from edl6dof.studies.lu_bayard.flights import Flown
from edl6dof.studies.lu_bayard.settings import START_ERROR
from edl6dof.studies.lu_bayard.theorem import THETA
from edl6dof.studies.lu_bayard.trials import BANKS, ERRORS, FREE, LIMITED, SETTINGS, Trial
from edl6dof.studies.study import Finding, Grid

LIMIT = "the theorem has no limit of u; with free lift it is kept"
NO_LAW = "nothing tracks: the bound is one that can be broken"


def trial_grid(trials: tuple[Trial, ...]) -> Grid:
    """Ratios: a row for settings and errors, a column for what steers."""
    ways = (FREE, LIMITED, *BANKS)
    ratio = {(trial.settings, trial.errors, trial.steering): trial.ratio for trial in trials}
    rows: tuple[tuple[str | float, ...], ...] = tuple(
        (f"{settings}, {errors}", *(ratio[settings, errors, way] for way in ways))
        for settings in SETTINGS
        for errors in ERRORS
    )
    return Grid(
        "Error energy over lambda^2 int w^2 + epsilon + z(0)'P z(0)", ("settings, error", *ways), rows
    )


def flight_grid(flights: dict[str, Flown]) -> Grid:
    """The flights of the simulator, energies in m2/s3."""
    heads = ("flight", "error energy", "lambda^2 int w^2", "at start", "over bound", "bank at limit %")
    rows = tuple(
        (
            name,
            flight.response.error_energy,
            flight.response.disturbance_energy(flight.design),
            float(flight.response.state_energy[0]) + flight.design.energy,
            flight.response.over_bound(flight.design),
            100.0 * flight.at_limit,
        )
        for name, flight in flights.items()
    )
    return Grid("Flights with the limits of the bank angle", heads, rows)


def riccati_findings(design: Design) -> tuple[Finding, ...]:
    """The closed form beside scipy, and the frequency response."""
    p11, p12, p22 = riccati(design.gain, design.weight)
    a, b, c = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
    oracle = solve_continuous_are(a, np.hstack([b, b]), c.T @ c, np.diag([-(design.gain**2), design.weight]))
    off = np.max(np.abs(np.array([[p11, p12], [p12, p22]]) / oracle - 1.0))
    f = np.array([feedback(design.gain, design.weight)])
    frequencies = np.geomspace(1e-4, 10.0, 2000)
    peak = max(abs((c @ np.linalg.solve(1j * w * np.eye(2) - a - b @ f, b))[0, 0]) for w in frequencies)
    return (
        Finding("Riccati solution against scipy's", "", float(off), note="largest relative difference"),
        Finding("peak gain from disturbance to error over lambda", "", float(peak / design.gain), 1.0, "<="),
    )


def theorem_findings(design: Design, responses: dict[str, Adapted], fixed: Adapted) -> tuple[Finding, ...]:
    """Constant theta, w a given function of time."""
    storage = responses["w = 0"].storage(design, THETA)
    return (
        *(
            Finding(f"design model, {name}: error energy over its bound", "", r.over_bound(design), 1.0, "<=")
            for name, r in responses.items()
        ),
        Finding(
            "design model, w = 0: largest storage W over W(0)",
            "",
            float(storage.max() / storage[0]),
            1.0,
            "<=",
        ),
        Finding(
            "design model, w = 0: |e| at the end",
            "m/s2",
            responses["w = 0"].settled_error(),
            note=f"from {START_ERROR:g}; tends to 0",
        ),
        Finding("the same without adaptation", "m/s2", fixed.settled_error(), note="a wrong theta stays"),
    )


def trial_findings(trials: tuple[Trial, ...]) -> tuple[Finding, ...]:
    """The claim for what keeps it, at its largest ratio; and at its least for what must break it."""
    what = "error energy over its bound"
    return (
        *(
            Finding(f"{name}, free lift: largest {what}", "", max(_ratios(trials, FREE, name)), 1.0, "<=")
            for name in SETTINGS
        ),
        Finding(
            "free lift: largest |u| over L/D, flown",
            "",
            max(float(np.abs(t.effort).max()) for t in trials if (t.settings, t.steering) == ("flown", FREE)),
            note="1 is all the vehicle has",
        ),
        Finding(f"own lift: least {what}", "", min(_ratios(trials, LIMITED)), 1.0, "<=", why=LIMIT),
        *(
            Finding(f"constant {bank}: least {what}", "", min(_ratios(trials, bank)), 1.0, "<=", why=NO_LAW)
            for bank in BANKS
        ),
    )


def _ratios(trials: tuple[Trial, ...], steering: str, settings: str | None = None) -> list[float]:
    return [t.ratio for t in trials if t.steering == steering and settings in (None, t.settings)]


def flight_findings(flights: dict[str, Flown]) -> tuple[Finding, ...]:
    """Each flight against the bound."""
    return tuple(
        Finding(
            f"flight, {name}: error energy over its bound",
            "",
            flight.response.over_bound(flight.design),
            1.0,
            "<=",
            why=NO_LAW if name.startswith("bank") else LIMIT,
        )
        for name, flight in flights.items()
    )
