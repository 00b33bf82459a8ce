"""Every entry law on the same dispersed entries of seven vehicles, as they come and under nine conditions.

This is an experiment of this simulator and of no paper: all laws fly each vehicle with one plant, one
attitude controller, one reversal logic and the same errors, from entry interface to the mortar.  The miss is
the distance at mortar fire from the point to which entry guidance steers.  Four missions fly in six degrees
of freedom with instruments.  The point masses of three papers get what a vehicle has: a limited bank rate,
and a drag reference that is updated by the range to go.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count
from math import cos, degrees, inf, isfinite, nan, radians, sin
from typing import Any, NamedTuple

import numpy as np

import edl6dof
from edl6dof import Case, LoadedScenario, fly_rows
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import Row
from edl6dof.campaign.statistics import percent, quantile
from edl6dof.config.base import stated
from edl6dof.config.model_paths import value_at
from edl6dof.config.units import G0
from edl6dof.config.wording import counted
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY, OWN_REVERSALS, entry_guidance
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.interface.roles import LIFT
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.sim.flight_state import snapshots_at
from edl6dof.studies.frame import Curve, Finding, Grid, Line, Panel, Report, Session, Study, quickest_us
from edl6dof.studies.samples import (
    Spread,
    column,
    draw,
    kinds,
    mean,
    percentage,
    pick,
    quantile_grid,
    with_quantile,
)
from edl6dof.vehicle.propulsion.rcs import Thruster

ENTRY = "flight_software.guidance.entry"
#: All laws but constant bank, which is no guidance.
LAWS = tuple(name for name in ENTRY_LAWS.names if name != "constant_bank")
#: Dispersed entries for each entry that is flown again under every condition.
_PER_CONDITION = 5
#: Targets of this study: share of the best law's misses that must be within a distance (km), time of a call
#: (us) of a law that predicts by flying ahead, and of any other.
TARGET_SHARE, TARGET_KM, PREDICTOR_CALL_US, CALL_US = 0.99, 2.5, 2000.0, 5.0
PREDICTORS = ("npc", "fnpeg", "stochastic_pc")
REMARKS = (
    "The bounds are this project's own targets; the box is the scenario's limits on Mach, dynamic pressure "
    "and total angle of attack.",
    "The bias is the mean downrange at mortar fire from the aim point. Travel and propellant beyond the "
    "reversals leave out the turns from one side to the other, and starting and stopping their roll.",
    "bank_profile flies the planned bank open loop: what the conditions do without guidance.",
)
Values = dict[str, Any]
#: Time (us) of a call by vehicle and law.
Calls = dict[tuple[str, str], float]


def run(session: Session) -> Report:
    """Fly dispersed entries and conditions by all laws; fly entries that all laws missed with lift up."""
    flights, rows = session.flights, []
    calls: Calls = {}
    again = max(flights // _PER_CONDITION, 1) * (len(CONDITIONS) - 1)
    session.total = (flights + again) * len(VEHICLES) * len(session.parts)
    for vehicle in VEHICLES:
        truths = entries(vehicle, flights, session.seed)
        for law in session.parts:
            loaded = with_law(vehicle, law)
            label = {"vehicle": vehicle.name, "law": law}
            rows += session.fly(loaded, cases(loaded.scenario, truths, label), of_flight)
            calls[vehicle.name, law] = call_time(loaded)
    dispersed, far = pick(rows, condition=DISPERSED), list[Row]()
    for vehicle in VEHICLES:
        far += lift_up(vehicle, dispersed, entries(vehicle, flights, session.seed))
    beyond = {vehicle.name: out_of_reach(pick(far, vehicle=vehicle.name)) for vehicle in VEHICLES}
    found, grids = list(findings(rows, calls, beyond)), list(_grids(rows, calls))
    return Report(found, [*rows, *far], session.total + len(far), grids, REMARKS, _pictures(dispersed))


# ---- vehicles and laws ---------------------------------------------------------------------------------


class Vehicle(NamedTuple):
    """An entry: its scenario, added ``--set`` texts, and the campaign of its dispersions, if any."""

    name: str
    changes: tuple[str, ...] = ()
    dispersions: str = ""

    def load(self, *more: str) -> LoadedScenario:
        """Return the scenario with its changes and ``more`` (``PATH=VALUE``), which ends at mortar fire."""
        return edl6dof.load(self.name, ["mission.goal=deployment", *self.changes, *more])


#: Changes with which the point mass of a paper flies like a vehicle.
_AS_A_VEHICLE = (
    "point_mass.bank_response=rate_limited",
    "point_mass.bank_rate_deg_s=20",
    f"{ENTRY}.bank_rate_deg_s=20",
    f"{ENTRY}.tracking.update=true",
)
#: Viking 1 flew lift up to the end of its reach.  With guidance its site lies 40 km nearer, so that it
#: is within reach, and it banks at 20 deg/s; the gains of the slow laws are those of tianwen1.
_GUIDED = (
    "mission.phases.1.guidance=entry",
    "terrain.site_latitude_deg=22.13",
    "terrain.site_longitude_deg=311.42",
    "flight_software.control.bank_to_steer.bank.rate_deg_s=20",
    f"{ENTRY}.bank_rate_deg_s=20",
    f"{ENTRY}.heading.speed_m_s=350",
    f"{ENTRY}.align_speed_m_s=330",
    f"{ENTRY}.final_speed_m_s=250",
    f"{ENTRY}.dob_sliding={{filter_time_s: 2.0, error_gain: 0.06}}",
    f"{ENTRY}.ftc_dob={{error_gain: 0.05, rate_gain: 0.4}}",
    f"{ENTRY}.pd_dob={{error_gain: 0.01, rate_gain: 0.18}}",
)
VEHICLES = (
    *(Vehicle(name, dispersions=f"{name}_mc") for name in ("tianwen1", "msl", "mars2020")),
    Vehicle("viking1", _GUIDED, "viking1_mc"),
    *(Vehicle(name, _AS_A_VEHICLE) for name in ("zheng2015", "wu2013", "yan2016")),
)


def with_law(vehicle: Vehicle, law: str) -> LoadedScenario:
    """The entry flown by a law; the open-loop law flies the planned bank angle as a function of speed."""
    planned = vehicle.load(f"{ENTRY}.reference_bank.fit_range=true")
    onboard, entry = build_records(planned).onboard[0], planned.scenario.flight_software.guidance.entry
    speeds = np.linspace(entry.align_speed_m_s + 1.0, planned.scenario.initial.speed, 16)
    shift = float(onboard["reference"]["shift"])
    banks = [degrees(reference_bank(onboard, shift, v)) for v in speeds]
    points = [{"at": round(float(v), 3), "bank_deg": bank} for v, bank in zip(speeds, banks, strict=True)]
    own = [f"{ENTRY}.law={law}", f"{ENTRY}.bank_profile={json.dumps({'points': points})}"]
    if law in OWN_REVERSALS:
        own.append(f"{ENTRY}.reversal.logic=own_sign")
    return vehicle.load("simulation.log_every=5", *own)


def entries(vehicle: Vehicle, flights: int, seed: int) -> list[Values]:
    """True values of dispersed entries: those of a campaign, or of a point mass those of ``tianwen1_mc`` that
    it has.  Each flight also has its own waves of density and gusts.
    """
    if vehicle.dispersions:
        plan = load_plan(vehicle.dispersions, cases=flights, seed=seed)
        return [{**case.truth, **WAVES_AND_GUSTS} for case in plan.cases()]
    scenario, spreads = vehicle.load().scenario, list[Spread]()
    for path, width, share in _POINT_MASS:
        nominal = value_at(scenario, path)
        spreads.append(Spread(path, nominal, width * nominal if share else width))
    return [{**truth, **WAVES_AND_GUSTS} for truth in draw(spreads, flights, seed)]


#: Dispersed parameters of a point mass: path, three sigma, and True if it is a share of the nominal value.
_POINT_MASS = (
    ("initial.flight_path_angle_deg", 0.3, False),
    ("initial.speed_m_s", 6.0, False),
    ("initial.latitude_deg", 0.1, False),
    ("initial.longitude_deg", 0.1, False),
    ("initial.azimuth_deg", 0.1, False),
    ("vehicle.mass.entry_kg", 0.012, True),
    ("vehicle.aero.lift_drag.lift_to_drag", 0.10, True),
    ("atmosphere.density_factor", 0.20, False),
)

# ---- conditions ----------------------------------------------------------------------------------------

WAVES_AND_GUSTS: Values = {"atmosphere.perturbation.enabled": True, "wind.gust.enabled": True}
_WIND_M_S = 40.0
#: Values by dotted path, of the scenario and the true values of a dispersed entry.
Change = Callable[[Scenario, Values], Values]


def _is_rigid(scenario: Scenario) -> bool:
    return scenario.dynamics == "six_dof"


def _scaled(path: str, factor: float) -> Change:
    return lambda scenario, truth: {path: factor * truth.get(path, value_at(scenario, path))}


def less_lift(scenario: Scenario, truth: Values) -> Values:
    """A lift-to-drag ratio a tenth lower; for a capsule, a centre of mass with an offset a sixth smaller."""
    if not _is_rigid(scenario):
        return _scaled("vehicle.aero.lift_drag.lift_to_drag", 0.9)(scenario, truth)
    path = "vehicle.mass.entry_centre_m.2"
    nominal = value_at(scenario, path)
    return {path: truth.get(path, nominal) - nominal / 6.0}


def wind(turn_deg: float, speed: float = _WIND_M_S) -> Change:
    """The same wind at all altitudes, which the flight computer does not expect: it blows towards the course
    of the entry plus an angle, at ``speed`` (m/s).
    """

    def change(scenario: Scenario, truth: Values) -> Values:
        towards = radians(value_at(scenario, "initial.azimuth_deg") + turn_deg)
        north, east = speed * cos(towards), speed * sin(towards)
        return {"wind.model": "constant", "wind.constant.north_m_s": north, "wind.constant.east_m_s": east}

    return change


def doubled_entry_errors(scenario: Scenario, truth: Values) -> Values:
    """Twice the error of every value of the initial state."""
    initial = {path: value for path, value in truth.items() if path.startswith("initial.")}
    return {path: 2.0 * value - value_at(scenario, path) for path, value in initial.items()}


def half_bank_rate(scenario: Scenario, truth: Values) -> Values:
    """Half the bank rate of the vehicle, which guidance knows."""
    steering = "flight_software.control.bank_to_steer.bank.rate_deg_s"
    vehicle = steering if _is_rigid(scenario) else "point_mass.bank_rate_deg_s"
    return {path: 0.5 * value_at(scenario, path) for path in (f"{ENTRY}.bank_rate_deg_s", vehicle)}


DISPERSED, KNOWN = "as dispersed", "half bank rate"
#: Changes of a dispersed entry; the flight computer knows that of ``KNOWN`` only.
CONDITIONS: dict[str, Change] = {
    DISPERSED: lambda scenario, truth: {},
    "head wind": wind(180.0),
    "tail wind": wind(0.0),
    "cross wind": wind(90.0),
    "density x0.8": _scaled("atmosphere.density_factor", 0.8),
    "density x1.25": _scaled("atmosphere.density_factor", 1.25),
    "L/D -10 %": less_lift,
    "mass +3 %": _scaled("vehicle.mass.entry_kg", 1.03),
    KNOWN: half_bank_rate,
    "entry errors x2": doubled_entry_errors,
}


def cases(scenario: Scenario, truths: Sequence[Values], label: Values) -> Iterator[Case]:
    """Yield the dispersed entries of a law on a vehicle, and the first of them under each condition."""
    numbers = count()
    for name, change in CONDITIONS.items():
        some = truths if name == DISPERSED else truths[: max(len(truths) // _PER_CONDITION, 1)]
        for flight, truth in enumerate(some):
            changed, about = change(scenario, truth), {**label, "condition": name}
            true, known = ({}, changed) if name == KNOWN else (changed, {})
            yield Case(next(numbers), {**truth, **true}, known, flight, about)


# ---- entries that no bank angle brings to the aim point ------------------------------------------------

#: A flight at zero bank from entry interface to the parachute flies about as far as that entry can.
_LIFT_UP = (
    f"{ENTRY}.law=constant_bank",
    f"{ENTRY}.constant_bank.bank_deg=0",
    f"{ENTRY}.bank_min_deg=0",
    f"{ENTRY}.preset_bank_deg=0",
    f"{ENTRY}.heading.speed_m_s=0",
    f"{ENTRY}.reversal.logic=own_sign",
)


def lift_up(vehicle: Vehicle, dispersed: Sequence[Row], truths: Sequence[Values]) -> list[Row]:
    """Fly those entries that all laws missed again with lift up; return their rows."""
    best: dict[int, float] = {}
    own = pick(dispersed, vehicle=vehicle.name)
    for row, miss in zip(own, misses(own), strict=True):
        best[row["profile"]] = min(best.get(row["profile"], miss), miss)
    missed = sorted(number for number, miss in best.items() if miss > TARGET_KM)
    about = {"vehicle": vehicle.name, "condition": "lift up", "law": "constant_bank"}
    planned = [Case(k, truths[number], profile=number, label=about) for k, number in enumerate(missed)]
    return list(fly_rows(vehicle.load("simulation.log_every=5", *_LIFT_UP), planned)) if planned else []


def out_of_reach(rows: Sequence[Row]) -> set[int]:
    """Return the numbers (``profile``) of the entries that fall short of the aim point by more than
    ``TARGET_KM`` even with lift up; ``rows``: flights of :func:`lift_up`.
    """
    return {row["profile"] for row in rows if row.get("parachute_downrange_m", 0.0) < -1e3 * TARGET_KM}


# ---- one flight ----------------------------------------------------------------------------------------


def of_flight(flight: Flight) -> dict[str, float]:
    """Bank travel (deg) in lift control and propellant (kg) to mortar fire, also beyond the reversals."""
    bank = flight.telemetry["guide.bank_deg"][flight.during(LIFT)]
    found = dict(zip(("bank_travel_deg", "extra_travel_deg"), bank_travel(bank), strict=True))
    used, reversals = flight.figures.get("propellant_used_kg"), flight.figures.get("bank_reversals")
    if _is_rigid(flight.scenario) and used is not None and reversals is not None:
        found["extra_propellant_kg"] = used - reversals * reversal_kg(flight.scenario)
    return found


def bank_travel(bank: np.ndarray) -> tuple[float, float]:
    """Sum of all changes of a bank angle (deg, in time), and this sum without the turns from one side to the
    other.  A turn ends where the bank angle next moves back.
    """
    steps = np.diff(bank)
    steps = steps[steps != 0.0]
    if not len(steps):
        return 0.0, 0.0
    back = np.flatnonzero(np.diff(np.sign(steps))) + 1
    turns = np.add.reduceat(steps, [0, *back])
    ends = bank[0] + np.cumsum(turns)
    reverses = ends * (ends - turns) < 0.0
    return float(np.sum(np.abs(turns))), float(np.sum(np.abs(turns[~reverses])))


def reversal_kg(scenario: Scenario) -> float:
    """Propellant (kg) that starts and stops the roll of a reversal: 2 I w / (r Isp g0), with the roll inertia
    I, the bank rate w, and the roll arm r of the thrusters with the largest roll torque.
    """
    vehicle, rate = scenario.vehicle, radians(scenario.flight_software.control.bank_to_steer.bank.rate_deg_s)
    jet = max(vehicle.rcs.thrusters, key=lambda jet: jet.thrust_n * _roll_arm(jet))
    impulse = 2.0 * stated(vehicle.mass.entry_inertia_kg_m2)[0] * rate / _roll_arm(jet)
    return impulse / (jet.specific_impulse_s * G0)


def _roll_arm(jet: Thruster) -> float:
    (_, y, z), (_, along_y, along_z) = jet.position_m, jet.direction
    return abs(y * along_z - z * along_y)


#: Flight times (s) at which calls are timed, how often each, and blocks of which the quickest counts.
TIMED_AT, REPEATS, BLOCKS = (90.0, 110.0, 130.0, 160.0, 200.0), 20, 15


@kernel
def _repeat(entry_law, bank_side, onboards, navs, memories, work, outs, repeats):
    """Call an entry law repeatedly on a few states, each time with the memory as it was at first."""
    for _ in range(repeats):
        for j in range(navs.shape[0]):
            work[0] = memories[j]
            entry_guidance(entry_law, bank_side, onboards[0], navs[j], work[0], out=outs[0])


def call_time(loaded: LoadedScenario) -> float:
    """Mean processor time (us) of a call of the compiled law, steering and air data included."""
    onboard, saved = build_records(loaded).onboard, snapshots_at(loaded, TIMED_AT)
    navs, memories = np.zeros(len(saved), NAV), np.zeros(len(saved), ENTRY_MEMORY)
    for j, state in enumerate(saved):
        navs[j], memories[j] = state.fsw["nav"][0], state.fsw["guidance"]["entry"][0]
    functions = (chosen(name, onboard[0]) for name in ("entry_law", "bank_side"))
    given = (*functions, onboard, navs, memories, np.zeros(1, ENTRY_MEMORY), np.zeros(1, GUIDE))
    return quickest_us(lambda: _repeat(*given, REPEATS), BLOCKS) / (REPEATS * len(saved))


# ---- what came out -------------------------------------------------------------------------------------


def misses(rows: Sequence[Row]) -> np.ndarray:
    """Miss at mortar fire, km; infinite without mortar fire."""
    return np.nan_to_num(column(rows, "parachute_miss_m"), nan=inf, posinf=inf) / 1e3


def best_first(rows: Sequence[Row]) -> list[str]:
    """The laws of some rows in the order of the miss that 99 % of their flights do not exceed."""
    return sorted(kinds(rows, "law"), key=lambda law: not_exceeded(pick(rows, law=law), 0.99))


def not_exceeded(rows: Sequence[Row], share: float) -> float:
    """Smallest flown miss (km) that at least a share of the flights do not exceed."""
    return float(np.quantile(misses(rows), share, method="higher"))


def unflown(rows: Sequence[Row]) -> list[Row]:
    """Flights that ended before mortar fire; their rows have the cause."""
    return [row for row in rows if not isfinite(row.get("parachute_miss_m", nan))]


def _grids(rows: Sequence[Row], calls: Calls) -> Iterator[Grid]:
    """For each vehicle: quantiles of dispersed entries, their cost, and miss and bias of each condition."""
    for vehicle in kinds(rows, "vehicle"):
        flown = pick(rows, vehicle=vehicle)
        dispersed = pick(flown, condition=DISPERSED)
        laws = best_first(dispersed)
        title = f"{vehicle}: quantiles of the miss at the mortar, km, of dispersed entries"
        yield quantile_grid(title, "law", {law: misses(pick(dispersed, law=law)) for law in laws})
        yield _cost(vehicle, laws, dispersed, calls)
        title = f"{vehicle}: miss that 95 % do not exceed, km"
        yield _conditions(title, laws, flown, lambda own: not_exceeded(own, 0.95))
        title = f"{vehicle}: mean downrange from the aim point, km"
        yield _conditions(title, laws, flown, bias)


def bias(rows: Sequence[Row]) -> float:
    """Mean downrange (km) at mortar fire."""
    return mean(rows, "parachute_downrange_m") / 1e3


def _conditions(
    title: str, laws: Iterable[str], rows: Sequence[Row], of: Callable[[list[Row]], float]
) -> Grid:
    lines: list[Line] = []
    for law in laws:
        lines.append((law, *(of(pick(rows, law=law, condition=name)) for name in CONDITIONS)))
    again = len(rows) // len(lines) - len(pick(rows, law=lines[0][0], condition=DISPERSED))
    several = counted(again // max(len(CONDITIONS) - 1, 1), "flight")
    return Grid(f"{title}; {several} in each column after the first", ("law", *CONDITIONS), lines)


_HEADS = (
    "law", "bias km", "alt. 1 % km", "in box %", "bank travel deg", "beyond reversals deg", "fuel kg",
    "beyond reversals kg", "call us", "failed",
)  # fmt: skip


def _cost(vehicle: str, laws: Iterable[str], rows: Sequence[Row], calls: Calls) -> Grid:
    lines: list[Line] = []
    for law in laws:
        flown = pick(rows, law=law)
        low = quantile(column(flown, "parachute_altitude_m"), 0.01)
        lines.append((
            law, bias(flown), nan if low is None else low.value / 1e3,
            percentage(row["success"] for row in flown), mean(flown, "bank_travel_deg"),
            mean(flown, "extra_travel_deg"), mean(flown, "propellant_used_kg"),
            mean(flown, "extra_propellant_kg"), calls[vehicle, law], float(len(unflown(flown))),
        ))  # fmt: skip
    return Grid(f"{vehicle}: mean of {counted(len(rows) // len(lines), 'dispersed flight')}", _HEADS, lines)


def findings(rows: Sequence[Row], calls: Calls, beyond: Mapping[str, set[int]]) -> Iterator[Finding]:
    """Best laws, failed flights, times of a call; ``beyond``: entries of each vehicle out of reach."""
    dispersed = pick(rows, condition=DISPERSED)
    for vehicle in kinds(dispersed, "vehicle"):
        yield from _best_law(vehicle, pick(dispersed, vehicle=vehicle), beyond.get(vehicle, set()))
    failed = unflown(rows)
    why = f"{failed[0]['vehicle']}, {failed[0]['law']}: {failed[0]['cause']}" if failed else ""
    label = "flights that did not reach the mortar"
    yield Finding(label, "", float(len(failed)), 0.0, "<=", why=why)
    first = rows[0]["vehicle"]  # others may fly reversals that are found by flying ahead
    of_first = [(us, law) for (name, law), us in calls.items() if name == first]
    for which, bound, ahead in (
        ("laws that fly ahead", PREDICTOR_CALL_US, True),
        ("the others", CALL_US, False),
    ):
        if own := [(us, law) for us, law in of_first if (law in PREDICTORS) == ahead]:
            us, law = max(own)
            yield Finding(f"{first}: longest guidance call of {which}", "us", us, bound, "<=", law)


def _best_law(vehicle: str, flown: Sequence[Row], beyond: set[int]) -> Iterator[Finding]:
    """Misses of the best law, of all entries and of those in reach, and the law's deployment box."""
    best = best_first(flown)[0]
    mine = pick(flown, law=best)
    share, words = 100.0 * len(beyond) / len(mine), f"{vehicle}: {percent(TARGET_SHARE)} of misses"
    in_reach = misses([row for row in mine if row["profile"] not in beyond])
    asked = Finding(f"{words}, best law", "km", nan, TARGET_KM, "<=", best)
    every = with_quantile(asked, misses(mine), TARGET_SHARE)
    within = with_quantile(replace(asked, label=f"{words} of the entries in reach"), in_reach, TARGET_SHARE)
    if within.computed <= TARGET_KM < every.computed:
        cause = f"{share:.1f} % of the entries end short with lift up all the way, flown so"
        every = replace(every, why=cause)
    yield every
    if beyond:
        yield within
        yield Finding(f"{vehicle}: entries short of the target with lift up", "%", share)
    if any(one.name == vehicle and not one.dispersions for one in VEHICLES):
        return  # the papers of the point masses have no box
    kept = percentage(row["success"] for row in mine)
    yield Finding(f"{vehicle}: deployment box kept, best law", "%", kept, 100.0, ">=", best)


def _pictures(dispersed: Sequence[Row]) -> dict[str, list[Panel]]:
    """Misses of dispersed entries on each vehicle."""
    panels = []
    for vehicle in kinds(dispersed, "vehicle"):
        own = pick(dispersed, vehicle=vehicle)
        order = best_first(own)
        curves = [Curve.distribution(misses(pick(own, law=law)), law) for law in order]
        limit = 3.0 * not_exceeded(pick(own, law=order[0]), 0.99)
        options = {"xlim": (0.0, max(2.0 * TARGET_KM, limit))} if isfinite(limit) else {}
        labels = (f"{vehicle}: miss at the mortar", "miss (km)", "flights within (%)")
        panels.append(Panel(*labels, curves, options))
    return {"comparison": panels}


TITLE = (
    "Entry laws on the same dispersed entries: as they come, in other air, wind and lift, at half bank rate"
)
SOURCE = "this simulator, 2026"
STUDY = Study("guidance", TITLE, SOURCE, run, runs=100, quick_runs=20, parts=LAWS, seed=20210514)
