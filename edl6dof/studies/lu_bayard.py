"""Lu & Bayard: drag-velocity tracking under adaptive H-infinity control; the claims of section 3 put to
numbers.

The paper prints no vehicle, no entry and no run.  Vehicle and entry are those of Wu, Cui & Cui 2013, an
MSL-class point mass, with estimates of its limits.  The claim is that the energy of the drag error stays
below lambda^2 times that of any disturbance, plus a part of the initial state:

    int e^2 <= lambda^2 int w^2 + epsilon + z(0)' P z(0).

The claim is tested on the equations of motion 2 to 4 with given errors of density, wind and lift, which
determine w: with free lift, as in the paper, and with the lift that the vehicle has; then in flight.  Two
constant bank angles have to break it.  The controller is the kernel that flies; its theorem with constant
theta, its Riccati solution and the range along the profile are tested in tests/unit/fsw.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from math import asin, cos, exp, inf, log, pi, radians, sin
from typing import Any, NamedTuple

import numpy as np

import edl6dof
from edl6dof import LoadedScenario
from edl6dof.config.base import stated
from edl6dof.fsw.guidance.entry.drag_dynamics import uncertain_drag
from edl6dof.fsw.guidance.entry.drag_velocity import path_sine, profile_drag
from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import MEMORY, begin, goal_rates, riccati, track
from edl6dof.interface.roles import LIFT
from edl6dof.scenario.records import build_onboard
from edl6dof.sim.flight import Flight
from edl6dof.studies.frame import Curve, Finding, Grid, Panel, Report, Session, Study

SCENARIO = "wu2013"
ENTRY = "flight_software.guidance.entry"
#: Changes of the scenario; limits of the vehicle are estimates.
VEHICLE = (
    f"{ENTRY}.law=adaptive_hinf",
    f"{ENTRY}.limits={{heat_rate_w_cm2: 100.0, nose_radius_m: 1.1, "
    "load_g0: 15.0, dynamic_pressure_pa: 18000.0}",
    f"{ENTRY}.tracking.update=false",
)
#: The paper prints rho = 1 and lambda > 1, no number of either lambda or epsilon.
AS_PRINTED = (
    *VEHICLE,
    f"{ENTRY}.adaptive_hinf={{settings: as_printed, start_drag_m_s2: 7.0, disturbance_gain: 2.0, "
    "adaptation_energy: 20.0}",
)
FLOWN = (
    *VEHICLE,
    f"{ENTRY}.adaptive_hinf={{start_drag_m_s2: 7.0, disturbance_gain: 40.0, control_weight: 625.0, "
    "adaptation_energy: 20.0}",
)
SETTINGS = {"as printed": AS_PRINTED, "flown": FLOWN}
#: Drag error (m/s2) at the start of an integration.
START_ERROR = 2.0
#: Steering of a trial, in the order of the columns; constant bank angles in deg.
FREE, LIMITED = "law, free lift", "law, own lift"
BANKS = {"bank 20 deg": 20.0, "bank 100 deg": 100.0}
_PATH = "point_mass.disturbance"
#: Flights: settings, and true values that the flight computer does not know.
FLIGHTS: dict[str, tuple[tuple[str, ...], dict[str, float]]] = {
    "flown": (FLOWN, {}),
    "flown, lift 10 % low": (FLOWN, {"vehicle.aero.lift_drag.lift_to_drag": 0.216}),
    "flown, density 10 % high": (FLOWN, {"atmosphere.density_factor": 1.1}),
    "flown, path disturbed": (FLOWN, {f"{_PATH}.amplitude_rad_s": 0.0005, f"{_PATH}.frequency_rad_s": 0.3}),
    "as printed": (AS_PRINTED, {}),
    **{
        name: ((*FLOWN, f"{ENTRY}.law=constant_bank", f"{ENTRY}.constant_bank.bank_deg={bank:g}"), {})
        for name, bank in BANKS.items()
    },
}
REMARKS = (
    "as printed: rho = 1, lambda = 2 (the print says above 1) and epsilon = 20 m2/s3; flown: rho = 625, "
    "lambda = 40.  As printed the drag loop is faster than any capsule banks.",
    "w is made of the errors given: a wave of ln(density) over 40 km, a head wind growing with height, L/D; "
    "it is formed from drag and speed as flown and does not know the error.",
    "own lift: |u| is at most L/D.  The three segments of the profile ask for many times that at their "
    "joints, so the bound is broken though the law tracks.",
)


def run(session: Session) -> Report:
    """Test the claim on the equations of motion, and in flight."""
    session.total = COUNT
    trials = [trial for settings in SETTINGS for trial in _trials(settings, session)]
    flights: Flights = {}
    for name, (overrides, truth) in FLIGHTS.items():
        flights[name] = measured(edl6dof.fly(SCENARIO, [*overrides, f"truth={json.dumps(truth)}"]))
        session.step()
    ratios = {f"{t.settings}, {t.errors}, {t.steering}": t.response.over_bound for t in trials}
    ratios |= {f"flight, {name}": response.over_bound for name, (response, _) in flights.items()}
    rows = [{"case": case, "error_over_bound": ratio} for case, ratio in ratios.items()]
    findings = list(_of_trials(trials))
    for name, (response, _) in flights.items():
        label, why = f"flight, {name}: error energy over its bound", NO_LAW if name in BANKS else LIMIT
        findings.append(Finding(label, "", response.over_bound, 1.0, "<=", why=why))
    grids = [_trial_grid(trials), _flight_grid(flights)]
    return Report(findings, rows, COUNT, grids, REMARKS, _pictures(trials, flights))


# ---- the law, and what the theorem allows --------------------------------------------------------------


class Design(NamedTuple):
    """Settings of the controller: lambda (s2), rho (s4) and epsilon (m2/s3) of the law; and its model of the
    planet: gravity (m/s2), radius (m) and scale height (m) of the reference sphere.
    """

    gain: float
    weight: float
    energy: float
    gravity: float
    radius: float
    scale_height: float

    @classmethod
    def of(cls, onboard: np.ndarray) -> Design:
        """Settings of the law in flight; the atmosphere on board is exponential."""
        own, air = onboard[0]["guidance"]["entry"]["adaptive_hinf"], onboard[0]["atmosphere"]
        law = (own[name] for name in ("disturbance_gain", "control_weight", "adaptation_energy"))
        radius, mu = (onboard[0]["planet"][name] for name in ("equatorial_radius", "mu"))
        scale_height = -air["spacing"] / (air["ln_density"][1] - air["ln_density"][0])
        return cls(*map(float, (*law, mu / radius**2, radius, scale_height)))

    def dynamics(self, drag: float, rate: float, speed: float) -> Any:
        """D'' at this state: its known part, the regressor of theta, and the factor of u."""
        return uncertain_drag(drag, rate, speed, self.gravity, self.radius, scale_height=self.scale_height)


@dataclass(frozen=True)
class Response:
    """One integration or flight, shape (rows,): time (s), drag error (m/s2), its rate (m/s3) and w (m/s4)."""

    design: Design
    t: np.ndarray
    error: np.ndarray
    rate: np.ndarray
    disturbance: np.ndarray

    @property
    def error_energy(self) -> float:
        """Integral of e^2, m2/s3."""
        return float(np.trapezoid(self.error**2, self.t))

    @property
    def disturbance_energy(self) -> float:
        """lambda^2 int w^2, m2/s3."""
        return float(self.design.gain**2 * np.trapezoid(self.disturbance**2, self.t))

    @property
    def start_energy(self) -> float:
        """z(0)' P z(0), m2/s3."""
        p11, p12, p22 = riccati(self.design.gain, self.design.weight)
        error, rate = float(self.error[0]), float(self.rate[0])
        return p11 * (error * error) + 2.0 * p12 * error * rate + p22 * (rate * rate)

    @property
    def over_bound(self) -> float:
        """Error energy over its bound, lambda^2 int w^2 + epsilon + z(0)' P z(0)."""
        return self.error_energy / (self.disturbance_energy + self.design.energy + self.start_energy)


# ---- the equations of motion with errors of air and lift -----------------------------------------------

#: Time (s) from call to call of the law, and rows after which a trial that does not slow down is given up.
CALL_S, MOST_ROWS = 0.1, 6000
#: Height (m) of one wave of the density, and below which a wind grows with height; half the time (s) over
#: which a rate of drag is measured.
WAVE_M, _NUDGE_S = 40e3, 1e-3
#: (height, speed, flight-path angle): m, m/s, rad.
State = tuple[float, float, float]
NAV = np.dtype([("flight_path_angle", "f8"), ("gravity", "f8"), ("speed", "f8"), ("radius", "f8")])


class Errors(NamedTuple):
    """Errors that the law does not know: amplitude of a wave of ln(density) over height, head wind (m/s) at
    the height ``WAVE_M`` and in proportion below, relative error of L/D.
    """

    density: float = 0.0
    wind_m_s: float = 0.0
    lift: float = 0.0

    def excess(self, height: float, speed: float) -> float:
        """ln(rho / rho_model) + 2 ln(V_air / V)."""
        air = 1.0 + self.wind_m_s * height / WAVE_M / speed
        return self.density * sin(2.0 * pi * height / WAVE_M) + 2.0 * log(air)


ERRORS = {
    "no error": Errors(),
    "density +-5 %": Errors(density=0.05),
    "head wind 30 m/s": Errors(wind_m_s=30.0),
    "lift 10 % low": Errors(lift=-0.1),
    "all three": Errors(0.05, 30.0, -0.1),
}
#: Trials and flights.
COUNT = len(SETTINGS) * len(ERRORS) * (2 + len(BANKS)) + len(FLIGHTS)


class Motion:
    """The point mass in air with given errors, and the law with its planned drag profile."""

    def __init__(self, loaded: LoadedScenario, errors: Errors):
        self.record, self.errors = build_onboard(loaded.scenario)[0], errors
        self.design = Design.of(np.array([self.record]))
        self.law = self.record["guidance"]["entry"]["adaptive_hinf"]
        self.profile, vehicle = self.record["plan"]["adaptive_hinf"], self.record["vehicle"]
        self.full_lift = float(vehicle["lift_to_drag"])
        self._per_pressure = float(vehicle["drag_area"] / vehicle["entry_mass"])
        self._surface_density = stated(loaded.scenario.atmosphere.exponential).density_kg_m3

    def _gravity(self, height: float) -> float:
        return self.design.gravity * (self.design.radius / (self.design.radius + height)) ** 2

    def _drag(self, height: float, speed: float) -> float:
        density = self._surface_density * exp(-height / self.design.scale_height)
        return 0.5 * density * speed**2 * self._per_pressure * exp(self.errors.excess(height, speed))

    def sensed(self, state: State) -> tuple[float, float]:
        """Drag (m/s2) and its rate (m/s3), which the paper takes as measured."""
        height, speed, path = state
        drag, dt = self._drag(height, speed), _NUDGE_S
        climb, speed_rate = speed * sin(path), -drag - self._gravity(height) * sin(path)
        after = self._drag(height + dt * climb, speed + dt * speed_rate)
        return drag, (after - self._drag(height - dt * climb, speed - dt * speed_rate)) / (2.0 * dt)

    def start(self) -> State:
        """The state at the start of the profile, with an error ``START_ERROR`` of drag."""
        design, speed = self.design, float(self.profile["start"])
        goal, slope, _ = profile_drag(self.profile, speed)
        height = 0.0
        for _ in range(20):
            surface = self._drag(height, speed) * exp(height / design.scale_height)
            height = design.scale_height * log(surface / (goal + START_ERROR))
        return height, speed, asin(path_sine(speed, goal, slope, self._gravity(height), design.scale_height))

    def call(self, memory: np.void, state: State, flown: float, dt: float) -> tuple[float, float, float]:
        """Drag error (m/s2), its rate (m/s3), and the law's u after an input ``flown`` for ``dt`` (s)."""
        height, speed, path = state
        drag, rate = self.sensed(state)
        goal, slope, curvature = profile_drag(self.profile, speed)
        nav = np.array([(path, self._gravity(height), speed, self.design.radius + height)], NAV)[0]
        goal_rate, goal_free, goal_per_u = goal_rates(nav, drag, rate, slope, curvature)
        error, error_rate = drag - goal, rate - goal_rate
        dynamics = self.design.dynamics(drag, rate, speed)
        wanted = {"goal_free": goal_free, "goal_per_u": goal_per_u}
        u = track(self.law, memory, dt, flown, error, error_rate=error_rate, dynamics=dynamics, **wanted)
        return error, error_rate, u

    def step(self, state: State, u: float) -> State:
        """The state at the next call with constant input, by RK4 in plain numbers, faster than numpy here."""

        def rates(height: float, speed: float, path: float) -> State:
            drag, gravity = self._drag(height, speed), self._gravity(height)
            turn = (speed / (self.design.radius + height) - gravity / speed) * cos(path)
            lift = drag * u * (1.0 + self.errors.lift)
            return speed * sin(path), -drag - gravity * sin(path), lift / speed + turn

        def ahead(dt: float, by: State) -> State:
            return state[0] + dt * by[0], state[1] + dt * by[1], state[2] + dt * by[2]

        slopes = [rates(*state)]
        for dt in (0.5 * CALL_S, 0.5 * CALL_S, CALL_S):
            slopes.append(rates(*ahead(dt, slopes[-1])))
        x, y, z = (p + 2.0 * (q + r) + s for p, q, r, s in zip(*slopes, strict=True))
        return ahead(CALL_S / 6.0, (x, y, z))


def fly_free(
    motion: Motion, *, limit: float = inf, constant: float | None = None
) -> tuple[Response, np.ndarray]:
    """Integrate along the profile; returns the response and the inputs u = (L/D) cos(bank).

    Args:
        motion: vehicle, air and law.
        limit: largest |u|.
        constant: constant input in place of the law's.
    """
    memory = np.zeros(1, MEMORY)[0]
    begin(motion.law, memory)
    state, u = motion.start(), 0.0
    rows: list[tuple[float, ...]] = []
    while state[1] > float(motion.profile["final"]) and len(rows) < MOST_ROWS:
        drag, _ = motion.sensed(state)
        error, error_rate, wanted = motion.call(memory, state, u, CALL_S if rows else 0.0)
        u = min(max(wanted if constant is None else constant, -limit), limit)
        rows.append((*state[:2], drag, error, error_rate, u))
        state = motion.step(state, u)
    height, speed, drags, error, rate, inputs = np.array(rows).T
    t = CALL_S * np.arange(len(rows))
    excess = np.array([motion.errors.excess(h, v) for h, v in zip(height, speed, strict=True)])
    w = disturbance_of(motion.design, t, drags, speed, excess, motion.errors.lift * inputs)
    return Response(motion.design, t, error, rate, w), inputs


def disturbance_of(design: Design, *columns: np.ndarray) -> np.ndarray:
    """The disturbance w of eq. 12 (m/s4) from errors that are given before the flight, shape (rows,).

    With D = k rho V_air^2 the relative rate of the drag exceeds that of the model by delta = d/dt (ln(rho /
    rho_model) + 2 ln(V_air / V)); that enters D'' as D delta' + (D^2/V) ((V^2 - 4 g H)/(V^2 + 2 g H)) delta,
    and an error of L/D as what it adds to the input, times g2.  The reference drag does not enter.  Source:
    Lu & Bayard, section 2.3; as printed, w lacks V^2 (see :mod:`~edl6dof.fsw.guidance.entry.drag_dynamics`)
    and lift has no error.

    Args:
        design: for gravity, radius and scale height.
        columns: time (s), drag (m/s2), speed (m/s) over the ground, ln(rho / rho_model) + 2 ln(V_air / V),
            and true less believed (L/D) cos(bank), each of shape (rows,).
    """
    t, drag, speed, excess, lift_error = columns
    rate = np.gradient(excess, t)
    potential = design.gravity * design.scale_height
    path = drag**2 / speed * (speed**2 - 4.0 * potential) / (speed**2 + 2.0 * potential)
    per_u = [design.dynamics(d, 0.0, v)[2] for d, v in zip(drag, speed, strict=True)]
    return drag * np.gradient(rate, t) + path * rate + np.array(per_u) * lift_error


class Trial(NamedTuple):
    """Settings, errors, steering, the response, and the inputs over L/D."""

    settings: str
    errors: str
    steering: str
    response: Response
    effort: np.ndarray


def _trials(settings: str, session: Session) -> list[Trial]:
    loaded, found = edl6dof.load(SCENARIO, SETTINGS[settings]), []
    for errors, values in ERRORS.items():
        motion = Motion(loaded, values)
        full = motion.full_lift
        ways: dict[str, dict[str, float]] = {FREE: {}, LIMITED: {"limit": full}}
        ways |= {name: {"constant": full * cos(radians(bank))} for name, bank in BANKS.items()}
        for steering, way in ways.items():
            response, inputs = fly_free(motion, **way)
            found.append(Trial(settings, errors, steering, response, inputs / full))
            session.step()
    return found


LIMIT = "the theorem has no limit of u; with free lift it is kept"
NO_LAW = "nothing tracks: the bound is one that can be broken"


def _of_trials(trials: list[Trial]) -> Iterator[Finding]:
    """Largest ratio of the trials that must meet the claim, and least ratio of those that must break it."""
    what = "error energy over its bound"
    free = [t for t in trials if t.steering == FREE]
    for one in SETTINGS:
        most = max(t.response.over_bound for t in free if t.settings == one)
        yield Finding(f"{one}, free lift: largest {what}", "", most, 1.0, "<=")
    most = max(float(np.abs(t.effort).max()) for t in free if t.settings == "flown")
    yield Finding("free lift: largest |u| over L/D, flown", "", most, note="1 is all the vehicle has")
    broken = [(LIMITED, "own lift", LIMIT), *((one, f"constant {one}", NO_LAW) for one in BANKS)]
    for way, name, why in broken:
        least = min(t.response.over_bound for t in trials if t.steering == way)
        yield Finding(f"{name}: least {what}", "", least, 1.0, "<=", why=why)


def _trial_grid(trials: list[Trial]) -> Grid:
    """Ratios: a line for settings and errors, a column for each steering."""
    lines: dict[str, list[float]] = {}
    for t in trials:
        lines.setdefault(f"{t.settings}, {t.errors}", []).append(t.response.over_bound)
    title = "Error energy over lambda^2 int w^2 + epsilon + z(0)'P z(0)"
    rows = [(name, *ratios) for name, ratios in lines.items()]
    return Grid(title, ("settings, error", FREE, LIMITED, *BANKS), rows)


# ---- flights of the simulator, whose bank angle has limits ---------------------------------------------


#: Response of each flight, and the share of it with the bank angle at a limit.
Flights = dict[str, tuple[Response, float]]


def measured(flight: Flight) -> tuple[Response, float]:
    """Response of a flight at the guidance rate, under the given errors; share of it at a bank limit."""
    software, onboard = flight.scenario.flight_software, build_onboard(flight.scenario)
    entry, every = software.guidance.entry, software.rates.entry_guidance_every
    rows = {name: values[::every] for name, values in flight.telemetry.items()}
    begun = rows["nav.drag_m_s2"] >= entry.adaptive_hinf.start_drag_m_s2
    kept = flight.during(LIFT)[::every] & (np.cumsum(begun) > 0)
    rows = {name: values[kept] for name, values in rows.items()}
    t, speed, drag = rows["t_s"], rows["truth.speed_m_s"], rows["nav.drag_m_s2"]
    design, profile = Design.of(onboard), onboard[0]["plan"]["adaptive_hinf"]
    error = drag - np.array([profile_drag(profile, v)[0] for v in speed])
    air, truth = stated(flight.scenario.atmosphere.exponential), flight.loaded.truth
    model = np.log(air.density_kg_m3) - rows["truth.height_above_areoid_m"] / air.scale_height_m
    wind = 2.0 * np.log(rows["truth.airspeed_m_s"] / speed)
    excess = np.log(rows["truth.density_kg_m3"]) - model + wind
    true, believed = (one.vehicle.aero.lift_drag.lift_to_drag for one in (truth, flight.scenario))
    path = truth.point_mass.disturbance  # of the path rate: it acts like an input
    push = path.amplitude_rad_s * np.sin(path.frequency_rad_s * t)
    lift_error = (true - believed) * np.cos(np.radians(rows["truth.bank_deg"])) + push * speed / drag
    w = disturbance_of(design, t, drag, speed, excess, lift_error)
    bank, limits = np.abs(rows["guide.bank_deg"]), (entry.bank_min_deg, entry.bank_max_deg)
    at_limit = np.min([np.abs(bank - limit) for limit in limits], axis=0) < 0.01
    return Response(design, t, error, np.gradient(error, t), w), float(np.mean(at_limit))


def _flight_grid(flights: Flights) -> Grid:
    """Energies of the flights, m2/s3."""
    heads = ("flight", "error energy", "lambda^2 int w^2", "at start", "over bound", "bank at limit %")
    lines = []
    for name, (one, at_limit) in flights.items():
        start = one.start_energy + one.design.energy
        energies = (one.error_energy, one.disturbance_energy, start, one.over_bound)
        lines.append((name, *energies, 100.0 * at_limit))
    return Grid("Flights with the limits of the bank angle", heads, lines)


def _pictures(trials: list[Trial], flights: Flights) -> dict[str, list[Panel]]:
    """Drag errors of the trials with every error at once, and of the flights under the law."""
    panels: dict[str, list[Curve]] = {FREE: [], LIMITED: [], "flights": []}
    for trial in trials:
        if trial.errors == "all three" and trial.steering in panels:
            panels[trial.steering].append(Curve(trial.response.t, trial.response.error, trial.settings))
    for name, (response, _) in flights.items():
        if name not in BANKS:
            panels["flights"].append(Curve(response.t, response.error, name))
    labels = ("time (s)", "D - D_r (m/s2)")
    return {"drag_errors": [Panel(title, *labels, curves) for title, curves in panels.items()]}


TITLE = "Adaptive H-infinity tracking of a drag-velocity profile"
STUDY = Study("lu_bayard", TITLE, "Lu & Bayard", run, runs=COUNT, quick_runs=COUNT)
