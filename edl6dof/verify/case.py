"""Building blocks of check cases: the shipped scenario stripped down by overrides, flights from a given
state, measurements in them, and the bench on which a case flies, compares and plots.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.scenario import records
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import Flight, fly
from edl6dof.sim.loop import prepare
from edl6dof.sim.outcome import OUTCOMES

SCENARIO = "tianwen1"


def given(place: str, **values: Any) -> tuple[str, ...]:
    """Overrides of some values below a dotted path."""
    return tuple(f"{place}.{name}={value}" for name, value in values.items())


#: No flight software, wind, ground, rotation of the planet.
BARE = (
    *("sensors.set=perfect", "mission.phases=[]", "wind.model=none", "terrain.model=none"),
    *given("planet", rotation_rate_rad_s=0, flattening=0, areoid="''"),
    "simulation.step_s=0.01",
)
VACUUM = ("atmosphere.model=none", "vehicle.aero.model=none")
WEIGHTLESS = ("planet.gravity.model=none",)
#: A planet so large that gravity is 3.72 m/s2 straight down within 1e-5 over the few kilometres of a case.
FLAT = ("planet.equatorial_radius_m=1e9", *given("planet.gravity", model="central", mu_m3_s2=3.72e18))
#: An atmosphere of the same density everywhere.
UNIFORM = ("atmosphere.model=exponential", "atmosphere.exponential.scale_height_m=1e15")
#: No part ever leaves and no propellant: one rigid body with the mass properties of the entry vehicle.
ONE_BODY = tuple(
    f"vehicle.{body}.{value}"
    for body in ("parts.heat_shield", "parts.backshell", "parts.parachute_pack", "tanks.main")
    for value in ("mass_kg=0", "inertia_kg_m2=[0, 0, 0]")
)
#: Nothing ends the flight but the time limit.
ENDLESS = ("limits.body_rate_deg_s=1e6", "limits.total_alpha_deg=181")
#: One rigid body on which nothing acts.
FREE = (*BARE, *VACUUM, *WEIGHTLESS, *ONE_BODY, *ENDLESS)
NO_RATE = "initial.rate_deg_s=[0, 0, 0]"
#: The body points along its velocity.
ALIGNED = ("initial.alpha_deg=0", "initial.beta_deg=0", "initial.bank_deg=0")


class NotInstalledError(RuntimeError):
    """A check case lacks its reference data."""


@dataclass(frozen=True)
class Result:
    """One comparison: the error found against its tolerance, both in ``unit``.

    Attributes:
        quantity: what is compared.
        verifies: the model or method that the comparison proves.
        source: where the expected value comes from, independent of the simulator.
        why: reason for the size of the tolerance.
    """

    quantity: str
    error: float
    tolerance: float
    unit: str = "-"
    verifies: str = ""
    source: str = ""
    why: str = ""

    @property
    def passed(self) -> bool:
        """True if the error is within the tolerance; an error that is not a number is not."""
        return bool(self.error <= self.tolerance)


@dataclass(frozen=True, repr=False)
class Report:
    """Comparisons of one case, and its plot if it has one; name and time are those of its run.

    Attributes:
        note: why the case was skipped or broke; empty otherwise.
        skipped: True if the case cannot run on this installation, which does not count as a failure.
    """

    results: Sequence[Result] = ()
    history: Figure | None = None
    name: str = ""
    seconds: float = 0.0
    note: str = ""
    skipped: bool = False

    def __repr__(self) -> str:
        outcome = "skipped" if self.skipped else "within tolerance" if self.passed else "FAILED"
        return f"<Report {self.name}: {len(self.results)} comparisons, {outcome}>"

    @property
    def passed(self) -> bool:
        """True if every comparison is within its tolerance; a case without comparisons has not passed."""
        return self.skipped or (bool(self.results) and all(result.passed for result in self.results))

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; an error that is not finite becomes null."""
        rows = [
            {**vars(one), "error": float(one.error) if isfinite(one.error) else None, "passed": one.passed}
            for one in self.results
        ]
        state = {"passed": self.passed, "skipped": self.skipped, "note": self.note}
        return {"case": self.name, **state, "seconds": round(self.seconds, 3), "results": rows}


def largest(values: Any) -> float:
    """Largest magnitude of some numbers."""
    return float(np.max(np.abs(values)))


def doing(*events: tuple[str, str, float]) -> tuple[str, ...]:
    """Overrides for a mission that has events only, each (action, component, flight time in s)."""
    rows = (
        f"{{name: event_{k}, action: {action}, component: {component}, "
        f"when: {{quantity: time_s, crosses: above, value: {t - 1e-6!r}}}}}"
        for k, (action, component, t) in enumerate(events)
    )
    phases = f"mission.phases=[{{name: events, events: [{', '.join(rows)}]}}]"
    return phases, "flight_software.check_out.thrusters=[]"


def scenes(overrides: Sequence[str], planted: Sequence[str] = ()) -> tuple[Scenario, LoadedScenario]:
    """Return the scenario of the expected values, and the scenario to fly.

    Args:
        overrides: ``PATH=VALUE`` texts that both scenarios have.
        planted: further overrides of the flown scenario alone. They are deliberate errors, with which tests
            prove that a case fails if the simulator is wrong; empty otherwise.
    """
    return load_scenario(SCENARIO, overrides).scenario, load_scenario(SCENARIO, [*overrides, *planted])


class Bench:
    """One run of a check case.

    Attributes:
        planted: overrides of the flown scenarios alone, see :func:`scenes`.
        results: comparisons so far.
        history: plot, if the case has one.
    """

    def __init__(self, planted: Sequence[str] = ()) -> None:
        self.planted, self.results = planted, list[Result]()
        self.history: Figure | None = None

    def scenes(self, overrides: Sequence[str]) -> tuple[Scenario, LoadedScenario]:
        """Return the scenario of the expected values, and the one to fly."""
        return scenes(overrides, self.planted)

    def flown(self, overrides: Sequence[str], ends: str = "time limit") -> tuple[Scenario, Flight]:
        """Return the scenario of the expected values, and the flight to the end called ``ends``."""
        nominal, loaded = self.scenes(overrides)
        return nominal, to_the_end(loaded, ends=ends)

    def compare(self, quantity: str, error: float, tolerance: float, *about: str, **named: str) -> None:
        """Note a comparison; ``about``: unit, verifies, source and why of :class:`Result`."""
        self.results.append(Result(quantity, error, tolerance, *about, **named))

    def plot(self, title: str, x: str, y: str, at: np.ndarray, flown: np.ndarray, known: np.ndarray) -> None:
        """Plot what was flown ``at`` x, and over it, thin and dashed, what was expected (``known``)."""
        expected = Trace(at, known, "expected", dash="dash", width=1.2, border=True)
        panel = Panel(Axis(x), Axis(y), [Trace(at, flown, "flown", width=3.0), expected])
        self.history = Figure("history", title, [panel])


def to_the_end(loaded: LoadedScenario, start: State | None = None, ends: str = "time limit") -> Flight:
    """Fly, from ``start`` if it is given, to the end called ``ends``.

    Raises:
        RuntimeError: the flight ended otherwise, so that the case proves nothing.
    """
    flight = fly(loaded, start=start)
    if OUTCOMES[flight.code] != ends:
        raise RuntimeError(f"the flight ended with {flight.outcome!r} at t = {flight.time_s:.2f} s")
    return flight


def state_of(loaded: LoadedScenario, change: Callable[[Any, Any], None] = lambda plant, fsw: None) -> State:
    """The initial state after ``change(plant, fsw)`` of its records, mass properties made consistent."""
    case = records.build_case(loaded.truth, records.build_tables(loaded.truth))
    plant = records.initial_plant(loaded.truth, case)
    fsw = records.initial_fsw(records.build_onboard(loaded.scenario))
    change(plant[0], fsw[0])
    prepare(case, plant)
    return State(0, plant, records.initial_peaks(), records.initial_sensors(), fsw, "")


def records_of(loaded: LoadedScenario) -> tuple[np.void, np.void]:
    """Case and tables of the flown scenario."""
    tables = records.build_tables(loaded.truth)
    return records.build_case(loaded.truth, tables)[0], tables[0]


def vectors(flight: Flight, stem: str, suffix: str, axes: str = "xyz") -> np.ndarray:
    """Columns ``truth.<stem>_<axis>_<suffix>`` of the telemetry, shape (rows, axes)."""
    end = f"_{suffix}" if suffix else ""
    return np.stack([flight.telemetry[f"truth.{stem}_{axis}{end}"] for axis in axes], axis=1)


def fit(t: np.ndarray, y: np.ndarray, guess: complex) -> tuple[complex, float]:
    """Fit a free oscillation: its eigenvalue sigma + i omega (1/s) and its middle.  The guess of the
    eigenvalue must be good to a tenth of a cycle over the record.
    """
    size = float(np.ptp(y))

    def amplitudes(sigma: float, omega: float) -> tuple[np.ndarray, np.ndarray]:
        grow = np.exp(sigma * t)
        columns = np.stack([grow * np.cos(omega * t), grow * np.sin(omega * t), np.ones_like(t)], axis=1)
        return columns, np.linalg.lstsq(columns, y, rcond=None)[0]

    def misfit(x: np.ndarray) -> np.ndarray:
        columns, factors = amplitudes(*x)
        return (columns @ factors - y) / size

    start, tight = [guess.real, guess.imag], dict.fromkeys(("xtol", "ftol", "gtol"), 1e-14)
    found = least_squares(misfit, start, x_scale=abs(guess), **tight)
    return complex(*found.x), float(amplitudes(*found.x)[1][2])
